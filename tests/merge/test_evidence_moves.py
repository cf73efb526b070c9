"""Moves after merging against the log evidence computed from scratch."""

from dataclasses import replace

import numpy as np
import pytest

from floorplan.merge.evidence_greedy import Decision, Question, decide
from floorplan.merge.evidence_moves import move_tracks
from floorplan.merge.plane_fit import fit_planes
from tests.merge.test_evidence_greedy import walls

PLANES, SEEN, LAPS = 8, 6, 2
APART_M, SHIFT_M, KNOWN_M, NOISE_M = 1.5, 0.4, 0.02, 0.003

Walls = tuple[Question, np.ndarray, np.ndarray, np.ndarray]


@pytest.fixture(scope="module")
def scene() -> Walls:
    return walls(10, 8, seed=4)


def labels(plane: np.ndarray) -> list[int]:
    """Labels by first appearance: equal lists are equal partitions."""
    first, inverse = np.unique(plane, return_index=True, return_inverse=True)[1:]
    return np.argsort(np.argsort(first))[inverse].tolist()


def decided(question: Question, plane: np.ndarray) -> Decision:
    """A decision for `plane`, its merges a star about the first track of each plane."""
    nothing = np.zeros(0)
    return Decision(
        plane, question.delta_m.copy(), question.variance_m2.copy(), np.zeros(len(question.first), dtype=bool), 0.0,
        nothing.astype(np.int64), nothing,
    )  # fmt: skip


def log_density(covariance: np.ndarray, offset: np.ndarray, plane: np.ndarray) -> float:
    """Of all distances inside the planes, from the covariance itself."""
    tied = [np.flatnonzero(plane == p) for p in np.unique(plane)]
    E = np.concatenate([np.eye(len(offset))[group[1:]] - np.eye(len(offset))[group[0]] for group in tied])
    spread, apart = E @ covariance @ E.T, E @ offset
    return float(-0.5 * (apart @ np.linalg.solve(spread, apart) + np.linalg.slogdet(spread)[1] + len(E) * np.log(2 * np.pi)))


def test_the_evidence_of_a_partition_is_the_density_of_the_distances_inside_its_planes(scene: Walls) -> None:
    _, covariance, offset, true = scene
    W, other = np.linalg.inv(covariance), np.where(np.arange(len(true)) == 5, (true + 1) % 10, true)
    ours = fit_planes(W, offset, true).log_evidence - fit_planes(W, offset, other).log_evidence
    assert ours == pytest.approx(log_density(covariance, offset, true) - log_density(covariance, offset, other), abs=1e-6)
    assert ours > 10


def test_a_track_on_the_wrong_plane_goes_to_its_own_and_the_gain_is_that_of_the_evidence(scene: Walls) -> None:
    question, covariance, offset, true = scene
    wrong = true.copy()
    wrong[7] = true[np.flatnonzero(np.abs(true - true[7]) == 1)[0]]
    asked = replace(question, apart=np.zeros_like(question.apart))
    moved = move_tracks(asked, decided(asked, wrong), wrong, offset, np.linalg.inv(covariance))
    assert labels(moved.decision.plane) == labels(true)
    assert [move.tracks for move in moved.moves] == [(7,)]
    gained = log_density(covariance, offset, true) - log_density(covariance, offset, wrong)
    assert moved.moves[0].log_evidence == pytest.approx(gained, abs=1e-6)  # the prior is one for all pairs
    assert true[moved.moves[0].target] == true[7]


def test_what_is_right_stays_and_so_does_the_decision(scene: Walls) -> None:
    question, covariance, offset, _ = scene
    decision = decide(question, covariance)
    moved = move_tracks(question, decision, decision.plane, offset, np.linalg.inv(covariance))
    assert moved.moves == ()
    assert moved.decision is decision


def two_laps(seed: int) -> Walls:
    """`PLANES` walls seen in each of two laps that lie SHIFT_M beside each other, as odometry that is known to 0.3 m has it."""
    rng = np.random.default_rng(seed)
    true, lap = np.tile(np.repeat(np.arange(PLANES), SEEN), LAPS), np.repeat(np.arange(LAPS), PLANES * SEEN)
    covariance = np.where(lap[:, None] & lap[None, :], 0.3**2, 0.0) + KNOWN_M**2 * (true[:, None] == true[None, :]) / 100
    covariance = covariance + NOISE_M**2 * np.eye(len(true))
    place = APART_M * np.cumsum(rng.uniform(0.7, 1.3, PLANES))  # unevenly, or a lap fits one wall further on as well
    offset = place[true] + SHIFT_M * lap + rng.normal(0, NOISE_M, len(true))
    first, second = np.nonzero(np.triu(np.abs(offset[:, None] - offset[None]) < 2 * APART_M, 1))
    variance = covariance[first, first] + covariance[second, second] - 2 * covariance[first, second]
    question = Question(first, second, offset[first] - offset[second], variance, np.full(len(first), 1.0), np.zeros(len(first), dtype=bool))
    return question, covariance, offset, true


def test_one_wrong_track_that_holds_two_laps_apart_lets_go_and_all_walls_are_joined() -> None:
    question, covariance, offset, true = two_laps(1)
    held = np.where(np.arange(len(true)) < PLANES * SEEN, true, true + PLANES)
    held[SEEN] = PLANES  # a track of the first lap's second wall on the first wall of the other: no shift is left to be taken out
    moved = move_tracks(question, decided(question, held), held, offset, np.linalg.inv(covariance))
    assert labels(moved.decision.plane) == labels(true)
    assert moved.moves[0].joined >= PLANES - 1
    rows = moved.decision.made
    assert len(rows) == len(true) - PLANES  # a tree for every plane that was changed
    assert (true[question.first[rows]] == true[question.second[rows]]).all()
    assert (moved.decision.made_odds > 0).all()


def test_what_one_frame_saw_apart_is_never_joined_by_a_move() -> None:
    question, covariance, offset, true = two_laps(2)
    apart = np.zeros(len(question.first), dtype=bool)
    apart[np.flatnonzero((true[question.first] == 3) & (true[question.second] == 3) & (question.second >= PLANES * SEEN))[0]] = True
    by_lap = np.where(np.arange(len(true)) < PLANES * SEEN, true, true + PLANES)
    asked = replace(question, apart=apart)
    plane = move_tracks(asked, decided(asked, by_lap), by_lap, offset, np.linalg.inv(covariance)).decision.plane
    assert (plane[question.first[apart]] != plane[question.second[apart]]).all()
    assert len(np.unique(plane)) == PLANES + 1
