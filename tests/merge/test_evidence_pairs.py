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
    return Planes(np.arange(3), np.full(3, axis), np.full(3, facing), same, 0.01 * np.eye(3), extent, np.full(3, 0.01), np.full(3, 4.0))


def priors(axis: int, facing: int) -> tuple[float, float]:
    beside, far = log_prior(two_far_and_one_beside(axis, facing), Pairs(np.array([0, 0]), np.array([1, 2])), np.full(2, 1e-4), None)
    return float(beside), float(far)


def test_walls_at_opposite_ends_are_unlikely_one_and_floors_likely() -> None:
    wall, floor, ceiling = priors(0, 1), priors(2, 1), priors(2, -1)
    assert 3.4 < wall[0] - wall[1] < 3.6
    assert 0.9 < floor[0] - floor[1] < 1.1
    assert ceiling[0] - ceiling[1] == pytest.approx(wall[0] - wall[1])
    assert floor[1] > 1.0 > wall[1]


def strewn(offset_m: np.ndarray, sigma_m: float) -> Planes:
    """Ceilings at these heights, 1 m apart from each other in plan, every one its own plane."""
    count = len(offset_m)
    extent = np.stack((np.zeros((count, 3)), np.ones((count, 3))), axis=2)
    same = np.full(count, 2), np.full(count, -1)
    return Planes(np.arange(count), *same, offset_m, sigma_m**2 * np.eye(count), extent, np.full(count, 0.01), np.full(count, 4.0))


def test_where_planes_keep_nearly_one_line_a_coincidence_costs_more() -> None:
    rng = np.random.default_rng(3)
    clustered, strewn_m = 2.5 + 0.1 * rng.standard_normal(30), rng.uniform(0.0, 30.0, 30)
    clustered[-1] = 12.0
    pair = Pairs(np.array([0]), np.array([1]))
    costs = []
    for offset, sigma in ((clustered, 0.001), (clustered, 0.2), (strewn_m, 0.001)):
        planes = strewn(offset, sigma)
        uniform = 30 / (np.ptp(offset) + 2.5)
        likeness = log_prior(strewn(np.zeros(30), sigma), pair, np.full(1, 1e-4), np.zeros(30)) + np.log(1 / 2.5)
        costs.append(float(likeness[0] - log_prior(planes, pair, np.full(1, 1e-4), np.arange(30))[0] - np.log(uniform)))
    assert 1.5 < costs[0] < 4.0
    assert costs[1] == pytest.approx(0.0, abs=0.01)
    assert costs[2] == pytest.approx(0.0, abs=0.5)
