"""Frames a short walk apart taken together."""

import numpy as np

from floorplan.elimination.windows import windows
from floorplan.noise.lumps import lumped
from tests.bench.scenes import paper_scene


def test_lumps_keep_the_path_the_tracks_and_the_information_of_the_rows():
    graph = paper_scene("area1", 1).graph
    whole = windows(graph, len(graph.stamp_s))[0]
    sigma = np.full(len(graph.track), 0.01)
    sigma[::7] = np.inf
    small, small_sigma = lumped(whole, sigma)
    assert len(graph.stamp_s) / 6 < len(small.stamp_s) < len(graph.stamp_s) / 4
    assert np.isclose((small_sigma**-2).sum(), (sigma**-2).sum())
    assert np.linalg.norm(small.translation_m.sum(axis=0) - graph.translation_m.sum(axis=0)) < 0.6


def test_rows_of_one_wall_in_one_lump_become_their_mean_at_its_mean_place():
    graph = paper_scene("area1", 1).graph
    whole = windows(graph, len(graph.stamp_s))[0]
    small, _ = lumped(whole, np.full(len(graph.track), 0.01))
    dead = np.vstack([np.zeros(3), np.cumsum(graph.translation_m, axis=0)])
    level = graph.distance_m + dead[graph.frame, graph.axis[graph.track]]
    start = dead[:5].mean(axis=0)  # the first lump: half a metre of frames a tenth apart
    first = small.frame == 0
    centre = small.distance_m[first] + start[small.axis[small.track[first]]]
    for track, found in zip(small.track[first], centre, strict=True):
        seen = level[(graph.track == track) & (graph.frame < 5)]
        assert abs(found - seen.mean()) < 0.01
