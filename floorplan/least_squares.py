"""Stage `3-least-squares`: all positions and plane offsets at once, per axis, gauge p_0 = 0 (METHOD.md, step 3)."""

import numpy as np

from floorplan.config import LeastSquaresConfig
from floorplan.model.graph import LayoutGraph, LeastSquaresSolution
from floorplan.reduction import reduce_axis
from floorplan.rows import AXES, AxisRows, AxisSolution, RowWeights, axis_rows, residual_norm, right_hand_side, split


def least_squares(graph: LayoutGraph, config: LeastSquaresConfig) -> LeastSquaresSolution:
    """Minimise `||A xi - b||_2` over positions (N, 3) and track offsets (M,), metres; unweighted rows, as published."""
    return weighted_least_squares(graph, None)


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
