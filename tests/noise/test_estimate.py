"""The noise that a scan shows against the noise that was put in."""

import numpy as np
import pytest

from floorplan.noise.estimate import estimate_noise
from tests.block_scenes import SceneSettings, make_scene


def test_depth_noise_and_drift_come_out_as_put_in() -> None:
    noise = estimate_noise(make_scene(0).graph)
    assert 0.009 < np.median(noise.sigma_m) < 0.011
    assert 0.007 < noise.drift.rate_m_per_sqrt_m < 0.014
    assert 0.008 < noise.drift.scale_sigma < 0.04
    assert 0.004 < noise.drift.sideways_sigma < 0.02
    assert noise.flipped == 0
    assert noise.outliers < 20


@pytest.mark.parametrize("rate", [0.05, 0.2])
def test_a_bad_odometry_is_recognised(rate: float) -> None:
    noise = estimate_noise(make_scene(4, SceneSettings(rate_m_per_sqrt_m=rate)).graph)
    assert 0.7 * rate < noise.drift.rate_m_per_sqrt_m < 1.4 * rate
    assert 0.008 < np.median(noise.sigma_m) < 0.012


def test_flipped_signs_are_rejected_and_outliers_down_weighted() -> None:
    scene = make_scene(3, SceneSettings(outliers=0.05, flipped=0.005))
    graph = scene.graph
    noise = estimate_noise(graph)
    wrong = graph.distance_m * graph.facing[graph.track] > 0.1
    assert noise.flipped >= wrong.sum() > 10
    assert np.isinf(noise.sigma_m[wrong]).all()
    off = np.abs(scene.offset_m[graph.track] - scene.position_m[graph.frame, graph.axis[graph.track]] - graph.distance_m)
    wild = (off > 0.1) & ~wrong
    assert wild.sum() > 100
    assert np.median(noise.sigma_m[wild]) > 5 * np.median(noise.sigma_m[off < 0.02])


def test_a_noisier_sensor_is_recognised() -> None:
    noise = estimate_noise(make_scene(2, SceneSettings(depth_sigma_m=0.03)).graph)
    assert 0.026 < np.median(noise.sigma_m) < 0.034
