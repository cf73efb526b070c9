"""The evidence merge's decisions as hypotheses with their numbers."""

from collections.abc import Sequence

import numpy as np

from floorplan.merge.evidence_greedy import Decision, Question
from floorplan.merge.evidence_pairs import Planes
from floorplan.merge.hypotheses import Pairs
from floorplan.model.checks import Array
from floorplan.model.graph import Hypotheses, Verdict

PLAUSIBLE_CHI_SQUARE = 9.0  # three sigma: a pair this close was not turned down for its distance


def system_hypotheses(planes: Planes, pairs: Pairs, question: Question, decision: Decision, outvoted: Array) -> Hypotheses:
    """Hypotheses of one system, in tracks of the graph; `outvoted (H,)` pairs that only the candidate that lost an axis joins."""
    sigma = np.sqrt(np.maximum(decision.variance_m2, 1e-12))
    chi_square = (decision.delta_m / sigma) ** 2
    return Hypotheses(
        first=planes.tracks[pairs.first],
        second=planes.tracks[pairs.second],
        distance_m=question.delta_m,
        solved_distance_m=decision.delta_m,
        sigma_m=sigma,
        chi_square=chi_square,
        verdict=_verdicts(pairs, question, decision, chi_square, outvoted),
    )


def join_hypotheses(parts: Sequence[Hypotheses]) -> Hypotheses:
    """All systems' hypotheses in one table."""
    names = ("first", "second", "distance_m", "solved_distance_m", "sigma_m", "chi_square")
    empty: list[Array] = [np.zeros(0)]
    first, second, distance, solved, sigma, chi = (np.concatenate([getattr(p, n) for p in parts] or empty) for n in names)
    return Hypotheses(first, second, distance, solved, sigma, chi, tuple(v for p in parts for v in p.verdict))


def _verdicts(pairs: Pairs, question: Question, decision: Decision, chi_square: Array, outvoted: Array) -> tuple[Verdict, ...]:
    same = decision.plane[pairs.first] == decision.plane[pairs.second]
    plausible = chi_square <= PLAUSIBLE_CHI_SQUARE
    choice = np.select([same, question.apart, outvoted, decision.open, plausible], [0, 1, 5, 2, 3], default=4)
    table = (Verdict.ACCEPTED, Verdict.SEEN_APART, Verdict.AMBIGUOUS, Verdict.EXTENT_GAP, Verdict.BEYOND_COVARIANCE, Verdict.OUTVOTED)
    return tuple(table[k] for k in choice.tolist())
