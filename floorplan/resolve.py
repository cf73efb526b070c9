"""Stage `5-resolve`: least squares again with the accepted equivalences as hard equalities (METHOD.md, step 5)."""

from dataclasses import dataclass

import numpy as np

from floorplan.config import ResolveConfig
from floorplan.elimination.reduction import reduce_axis
from floorplan.merged_planes import merged_graph, plane_extents
from floorplan.model.checks import Array
from floorplan.model.graph import LayoutGraph, LayoutSolution, MergeResult
from floorplan.noise.range_accuracy import with_range_errors
from floorplan.rows import AXES, axis_rows, residual_norm, split, squared_residual
from floorplan.signs import solve_with_signs
from floorplan.weighted_resolve import weighted_resolve

ASSUMED_ROW_SIGMA_M = 0.01  # of a depth camera at room range; used only where nothing can be learnt from residuals


@dataclass(frozen=True)
class _AxisPlanes:
    """One axis solved: `offset_m (V,)`, `position_m (N,)`, `cofactor (V, V)` = `S^-1`, squared residual, degrees of freedom."""

    plane: Array
    offset_m: Array
    position_m: Array
    cofactor: Array
    squared_residual: float
    freedom: int


def resolve(graph: LayoutGraph, merged: MergeResult, config: ResolveConfig) -> LayoutSolution:
    """Minimise `||A xi - b||` subject to `E' xi = 0` and `D xi <= 0`; final planes are the merged components.

    Rows are weighted by `merged.noise`; without it they are unweighted, and their standard deviation comes from the
    residuals of each axis. The weighted form rejects rows of the wrong sign beforehand instead of carrying D.
    Standard deviations contain the accuracy of the sensor as far as the graph knows it.
    """
    if merged.noise is not None:
        solution = weighted_resolve(graph, merged.plane_of_track, merged.noise, config.covariance, made=merged.made)
    else:
        solution = _unweighted(graph, merged, config)
    return with_range_errors(solution, graph)


def _unweighted(graph: LayoutGraph, merged: MergeResult, config: ResolveConfig) -> LayoutSolution:
    plane_graph = merged_graph(graph, merged.plane_of_track)
    solved = [_solve_axis(plane_graph, axis) for axis in AXES]
    position = np.stack([part.position_m for part in solved], axis=1)
    offset, covariance = np.zeros(len(plane_graph.axis)), np.zeros((len(plane_graph.axis),) * 2)
    for part in solved:
        offset[part.plane] = part.offset_m
        covariance[np.ix_(part.plane, part.plane)] = _row_variance_m2(part, solved, graph) * part.cofactor
    return LayoutSolution(
        position_m=position,
        plane_of_track=merged.plane_of_track,
        plane_axis=plane_graph.axis,
        plane_facing=plane_graph.facing,
        plane_offset_m=offset,
        plane_sigma_m=np.sqrt(np.diag(covariance)),
        plane_extent_m=plane_extents(graph, merged.plane_of_track, position, offset),
        plane_covariance_m2=covariance if config.covariance else None,
        residual_m=residual_norm(plane_graph, position, offset),
    )


def _solve_axis(plane_graph: LayoutGraph, axis: int) -> _AxisPlanes:
    rows, plane = axis_rows(plane_graph, axis), split(plane_graph, axis).track
    reduced = reduce_axis(rows)
    solution, cofactor = solve_with_signs(reduced, plane_graph.facing[plane]), reduced.covariance()
    freedom = len(rows.frame) - rows.planes
    return _AxisPlanes(plane, solution.offset_m, solution.position_m, cofactor, squared_residual(rows, solution), freedom)


def _row_variance_m2(part: _AxisPlanes, solved: list[_AxisPlanes], graph: LayoutGraph) -> float:
    """Variance of one row from the residuals of its axis, else of all axes, else from the graph's own sigma."""
    if part.freedom > 0:
        return part.squared_residual / part.freedom
    freedom = sum(other.freedom for other in solved)
    if freedom > 0:
        return sum(other.squared_residual for other in solved) / freedom
    if graph.sigma_m is not None and len(graph.sigma_m):
        return float(np.median(graph.sigma_m)) ** 2
    return ASSUMED_ROW_SIGMA_M**2
