"""Errors of the sensor that last all scan long, in the covariance of the solution."""

import numpy as np
import pytest

from floorplan.model.graph import LayoutSolution
from floorplan.model.scan import NoiseModel, RangeAccuracy, Sensor, SensorKind
from floorplan.noise.range_accuracy import TYPICAL, range_accuracy, with_range_errors
from tests.bench.scenes import paper_scene


def solution(offset_m, axis):
    count = len(offset_m)
    return LayoutSolution(
        position_m=np.zeros((1, 3)),
        plane_of_track=np.arange(count),
        plane_axis=axis,
        plane_facing=np.ones(count, dtype=int),
        plane_offset_m=offset_m,
        plane_sigma_m=np.full(count, 0.001),
        plane_extent_m=np.full((count, 3, 2), np.nan),
        plane_covariance_m2=np.eye(count) * 1e-6,
        residual_m=0.0,
    )


@pytest.fixture
def graph():
    return paper_scene("area1", 1).graph


def with_accuracy(graph, accuracy):
    from dataclasses import replace

    return replace(graph, range_accuracy=accuracy)


def test_a_scale_error_widens_a_distance_by_its_part_wherever_the_walk_began(graph):
    accuracy = RangeAccuracy(scale_sigma=0.005, bias_sigma_m=0.0)
    for start in (0.0, 7.0):
        found = with_range_errors(solution(np.array([1.0, 11.0]) + start, np.array([0, 0])), with_accuracy(graph, accuracy))
        p = found.plane_covariance_m2
        assert np.sqrt(p[0, 0] + p[1, 1] - 2 * p[0, 1]) == pytest.approx(np.hypot(0.05, np.sqrt(2e-6)), rel=1e-9)


def test_axes_stay_uncorrelated_and_sigmas_are_those_of_the_covariance(graph):
    found = with_range_errors(solution(np.array([2.0, 3.0]), np.array([0, 1])), with_accuracy(graph, RangeAccuracy(0.01, 0.003)))
    assert found.plane_covariance_m2[0, 1] == 0.0
    assert np.allclose(found.plane_sigma_m**2, np.diag(found.plane_covariance_m2), rtol=1e-12)


def test_a_graph_that_says_nothing_of_its_sensor_leaves_the_solution_alone(graph):
    before = solution(np.array([2.0, 3.0]), np.array([0, 0]))
    assert with_range_errors(before, graph) is before


def test_what_a_recording_says_goes_before_what_is_typical():
    sensor = Sensor(SensorKind.LASER, 1, 180, NoiseModel(0.01), 0.1, 30.0, 0.01)
    stated = Sensor(SensorKind.LASER, 1, 180, NoiseModel(0.01), 0.1, 30.0, 0.01, None, RangeAccuracy(0.0, 0.0))
    assert range_accuracy(sensor) == TYPICAL[SensorKind.LASER]
    assert range_accuracy(stated) == RangeAccuracy(0.0, 0.0)
