"""What all rows of a track share, from tracks of the same surface that disagree."""

import numpy as np
import pytest

from floorplan.merge.evidence_bias import USUAL, Bias, bias_of_merged
from floorplan.merge.evidence_pairs import Planes

PLANES, SIGHTINGS = 40, 4
KNOWN_M = 0.001  # odometry's part


def _found(seed: int, true: Bias) -> Bias:
    """The bias that 40 surfaces, each seen four times from 1 to 8 m, tell of, when it truly is `true`."""
    rng = np.random.default_rng(seed)
    count = PLANES * SIGHTINGS
    plane, square = np.repeat(np.arange(PLANES), SIGHTINGS), rng.uniform(1.0, 8.0, count) ** 2
    none = np.zeros(count, dtype=np.int64)
    planes = Planes(
        np.arange(count), none, none + 1, np.zeros(count), KNOWN_M**2 * np.eye(count), np.zeros((count, 3, 2)), np.full(count, 1e-4), square
    )
    offset = rng.uniform(-20.0, 20.0, PLANES)[plane] + rng.normal(0.0, np.hypot(true.of(planes), KNOWN_M))
    planes = Planes(planes.tracks, none, none + 1, offset, planes.covariance_m2, planes.extent_m, planes.row_sigma_m, square)
    return bias_of_merged([planes], [plane], USUAL)


@pytest.mark.parametrize("seed", range(3))
def test_a_camera_that_triangulates_badly_is_known_by_what_it_saw_from_far(seed: int) -> None:
    found = _found(seed, Bias(0.001, 0.0, 0.003))
    assert 0.0015 <= found.far_per_m <= 0.006
    assert found.constant_m <= 0.008  # 12 mm from 2 m


@pytest.mark.parametrize("seed", range(3))
def test_a_bias_that_is_the_same_from_near_and_far_is_not_taken_for_one_that_grows(seed: int) -> None:
    found = _found(seed, Bias(0.01, 0.0, 0.0))
    assert found.constant_m == pytest.approx(0.01, rel=0.3)
    assert found.far_per_m * 8.0**2 < 0.015


def test_what_was_seen_once_from_far_is_as_uncertain_as_that_and_the_near_is_not() -> None:
    count = 2
    extent, sigma = np.zeros((count, 3, 2)), np.full(count, 1e-4)
    planes = Planes(np.arange(count), np.zeros(count), np.ones(count), np.zeros(count), np.eye(count), extent, sigma, np.array([1.0, 64.0]))
    assert Bias(0.002, 0.5, 0.003).of(planes) == pytest.approx([np.hypot(0.002, 0.003), np.hypot(0.002, 0.192)], rel=1e-3)
