"""The published convex problem as a value, whatever solves it (METHOD.md, step 4).

    minimise ||E xi||_1  subject to  ||A xi - b||_2 <= delta  and  D xi <= 0

One ball over all rows of all three axes, unweighted; `delta = (1 + eps) ||A xi_lin - b||` with `xi_lin` the least
squares without D; `D` keeps every measurement's sign.
"""

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from floorplan.elimination.reduction import ReducedAxis, reduce_axis
from floorplan.errors import NoSolutionError
from floorplan.merge.hypotheses import Pairs, pairs_within, planes_of_tracks
from floorplan.merged_planes import merged_graph
from floorplan.model.checks import Array
from floorplan.model.graph import LayoutGraph, LeastSquaresSolution
from floorplan.rows import AXES, axis_rows, residual_norm, split, sums_by
from floorplan.signs import least_squares_with_signs

EXACT_RESIDUAL_M = 1e-7  # below a tenth of a micron over all rows the rows agree exactly: the ball is one point


@dataclass(frozen=True)
class PaperProblem:
    """The problem: its graph, its pairs (rows of `E`), its least squares, `delta_m`."""

    graph: LayoutGraph
    pairs: Pairs
    least_squares: LeastSquaresSolution
    delta_m: float

    @property
    def slack_m(self) -> float:
        """`rho = sqrt(delta^2 - ||A xi_lin - b||^2)`: the ball in the norm of `A` about the least squares."""
        return float(np.sqrt(max(self.delta_m**2 - self.least_squares.residual**2, 0.0)))

    @property
    def is_single_point(self) -> bool:
        """True when the ball holds nothing but the least squares."""
        return self.delta_m <= EXACT_RESIDUAL_M or self.slack_m <= EXACT_RESIDUAL_M

    @cached_property
    def reduced(self) -> tuple[ReducedAxis, ...]:
        """The three axes with their trajectories eliminated."""
        return tuple(reduce_axis(axis_rows(self.graph, axis)) for axis in AXES)

    def objective(self, track_offset_m: Array) -> float:
        """`||E xi||_1` in metres."""
        return float(np.abs(self.pairs.gap_m(track_offset_m)).sum())

    def residual(self, position_m: Array, track_offset_m: Array) -> float:
        """`||A xi - b||_2` in metres."""
        return residual_norm(self.graph, position_m, track_offset_m)

    def sign_excess_m(self, position_m: Array, track_offset_m: Array) -> Array:
        """`D xi` (K,) in metres: positive where a plane lies on the wrong side of the sensor that saw it."""
        track = self.graph.track
        return np.asarray(self.graph.facing[track] * (track_offset_m[track] - position_m[self.graph.frame, self.graph.axis[track]]))


@dataclass(frozen=True)
class PaperAnswer:
    """A candidate optimum with its dual: `pair_dual (H,)` in [-1, 1] for `E`, `sign_dual (K,)` >= 0 for `D`."""

    position_m: Array
    track_offset_m: Array
    pair_dual: Array
    sign_dual: Array


def paper_problem(graph: LayoutGraph, least_squares: LeastSquaresSolution, radius_m: float, eps: float) -> PaperProblem:
    """The problem of a graph and its unweighted least squares. Raises ValueError for a weighted one: bounds would not hold."""
    if least_squares.noise is not None:
        raise ValueError("the published problem stands on the unweighted least squares, without noise")
    pairs = pairs_within(graph, least_squares.track_offset_m, radius_m)
    return PaperProblem(graph, pairs, least_squares, (1 + eps) * least_squares.residual)


def answer_without_pairs(problem: PaperProblem) -> PaperAnswer:
    """Least squares with D as an answer: what is left where no pair can pull."""
    solution = least_squares_with_signs(problem.graph)
    pair_dual = np.sign(problem.pairs.gap_m(solution.track_offset_m))
    return PaperAnswer(solution.position_m, solution.track_offset_m, pair_dual, np.zeros(len(problem.graph.frame)))


def fully_merged_answer(problem: PaperProblem) -> PaperAnswer | None:
    """The answer of objective 0, every pair merged, where the ball is wide enough for it."""
    plane_of_track = planes_of_tracks(len(problem.graph.axis), problem.pairs)
    solution = least_squares_with_signs(merged_graph(problem.graph, plane_of_track))
    if solution.residual > problem.delta_m:
        return None
    no_pull = np.zeros(len(problem.pairs)), np.zeros(len(problem.graph.frame))
    return PaperAnswer(solution.position_m, solution.track_offset_m[plane_of_track], *no_pull)


def empty_ball(problem: PaperProblem, signed_residual_m: float) -> NoSolutionError:
    """The error to raise when no layout with the right signs fits into the ball."""
    needed = signed_residual_m / problem.least_squares.residual - 1 if problem.least_squares.residual > EXACT_RESIDUAL_M else np.inf
    return NoSolutionError(
        f"no layout keeps every measurement's sign within the residual ball of {problem.delta_m:.6g} m: the best one has "
        f"{signed_residual_m:.6g} m, least squares without signs {problem.least_squares.residual:.6g} m. Try merge.eps above {needed:.3g}, "
        "or look for gross outliers among the measurements: they put planes on the wrong side of the sensor."
    )


def pair_pull(problem: PaperProblem, pair_dual: Array, axis: int) -> Array:
    """`E^T y` for the tracks of one axis (V,)."""
    tracks, pairs = len(problem.graph.axis), problem.pairs
    pull = sums_by(pairs.first, pair_dual, tracks) - sums_by(pairs.second, pair_dual, tracks)
    return np.asarray(pull[split(problem.graph, axis).track])
