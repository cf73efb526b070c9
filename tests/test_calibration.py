"""The standard deviations of distances are right: neither too small nor too large, near and far, and long distances lean to no side."""

from dataclasses import dataclass

import numpy as np
import pytest

from floorplan.config import LeastSquaresConfig, MergeConfig, ResolveConfig
from floorplan.least_squares import least_squares
from floorplan.merge import merge
from floorplan.resolve import resolve
from tests.bench.scenes import Scene, SceneSpec, make_scene

SCENES = 48
SPEC = SceneSpec("ring", path_m=70, laps=2, tracks=70, planes=18, drift_m=1.2)  # two laps: passes whose odometry disagrees
WITHIN_95 = 1.96
NEAR_M = 8.0


@dataclass(frozen=True)
class Standardised:
    """Errors over their standard deviations: of all near distances, and of the longest along x and along y of every scene.

    The sign is that of "came out too long".
    """

    near: np.ndarray
    longest: np.ndarray


@pytest.fixture(scope="module")
def errors() -> Standardised:
    """The default back end on many small scenes with 2 to 5 % of odometry error."""
    found = [_standardised(make_scene(SPEC, seed)) for seed in range(600, 600 + SCENES)]
    return Standardised(np.concatenate([f.near for f in found]), np.concatenate([f.longest for f in found]))


def _standardised(scene: Scene) -> Standardised:
    graph = scene.graph
    solution = resolve(graph, merge(graph, least_squares(graph, LeastSquaresConfig()), MergeConfig()), ResolveConfig())
    truth = scene.planes.offset_m[scene.plane_of_track]
    true = np.array([np.median(truth[solution.plane_of_track == k]) for k in range(len(solution.plane_axis))])
    error, covariance = solution.plane_offset_m - true, solution.plane_covariance_m2
    assert covariance is not None
    near, longest = [], []
    for axis in (0, 1):
        mine = np.flatnonzero(solution.plane_axis == axis)
        a, b = (mine[k] for k in np.nonzero(true[mine][:, None] < true[mine][None, :]))
        z = (error[b] - error[a]) / np.sqrt(covariance[a, a] + covariance[b, b] - 2 * covariance[a, b])
        near.append(z[true[b] - true[a] <= NEAR_M])
        longest.append(z[[np.argmax(true[b] - true[a])]])
    return Standardised(np.concatenate(near), np.concatenate(longest))


def test_95_percent_intervals_of_near_distances_are_neither_too_narrow_nor_too_wide(errors: Standardised) -> None:
    assert 0.90 <= np.mean(np.abs(errors.near) < WITHIN_95) <= 0.98


def test_95_percent_intervals_of_the_longest_distances_are_neither_too_narrow_nor_too_wide(errors: Standardised) -> None:
    assert 0.90 <= np.mean(np.abs(errors.longest) < WITHIN_95) <= 0.99  # one of a hundred more: there are but two of them per scene
    assert 0.8 <= np.sqrt(np.mean(errors.longest**2)) <= 1.2


def test_long_distances_come_out_neither_short_nor_long_on_average(errors: Standardised) -> None:
    assert abs(errors.longest.mean()) < 3 / np.sqrt(len(errors.longest))
