"""`D xi <= 0`: every measurement keeps its sign, so that no plane passes to the other side of the sensor that saw it.

The sign is the facing's, `sign(d) = -facing`: row k says `facing (m_j - p_i) <= 0`. On clean data none of these rows
is active, so they are checked on the solution and only violated ones enter the problem.
"""

import numpy as np

from floorplan.elimination.reduction import ReducedAxis, reduce_axis
from floorplan.errors import NoSolutionError
from floorplan.model.checks import Array
from floorplan.model.graph import LayoutGraph, LeastSquaresSolution
from floorplan.rows import AXES, AxisRows, AxisSolution, axis_rows, residual_norm, right_hand_side, split

SIGN_TOLERANCE_M = 1e-6  # a plane a micron on the wrong side of a sensor is arithmetic, not geometry
MAX_ROUNDS = 60  # each round adds rows; more rounds than this mean that the signs contradict each other everywhere
ROWS_PER_ROUND = 200  # the worst offenders first: most of the others are satisfied with them
EIGENVALUE_FLOOR = 1e-12  # relative; sign rows over a cycle of frames and planes depend on each other


def least_squares_with_signs(graph: LayoutGraph) -> LeastSquaresSolution:
    """Unweighted least squares of all axes subject to the sign rows: the smallest residual that keeps every sign."""
    position, offset = np.zeros((len(graph.stamp_s), 3)), np.zeros(len(graph.axis))
    for axis in AXES:
        track = split(graph, axis).track
        solution = solve_with_signs(reduce_axis(axis_rows(graph, axis)), graph.facing[track])
        position[:, axis], offset[track] = solution.position_m, solution.offset_m
    return LeastSquaresSolution(position, offset, residual_norm(graph, position, offset))


def sign_excess_m(rows: AxisRows, facing: Array, solution: AxisSolution) -> Array:
    """How far each measurement's plane lies on the wrong side of its sensor (K,), metres; negative is right."""
    return np.asarray(facing[rows.plane] * (solution.offset_m[rows.plane] - solution.position_m[rows.frame]))


def solve_with_signs(reduced: ReducedAxis, facing: Array) -> AxisSolution:
    """Least squares along one axis (no frame kept) subject to the sign rows; `facing (V,)` of its planes.

    Always feasible (all at 0 satisfies every sign). Raises NoSolutionError when the active set does not settle.
    """
    rows = reduced.rows
    free = reduced.solve(right_hand_side(rows))
    solution, active = free, np.zeros(0, dtype=np.int64)
    for _ in range(MAX_ROUNDS):
        excess = sign_excess_m(rows, facing, solution)
        worst = np.argsort(-excess)[:ROWS_PER_ROUND]
        new = np.setdiff1d(worst[excess[worst] > SIGN_TOLERANCE_M], active)
        if not len(new):
            return solution
        active = np.concatenate((active, new))
        solution = _with_active_rows(reduced, facing, free, active)
    raise NoSolutionError(
        f"the sign rows of the measurements did not settle after {MAX_ROUNDS} rounds ({len(active)} rows active): "
        "too many measurements contradict their facing; look for wrong facings or gross outliers among the distances"
    )


def _with_active_rows(reduced: ReducedAxis, facing: Array, free: AxisSolution, active: Array) -> AxisSolution:
    """Minimum subject to the `active` sign rows, by its dual: non-negative least squares over the multipliers."""
    from scipy.optimize import nnls  # slow to import, and hardly ever needed

    rows = reduced.rows
    pushes = [_response(reduced, row, float(facing[rows.plane[row]])) for row in active]
    sign, plane, frame = facing[rows.plane[active]], rows.plane[active], rows.frame[active]
    offsets = np.stack([push.offset_m for push in pushes], axis=1)
    positions = np.stack([push.position_m for push in pushes], axis=1)
    gram = sign[:, None] * (offsets[plane] - positions[frame])
    value, vector = np.linalg.eigh((gram + gram.T) / 2)
    keep = value > EIGENVALUE_FLOOR * value[-1]
    root = np.sqrt(value[keep])
    excess = sign_excess_m(rows, facing, free)[active]
    multiplier, _ = nnls(root[:, None] * vector[:, keep].T, (vector[:, keep].T @ excess) / root)
    return AxisSolution(free.position_m - positions @ multiplier, free.offset_m - offsets @ multiplier)


def _response(reduced: ReducedAxis, row: int, sign: float) -> AxisSolution:
    """How positions and planes move when sign row `row` is pushed with a unit multiplier."""
    rows = reduced.rows
    position, offset = np.zeros(rows.frames), np.zeros(rows.planes)
    offset[rows.plane[row]], position[rows.frame[row]] = sign, -sign
    position[0] = 0.0
    return reduced.solve(AxisSolution(position, offset))
