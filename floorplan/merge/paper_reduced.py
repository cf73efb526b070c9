"""The published problem in the planes only: the same optimum as verbatim, at building scale.

The trajectory is eliminated exactly, so the residual ball becomes `sum_axes (v - v_lin)^T S (v - v_lin) <= rho^2` with
`rho^2 = delta^2 - ||A xi_lin - b||^2`. D is checked on the recovered trajectory; where a row is violated it enters the
problem, and its frame stays an unknown beside the planes.
"""

from dataclasses import dataclass

import numpy as np

from floorplan.elimination.reduction import ReducedAxis, reduce_axis
from floorplan.errors import NoSolutionError
from floorplan.merge.ball_problem import BallOptimum, BallProblem
from floorplan.merge.hypotheses import Pairs
from floorplan.merge.interior_point import minimise
from floorplan.merge.paper_problem import PaperAnswer, PaperProblem, empty_ball, fully_merged_answer
from floorplan.model.checks import Array
from floorplan.rows import AXES, split
from floorplan.signs import ROWS_PER_ROUND, SIGN_TOLERANCE_M, least_squares_with_signs

ADVICE = "Try merge.engine = 'cvxpy', or another merge.eps."
MAX_SIGN_ROUNDS = 40  # each adds the worst violated rows; contradictions are noticed before by the signed least squares
OBJECTIVE_FLOOR_M = 1e-6  # an objective below a micron is zero


@dataclass(frozen=True)
class _Border:
    """Where the unknowns of the reduced problem lie: tracks first in each axis' block, then its kept frames."""

    track_column: Array
    kept_column: dict[tuple[int, int], int]
    axes: tuple[ReducedAxis, ...]


def solve_reduced(problem: PaperProblem) -> PaperAnswer:
    """The optimum by the reduced problem, unchecked. Raises NoSolutionError when the ball with D is empty."""
    merged = fully_merged_answer(problem)
    if merged is not None:
        return merged
    active = np.zeros(0, dtype=np.int64)
    for _ in range(MAX_SIGN_ROUNDS):
        answer = _solve_with(problem, active)
        excess = problem.sign_excess_m(answer.position_m, answer.track_offset_m)
        worst = np.argsort(-excess)[:ROWS_PER_ROUND]
        new = np.setdiff1d(worst[excess[worst] > SIGN_TOLERANCE_M], active)
        if not len(new):
            return answer
        if not len(active):
            _require_room_for_signs(problem)
        active = np.union1d(active, new)
    raise NoSolutionError(f"the sign rows did not settle after {MAX_SIGN_ROUNDS} rounds ({len(active)} active). {ADVICE}")


def _require_room_for_signs(problem: PaperProblem) -> None:
    residual = least_squares_with_signs(problem.graph).residual
    if residual > problem.delta_m:
        raise empty_ball(problem, residual)


def _solve_with(problem: PaperProblem, active: Array) -> PaperAnswer:
    """The optimum subject to the `active` rows of D alone."""
    border, centre = _border(problem, active)
    radius = problem.slack_m
    order = np.argsort(border.track_column[problem.pairs.first], kind="stable")
    pairs = Pairs(border.track_column[problem.pairs.first][order], border.track_column[problem.pairs.second][order])
    signs = _sign_rows(problem, active, border, len(centre))
    ball = BallProblem(
        information=tuple(axis.information for axis in border.axes),
        pairs=pairs,
        start=pairs.gap_m(centre) / radius,
        sign_rows=signs,
        sign_excess=signs @ centre / radius,
        floor=OBJECTIVE_FLOOR_M / radius,
    )
    optimum = minimise(ball)
    return _answer(problem, border, centre + radius * optimum.z, optimum, order, active)


def _border(problem: PaperProblem, active: Array) -> tuple[_Border, Array]:
    """The layout of the unknowns and the least squares at them."""
    graph, axes, centre = problem.graph, [], []
    track_column, start = np.zeros(len(graph.axis), dtype=np.int64), 0
    kept_column: dict[tuple[int, int], int] = {}
    active_axis = graph.axis[graph.track[active]]
    for axis in AXES:
        kept = np.unique(graph.frame[active[active_axis == axis]])
        kept = kept[kept > 0]
        reduced = reduce_axis(problem.reduced[axis].rows, kept) if len(kept) else problem.reduced[axis]
        track = split(graph, axis).track
        track_column[track] = start + np.arange(len(track))
        kept_column |= {(axis, int(frame)): start + len(track) + k for k, frame in enumerate(kept)}
        centre += [problem.least_squares.track_offset_m[track], problem.least_squares.position_m[kept, axis]]
        axes.append(reduced)
        start += len(track) + len(kept)
    return _Border(track_column, kept_column, tuple(axes)), np.concatenate(centre)


def _sign_rows(problem: PaperProblem, active: Array, border: _Border, columns: int) -> Array:
    """The `active` rows of D over the border's unknowns (Q, V): `facing (m_j - p_i)`, where p_0 is nothing."""
    graph = problem.graph
    signs = np.zeros((len(active), columns))
    for row, k in enumerate(active):
        track, frame = int(graph.track[k]), int(graph.frame[k])
        signs[row, border.track_column[track]] = graph.facing[track]
        if frame > 0:
            signs[row, border.kept_column[int(graph.axis[track]), frame]] = -graph.facing[track]
    return signs


def _answer(problem: PaperProblem, border: _Border, solved: Array, optimum: BallOptimum, order: Array, active: Array) -> PaperAnswer:
    """Back-substitution: every frame's position, and the duals in the order of the problem."""
    graph = problem.graph
    position, offset = np.zeros((len(graph.stamp_s), 3)), solved[border.track_column]
    start = 0
    for axis, reduced in zip(AXES, border.axes, strict=True):
        size = len(reduced.information)
        position[:, axis] = reduced.trajectory(solved[start : start + size]).position_m
        start += size
    pair_dual, sign_dual = np.zeros(len(problem.pairs)), np.zeros(len(graph.frame))
    pair_dual[order] = optimum.pair_dual
    sign_dual[active] = optimum.sign_dual
    return PaperAnswer(position, offset, pair_dual, sign_dual)
