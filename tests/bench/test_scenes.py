"""The scenes are what they claim: sizes of the paper's table, truth that fits their rows, determinism."""

import numpy as np
import pytest

from tests.bench.scenes import PAPER_SCENES, Errors, SceneSpec, make_scene, paper_scene, scale_spec


@pytest.mark.parametrize("spec", PAPER_SCENES, ids=lambda spec: spec.name)
def test_a_scene_has_the_table_s_frames_and_tracks_and_its_rows_fit_the_truth(spec: SceneSpec) -> None:
    scene = make_scene(spec, seed=1, errors=Errors(sigma_m=0.001, sigma_per_m=0, odometry_factor=0))
    graph = scene.graph
    assert abs(len(graph.stamp_s) - spec.path_m * 10) < 10
    assert len(graph.axis) == spec.tracks
    assert spec.planes - 5 <= len(np.unique(scene.plane_of_track)) <= spec.planes
    offset = scene.planes.offset_m[scene.plane_of_track[graph.track]]
    error = graph.distance_m - (offset - scene.position_m[graph.frame, graph.axis[graph.track]])
    assert 0.0009 < error.std() < 0.0011
    assert (graph.distance_m * graph.facing[graph.track] < 0).all()
    assert np.linalg.norm(scene.position_m[-1]) < 1e-9  # back at the start
    assert (graph.extent_m[:, :, 0] <= graph.extent_m[:, :, 1]).all()


def test_drift_is_that_of_the_table_in_the_mean() -> None:
    drift = []
    for seed in range(12):
        scene = paper_scene("area1", seed)
        drift.append(np.linalg.norm(scene.graph.translation_m.sum(axis=0)))
    assert 0.5 < np.sqrt(np.mean(np.square(drift))) < 1.2


def test_errors_come_in_the_fractions_asked_for() -> None:
    scene = paper_scene("area2", 1, Errors(outliers=0.05, flipped=0.01, track_bias_m=0.012))
    graph = scene.graph
    offset = scene.planes.offset_m[scene.plane_of_track[graph.track]]
    distance = offset - scene.position_m[graph.frame, graph.axis[graph.track]]
    flipped = graph.distance_m * distance < 0
    assert 0.007 < flipped.mean() < 0.013
    error = np.abs(graph.distance_m - distance)[~flipped]
    assert 0.035 < (error > 0.1).mean() < 0.06


def test_a_scene_follows_from_its_seed_and_the_series_grows() -> None:
    one, again, other = (make_scene(scale_spec(1), seed) for seed in (1, 1, 2))
    np.testing.assert_array_equal(one.graph.distance_m, again.graph.distance_m)
    assert not np.array_equal(one.graph.translation_m, other.graph.translation_m)
    two = make_scene(scale_spec(2), 1)
    assert len(two.graph.axis) == 2 * len(one.graph.axis)
