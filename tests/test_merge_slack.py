"""What a merge made in doubt leaves open, and where it shows."""

import numpy as np
import pytest

from floorplan.merge_slack import slack_m, slack_of_tracks_m
from floorplan.model.merges_made import MergesMade


def test_a_merge_wrong_one_time_in_four_has_half_of_its_distance_as_slack() -> None:
    assert slack_m(np.log([3.0]), np.array([0.03]), np.array([0.04**2]))[0] == pytest.approx(0.025)


@pytest.mark.parametrize(("odds", "low_m", "high_m"), [(12.0, 0.0, 1e-4), (3.0, 0.5e-3, 2e-3)])
def test_a_sure_merge_has_no_slack_and_a_doubtful_one_a_part_of_its_sigma(odds: float, low_m: float, high_m: float) -> None:
    assert low_m < slack_m(np.array([odds]), np.array([0.002]), np.array([0.004**2]))[0] < high_m


def test_the_two_sides_of_a_doubtful_merge_move_apart_and_nothing_else_does() -> None:
    made = MergesMade([0, 2, 1, 5], [1, 3, 2, 6], [9.0, 9.0, 1.0, 9.0], [0.0, 0.0, 0.01, 0.0])
    moved = slack_of_tracks_m(made, np.arange(7))
    covariance = moved.T @ moved
    apart = np.array([[covariance[a, a] + covariance[b, b] - 2 * covariance[a, b] for b in range(7)] for a in range(7)])
    assert apart[0, 1] == apart[2, 3] == 0.0
    np.testing.assert_allclose(apart[:2, 2:4], 0.01**2)
    assert not covariance[4:, :].any()
