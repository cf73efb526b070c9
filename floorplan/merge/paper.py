"""`merge.method = "paper"`: the published L1 merge with a fixed radius and threshold (METHOD.md, step 4)."""

import numpy as np

from floorplan.config import MergeConfig
from floorplan.errors import ConfigError
from floorplan.merge import paper_cvxpy, paper_reduced
from floorplan.merge.cannot_link import planes_kept_apart
from floorplan.merge.certificate import Certificate, certify, verified
from floorplan.merge.hypotheses import Pairs, planes_of_tracks
from floorplan.merge.paper_cvxpy import solve_verbatim
from floorplan.merge.paper_problem import (
    EXACT_RESIDUAL_M,
    PaperAnswer,
    PaperProblem,
    answer_without_pairs,
    empty_ball,
    paper_problem,
)
from floorplan.merge.paper_reduced import solve_reduced
from floorplan.model.checks import Array
from floorplan.model.graph import Hypotheses, LayoutGraph, LeastSquaresSolution, MergeResult, Verdict


def merge_paper(graph: LayoutGraph, least_squares: LeastSquaresSolution, config: MergeConfig, never: Pairs) -> MergeResult:
    """The L1 solution, verified by us, its threshold decisions and the planes they make.

    `least_squares` must be the unweighted one, without D. Raises NoSolutionError when the ball with D is empty or
    the engine's answer fails our checks. Pairs of `never` are not one plane: accepted pairs are taken nearest first, and those that
    would join such a pair are refused.
    """
    problem = paper_problem(graph, least_squares, config.radius_m, config.eps)
    answer, certificate = solve_paper(problem, config.engine)
    gap = problem.pairs.gap_m(answer.track_offset_m)
    accepted = np.abs(gap) <= config.mu_m
    planes = _planes(len(graph.axis), problem.pairs, gap, accepted, never)
    refused = accepted & (planes[problem.pairs.first] != planes[problem.pairs.second])
    return MergeResult(
        method="paper",
        hypotheses=_hypotheses(problem, gap, accepted, refused),
        plane_of_track=planes,
        track_offset_m=answer.track_offset_m,
        position_m=answer.position_m,
        objective=certificate.objective_m,
        delta_m=problem.delta_m,
        residual_m=certificate.residual_m,
    )


def _planes(tracks: int, pairs: Pairs, gap_m: Array, accepted: Array, never: Pairs) -> Array:
    if not len(never):
        return planes_of_tracks(tracks, pairs.select(accepted))
    nearest = np.argsort(np.abs(gap_m), kind="stable")
    return planes_kept_apart(tracks, pairs.select(nearest[accepted[nearest]]), never)


def solve_paper(problem: PaperProblem, engine: str) -> tuple[PaperAnswer, Certificate]:
    """The verified optimum of the published problem by the given engine."""
    if problem.is_single_point or not len(problem.pairs):
        return _without_choice(problem)
    if engine == "cvxpy":
        answer = solve_verbatim(problem)
        return answer, verified(problem, answer, engine, paper_cvxpy.ADVICE)
    if engine == "reduced":
        answer = solve_reduced(problem)
        return answer, verified(problem, answer, engine, paper_reduced.ADVICE)
    raise ConfigError(f"merge.engine = '{engine}' is unknown; it is 'reduced' or 'cvxpy'")


def _without_choice(problem: PaperProblem) -> tuple[PaperAnswer, Certificate]:
    """Without pairs, or with rows that agree exactly, the least squares with signs is the answer."""
    answer = answer_without_pairs(problem)
    certificate = certify(problem, answer)
    if certificate.residual_m > problem.delta_m + EXACT_RESIDUAL_M:
        raise empty_ball(problem, certificate.residual_m)
    return answer, certificate


def _hypotheses(problem: PaperProblem, gap_m: Array, accepted: Array, refused: Array) -> Hypotheses:
    pairs: Pairs = problem.pairs
    choice = np.select([refused, accepted], [0, 1], default=2)
    table = (Verdict.FORBIDDEN, Verdict.ACCEPTED, Verdict.BEYOND_THRESHOLD)
    unknown = np.full(len(pairs), np.nan)
    return Hypotheses(
        first=pairs.first,
        second=pairs.second,
        distance_m=pairs.gap_m(problem.least_squares.track_offset_m),
        solved_distance_m=gap_m,
        sigma_m=unknown,
        chi_square=unknown,
        verdict=tuple(table[k] for k in choice.tolist()),
    )
