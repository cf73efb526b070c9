"""Stage `3-least-squares`: all positions and plane offsets at once, per axis, gauge p_0 = 0 (METHOD.md, step 3)."""

import numpy as np

from floorplan.config import LeastSquaresConfig
from floorplan.elimination.reduction import reduce_axis
from floorplan.elimination.weighted import solve, systems
from floorplan.model.graph import LayoutGraph, LeastSquaresSolution
from floorplan.noise.estimate import estimate_noise
from floorplan.rows import AXES, AxisRows, AxisSolution, RowWeights, axis_rows, residual_norm, right_hand_side, split


def least_squares(graph: LayoutGraph, config: LeastSquaresConfig) -> LeastSquaresSolution:
    """Positions (N, 3) and track offsets (M,), metres, that minimise `||A xi - b||_2`.

    "plain": unweighted rows, as published. "robust": rows weighted by the noise that the scan shows, odometry with scale and
    sideways rates as further unknowns; its noise comes with the solution.
    """
    return weighted_least_squares(graph, None) if config.method == "plain" else robust_least_squares(graph)


def published_least_squares(graph: LayoutGraph, least_squares: LeastSquaresSolution) -> LeastSquaresSolution:
    """The unweighted solution that the published merge starts from: the given one where it has no weights."""
    return least_squares if least_squares.noise is None else weighted_least_squares(graph, None)


def robust_least_squares(graph: LayoutGraph) -> LeastSquaresSolution:
    """Least squares under the noise estimated from the graph itself; the `residual` is unweighted all the same."""
    noise = estimate_noise(graph)
    place = np.vstack([np.zeros(3), np.cumsum(graph.translation_m, axis=0)])
    offset = np.zeros(len(graph.axis))
    for system in systems(graph, noise):
        solved = solve(system)
        offset[system.tracks], place[:, list(system.axes)] = solved.offset_m, solved.position_m
    return LeastSquaresSolution(place, offset, residual_norm(graph, place, offset), noise)


def weighted_least_squares(graph: LayoutGraph, weights: RowWeights | None) -> LeastSquaresSolution:
    """The same with a weight per row; the `residual` it gives back is unweighted all the same."""
    position, offset = np.zeros((len(graph.stamp_s), 3)), np.zeros(len(graph.axis))
    for axis in AXES:
        solution = solve_axis(axis_rows(graph, axis, weights))
        position[:, axis] = solution.position_m
        offset[split(graph, axis).track] = solution.offset_m
    return LeastSquaresSolution(position, offset, residual_norm(graph, position, offset))


def solve_axis(rows: AxisRows) -> AxisSolution:
    """Least squares along one axis."""
    return reduce_axis(rows).solve(right_hand_side(rows))
