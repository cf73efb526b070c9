"""Prior odds of pairs: what touches, what lies at opposite ends, what is a floor."""

import numpy as np
import pytest

from floorplan.merge.evidence_pairs import Planes, log_prior
from floorplan.merge.hypotheses import Pairs


def two_far_and_one_beside(axis: int, facing: int) -> Planes:
    """Three planes of 1 m by 1 m: the second beside the first, the third 60 m away."""
    extent = np.zeros((3, 3, 2))
    extent[:, :, 1] = 1.0
    along = (axis + 1) % 3
    extent[1, along] = 1.0, 2.0
    extent[2, along] = 61.0, 62.0
    same = np.zeros(3)
    return Planes(np.arange(3), np.full(3, axis), np.full(3, facing), same, 0.01 * np.eye(3), extent)


def priors(axis: int, facing: int) -> tuple[float, float]:
    beside, far = log_prior(two_far_and_one_beside(axis, facing), Pairs(np.array([0, 0]), np.array([1, 2])), np.full(2, 1e-4), None)
    return float(beside), float(far)


def test_walls_at_opposite_ends_are_unlikely_one_and_floors_likely() -> None:
    wall, floor, ceiling = priors(0, 1), priors(2, 1), priors(2, -1)
    assert 3.4 < wall[0] - wall[1] < 3.6
    assert 0.9 < floor[0] - floor[1] < 1.1
    assert ceiling[0] - ceiling[1] == pytest.approx(wall[0] - wall[1])
    assert floor[1] > 1.0 > wall[1]
