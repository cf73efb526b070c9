"""Stage `5-resolve`: least squares again with the accepted equivalences as hard equalities (METHOD.md, step 5)."""

from dataclasses import dataclass

import numpy as np

from floorplan.config import ResolveConfig
from floorplan.merged_graph import merged_graph
from floorplan.model.checks import Array
from floorplan.model.graph import LayoutGraph, LayoutSolution, MergeResult
from floorplan.reduction import reduce_axis
from floorplan.rows import AXES, axis_rows, residual_norm, split, squared_residual, sums_by
from floorplan.signs import solve_with_signs

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

    Rows are unweighted; their standard deviation comes from the residuals of each axis.
    """
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


def plane_extents(graph: LayoutGraph, plane_of_track: Array, position_m: Array, plane_offset_m: Array) -> Array:
    """Union of the tracks' boxes (L, 3, 2), each moved by the mean correction of the frames that saw it; NaN where unknown."""
    dead_reckoned = np.vstack((np.zeros((1, 3)), np.cumsum(graph.translation_m, axis=0)))
    correction = (position_m - dead_reckoned)[graph.frame]
    seen = np.maximum(np.bincount(graph.track, minlength=len(graph.axis)), 1)
    shift = np.stack([sums_by(graph.track, correction[:, k], len(graph.axis)) for k in AXES], axis=1) / seen[:, None]
    moved = graph.extent_m + shift[:, :, None]
    lowest, highest = np.full((len(plane_offset_m), 3), np.nan), np.full((len(plane_offset_m), 3), np.nan)
    np.fmin.at(lowest, plane_of_track, moved[:, :, 0])
    np.fmax.at(highest, plane_of_track, moved[:, :, 1])
    extent = np.stack((lowest, highest), axis=2)
    extent[plane_of_track, graph.axis] = plane_offset_m[plane_of_track, None]
    return extent


def _solve_axis(plane_graph: LayoutGraph, axis: int) -> _AxisPlanes:
    rows, plane = axis_rows(plane_graph, axis), split(plane_graph, axis).track
    solution = solve_with_signs(rows, plane_graph.facing[plane])
    cofactor = reduce_axis(rows).covariance()
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
