"""What a merge made in doubt leaves open, and where it shows."""

import numpy as np
import pytest
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components

from floorplan.merge_slack import slack_m, slack_of_tracks_m
from floorplan.model.merges_made import MergesMade


@pytest.mark.parametrize("odds", [0.0, 0.4, 1.1, 2.2])
def test_an_interval_of_a_doubtful_merge_holds_95_percent_of_the_distances_that_may_be(odds: float) -> None:
    rng = np.random.default_rng(5)
    wrong = rng.random(200_000) < 1 / (1 + np.exp(odds))
    apart = np.where(wrong, rng.normal(0.0, 0.04, len(wrong)), 0.0)
    slack = slack_m(np.array([odds]), np.array([0.0]), np.array([0.04**2]))[0]
    assert np.mean(np.abs(apart) < 1.96 * slack) == pytest.approx(0.95, abs=0.003)


def test_a_merge_wrong_one_time_in_a_hundred_has_a_tenth_of_its_distance_as_slack() -> None:
    assert slack_m(np.log([99.0]), np.array([0.03]), np.array([0.04**2]))[0] == pytest.approx(0.005)


@pytest.mark.parametrize(("odds", "low_m", "high_m"), [(12.0, 0.0, 1e-4), (3.0, 0.5e-3, 2e-3)])
def test_a_sure_merge_has_no_slack_and_a_doubtful_one_a_part_of_its_sigma(odds: float, low_m: float, high_m: float) -> None:
    assert low_m < slack_m(np.array([odds]), np.array([0.002]), np.array([0.004**2]))[0] < high_m


def test_the_side_of_a_doubtful_merge_that_was_seen_less_moves_and_nothing_else_does() -> None:
    made = MergesMade([0, 2, 1, 5], [1, 3, 2, 6], [9.0, 9.0, 1.0, 9.0], [0.0, 0.0, 0.01, 0.0])
    moved = slack_of_tracks_m(made, np.arange(7), np.array([5, 5, 3, 3, 9, 9, 9]))
    assert not moved[:, :2].any()
    covariance = moved.T @ moved
    apart = np.array([[covariance[a, a] + covariance[b, b] - 2 * covariance[a, b] for b in range(7)] for a in range(7)])
    assert apart[0, 1] == apart[2, 3] == 0.0
    np.testing.assert_allclose(apart[:2, 2:4], 0.01**2)
    assert not covariance[4:, :].any()


@pytest.mark.parametrize("seed", [1, 2, 3])
def test_cutting_any_merge_of_any_forest_parts_the_tracks_as_its_connected_components_say(seed: int) -> None:
    rng = np.random.default_rng(seed)
    after = np.flatnonzero(rng.random(40) < 0.8)[1:]
    first, second = after, np.array([rng.integers(0, k) for k in after])
    turned = rng.random(len(after)) < 0.5
    first, second = np.where(turned, second, first), np.where(turned, first, second)
    tracks = np.sort(rng.choice(45, 30, replace=False))
    slack, rows = rng.uniform(0.001, 0.01, len(first)), rng.integers(1, 50, 45)
    doubtful = np.flatnonzero(np.isin(first, tracks))
    moved = slack_of_tracks_m(MergesMade(first, second, np.zeros(len(first)), slack), tracks, rows)
    assert len(moved) == len(doubtful) > 10
    for row, edge in zip(moved, doubtful, strict=True):
        others = np.arange(len(first)) != edge
        part = connected_components(coo_array((np.ones(others.sum()), (first[others], second[others])), shape=(45, 45)), directed=False)[1]
        sides = [part == part[first[edge]], part == part[second[edge]]]
        less = min(sides, key=lambda side: rows[side].sum())
        np.testing.assert_array_equal(row, less[tracks] * slack[edge])
