"""What the +- of a distance is made of: parts by cause, whose squares add up."""

import itertools
from dataclasses import replace
from functools import cache

import numpy as np
import pytest

from floorplan.config import LeastSquaresConfig, MergeConfig, ResolveConfig
from floorplan.least_squares import least_squares
from floorplan.merge import merge
from floorplan.model.error_parts import ErrorCause, SigmaParts
from floorplan.model.graph import LayoutSolution
from floorplan.model.scan import RangeAccuracy
from floorplan.model.ties import DistanceTies
from floorplan.resolve import resolve
from floorplan.weighted_resolve import weighted_resolve
from tests.bench.scenes import SceneSpec, make_scene

SPEC = SceneSpec("ring", path_m=70, laps=2, tracks=70, planes=18, drift_m=1.2)


@cache
def _solved(scale_sigma: float, bias_sigma_m: float, tape: bool = False) -> LayoutSolution:
    scene = replace(make_scene(SPEC, 600).graph, range_accuracy=RangeAccuracy(scale_sigma, bias_sigma_m))
    merged = merge(scene, least_squares(scene, LeastSquaresConfig()), MergeConfig())
    plain = resolve(scene, merged, ResolveConfig())
    if not tape or merged.noise is None:
        return plain
    low, high = _longest(plain)
    span = [float(plain.plane_offset_m[high] - plain.plane_offset_m[low])]
    ties = DistanceTies(np.array([low]), np.array([high]), np.array(span), np.array([0.002]), scale_sigma, bias_sigma_m)
    return weighted_resolve(scene, merged.plane_of_track, merged.noise, ties=ties, made=merged.made)


def _longest(solution: LayoutSolution) -> tuple[int, int]:
    along = np.flatnonzero(solution.plane_axis == 0)
    return int(along[solution.plane_offset_m[along].argmin()]), int(along[solution.plane_offset_m[along].argmax()])


def _parts(solution: LayoutSolution, a: int, b: int) -> tuple[SigmaParts, float]:
    C, parts = solution.plane_covariance_m2, solution.error_parts
    assert C is not None
    assert parts is not None
    sigma = float(np.sqrt(C[a, a] + C[b, b] - 2 * C[a, b]))
    return parts.of_distance(a, b, sigma), sigma


@pytest.mark.parametrize("tape", [False, True])
def test_the_squares_of_the_parts_add_up_to_that_of_the_whole(tape: bool) -> None:
    solution = _solved(0.005, 0.004, tape)
    for axis in range(3):
        mine = np.flatnonzero(solution.plane_axis == axis)
        for a, b in itertools.pairwise(mine):
            parts, sigma = _parts(solution, a, b)
            assert np.sqrt(sum(size**2 for _, size in parts.by_size)) == pytest.approx(sigma, rel=1e-3)


def test_scale_and_sensor_are_those_stated_and_nothing_else_changes_with_them() -> None:
    stated, exact = _solved(0.005, 0.004), _solved(0.0, 0.0)
    a, b = _longest(stated)
    parts, without = _parts(stated, a, b)[0], _parts(exact, a, b)[0]
    assert parts.scale_m == pytest.approx(0.005 * (stated.plane_offset_m[b] - stated.plane_offset_m[a]), rel=1e-3)
    assert parts.sensor_m == pytest.approx(0.004 * np.sqrt(2), rel=1e-3)
    assert without.scale_m == without.sensor_m == parts.tape_m == 0.0
    assert (parts.path_m, parts.surfaces_m, parts.merges_m) == pytest.approx(
        (without.path_m, without.surfaces_m, without.merges_m), rel=1e-2
    )


def test_the_path_is_the_largest_part_of_a_long_distance_on_an_exact_sensor() -> None:
    solution = _solved(0.0, 0.0)
    assert _parts(solution, *_longest(solution))[0].by_size[0][0] is ErrorCause.PATH


def test_a_tape_makes_every_part_of_its_distance_small_but_its_own() -> None:
    plain, tied = _solved(0.005, 0.004), _solved(0.005, 0.004, tape=True)
    a, b = _longest(plain)
    before, after = _parts(plain, a, b)[0], _parts(tied, a, b)[0]
    assert after.by_size[0][0] is ErrorCause.TAPE
    assert after.tape_m == pytest.approx(0.002, rel=0.1)
    assert after.scale_m < 0.1 * before.scale_m
    assert after.path_m < 0.1 * before.path_m


def test_a_solution_without_covariance_has_no_parts() -> None:
    scene = make_scene(SPEC, 600).graph
    merged = merge(scene, least_squares(scene, LeastSquaresConfig()), MergeConfig())
    assert resolve(scene, merged, ResolveConfig(covariance=False)).error_parts is None
