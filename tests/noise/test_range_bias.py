"""The depth's own errors: found on scans with a known bias, both ways, and taken out on request."""

from dataclasses import replace

import numpy as np
import pytest

from floorplan.config import ReadConfig
from floorplan.errors import ConfigError
from floorplan.least_squares import robust_least_squares
from floorplan.model.graph import LayoutGraph
from floorplan.model.noise import DriftModel
from floorplan.model.range_bias import RangeBias
from floorplan.model.scan import Frame, RangeAccuracy
from floorplan.noise.range_bias import estimate_range_bias, wandering_scale_variance
from floorplan.readers.corrected import corrected
from floorplan.survey_advice import range_advice
from tests.bench.scenes import paper_scene
from tests.box_room import camera_scan, laser_scan


def scan_with_bias(scale: float, offset_m: float, seed: int) -> tuple[LayoutGraph, np.ndarray]:
    """A scene of the paper's size whose every distance carries the bias; each plane met at depths of its own, and the rows' levers."""
    graph = replace(paper_scene("area4", seed).graph, range_accuracy=RangeAccuracy(0.0, 0.001))
    random = np.random.default_rng(seed)
    depth = np.abs(graph.distance_m) * random.uniform(1.0, 3.0, len(graph.distance_m)) + 0.3
    lever = graph.distance_m / depth
    return replace(graph, distance_m=graph.distance_m * (1 + scale) + offset_m * lever), lever


def estimate(scale: float, offset_m: float, seed: int) -> RangeBias:
    graph, lever = scan_with_bias(scale, offset_m, seed)
    solved = robust_least_squares(graph)
    assert solved.noise is not None
    return estimate_range_bias(graph, solved.noise, solved, lever)


@pytest.mark.parametrize("offset_m", [-0.03, 0.03])
@pytest.mark.parametrize("scale", [-0.1, 0.1])
def test_a_bias_of_either_sign_is_found(scale: float, offset_m: float) -> None:
    found, none = estimate(scale, offset_m, 3), estimate(0.0, 0.0, 3)
    assert found.offset_m - none.offset_m == pytest.approx(offset_m, abs=0.006)
    assert found.scale - none.scale == pytest.approx(scale, abs=0.03)
    assert found.scale_is_significant
    assert found.offset_is_significant


@pytest.mark.parametrize("seed", [1, 2, 3, 4])
def test_a_sensor_without_bias_is_not_accused_and_the_sigmas_hold(seed: int) -> None:
    found = estimate(0.0, 0.0, seed)
    assert abs(found.scale) < 3 * found.scale_sigma
    assert abs(found.offset_m) < 3 * found.offset_sigma_m
    assert 0.01 <= found.scale_sigma < 0.03
    assert 0.001 <= found.offset_sigma_m < 0.01


@pytest.mark.parametrize("path_m", [10.0, 60.0, 300.0])
def test_what_a_wandering_scale_leaves_in_the_mean_of_a_walk_is_what_drawn_walks_leave(path_m: float) -> None:
    random, drift, steps = np.random.default_rng(4), DriftModel(0.005, 0.02, 0.02), 100
    kept = np.exp(-path_m / steps / drift.correlation_m)
    scale = drift.scale_sigma * random.normal(size=3000)
    total = np.zeros(3000)
    for _ in range(steps):
        total += scale
        scale = kept * scale + drift.scale_sigma * np.sqrt(1 - kept**2) * random.normal(size=3000)
    graph = paper_scene("area4", 1).graph
    count = len(graph.stamp_s) - 1
    graph = replace(graph, translation_m=np.tile((path_m / count, 0.0, 0.0), (count, 1)))
    assert np.sqrt(wandering_scale_variance(drift, graph)) == pytest.approx((total / steps).std(), rel=0.08)


def test_advice_names_the_setting_and_speaks_only_of_what_is_sure() -> None:
    assert range_advice(None) == ()
    assert range_advice(RangeBias(0.01, 0.01, 0.004, 0.004)) == ()
    sure = range_advice(RangeBias(0.041, 0.01, -0.02, 0.004))
    assert [one.code for one in sure] == ["range-scale", "range-offset"]
    assert "read.range_scale=1.0410" in sure[0].advice
    assert "read.range_offset_mm=-20" in sure[1].advice


@pytest.mark.parametrize("box", [camera_scan(2), laser_scan(2)], ids=["camera", "laser"])
def test_what_is_corrected_at_reading_is_what_the_sensor_added(box) -> None:
    true = next(iter(box.frames([0])))
    camera = true.points.shape[0] > 1

    class Biased:
        recording = box.recording

        def frames(self, indices, stride=1):
            reading = true.points[..., 2] if camera else np.linalg.norm(true.points, axis=-1)
            yield Frame(0, 0, (true.points * ((1.02 * reading - 0.03) / reading)[..., None]).astype(np.float32))

    again = next(iter(corrected(Biased(), ReadConfig(range_scale=1.02, range_offset_mm=-30.0)).frames([0])))
    assert np.nanmax(np.abs(again.points - true.points)) < 1e-5
    other = next(iter(corrected(Biased(), ReadConfig(range_scale=1.02)).frames([0])))
    assert np.nanmedian(np.abs(other.points - true.points).max(axis=-1)) > 0.015


def test_nothing_is_touched_unless_asked_and_nonsense_is_refused() -> None:
    box = camera_scan(2)
    assert corrected(box, ReadConfig()) is box
    with pytest.raises(ConfigError, match="depth_scale"):
        corrected(box, ReadConfig(range_scale=1000.0))
