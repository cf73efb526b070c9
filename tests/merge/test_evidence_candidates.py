"""The second candidate: its planes, when it is asked, and who wins an axis."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.stats import chi2

from floorplan.merge.ball_problem import BallProblem
from floorplan.merge.evidence_candidates import choose_planes
from floorplan.merge.evidence_greedy import Question, decide
from floorplan.merge.hypotheses import Pairs
from floorplan.merge.interior_point import minimise
from floorplan.merge.l1_candidate import WITHIN, l1_planes
from tests.merge.test_evidence_greedy import walls
from tests.merge.test_evidence_moves import decided, labels

Walls = tuple[Question, np.ndarray, np.ndarray, np.ndarray]


@pytest.fixture(scope="module")
def scene() -> Walls:
    return walls(6, 6, seed=9)


def test_weighted_l1_is_no_larger_than_anywhere_else_in_the_ball(scene: Walls) -> None:
    question, covariance, offset, _ = scene
    rng, scale = np.random.default_rng(1), question.variance_m2**-0.5
    pairs, radius = Pairs(question.first, question.second), float(np.sqrt(chi2.ppf(WITHIN, len(offset))))
    W, nothing = np.linalg.inv(covariance), np.zeros(0)
    start = scale * pairs.gap_m(offset) / radius
    best = minimise(BallProblem((W,), pairs, start, np.zeros((0, len(W))), nothing, 1e-6, scale))

    def objective(z: np.ndarray) -> float:
        return float(np.abs(scale * pairs.gap_m(z) + start).sum())

    assert best.gap < 1e-6
    assert best.z @ W @ best.z == pytest.approx(1.0, abs=1e-5)  # the ball is used up
    assert objective(best.z) < 0.98 * objective(np.zeros(len(W)))
    root = np.linalg.cholesky(covariance)
    for _ in range(50):
        other = best.z + 0.05 * root @ rng.normal(size=len(W))
        other /= max(1.0, float(np.sqrt(other @ W @ other)))
        assert objective(other) >= objective(best.z) - 1e-6


def test_l1_and_chi_square_find_the_walls_and_keep_what_was_seen_apart(scene: Walls) -> None:
    question, covariance, offset, true = scene
    W = np.linalg.inv(covariance)
    assert labels(l1_planes(question, offset, covariance, W)) == labels(true)
    pair = np.flatnonzero(true[question.first] == true[question.second])[0]
    apart = question.apart.copy()
    apart[pair] = True
    plane = l1_planes(replace(question, apart=apart), offset, covariance, W)
    assert plane[question.first[pair]] != plane[question.second[pair]]


def test_a_clear_search_asks_no_second_candidate(scene: Walls) -> None:
    question, covariance, offset, true = scene
    decision = decide(question, covariance)
    assert decision.made_odds.min() > 2.0
    chosen = choose_planes(question, decision, offset, covariance, np.zeros(len(true), dtype=int), second=True)
    assert chosen.choices == ()
    assert chosen.decision is decision


def test_in_doubt_the_planes_of_larger_evidence_win_their_axis(scene: Walls) -> None:
    question, covariance, offset, true = scene
    alone = np.arange(len(true))  # nothing merged, and moves that may not join: all is left to the second candidate
    none = replace(question, log_prior=question.log_prior.copy())
    doubtful = replace(decided(question, alone), open=np.ones(len(question.first), dtype=bool))
    axis = (true >= 3).astype(int)
    chosen = choose_planes(none, doubtful, offset, covariance, axis, second=True)
    assert labels(chosen.decision.plane) == labels(true)
    for choice in chosen.choices:
        assert choice.taken == (choice.second_log_evidence - choice.first_log_evidence > 1.0)
    refused = choose_planes(none, doubtful, offset, covariance, axis, second=False)
    assert refused.choices == ()
