"""The joint chain of x and y: rates as parts of the true step."""

from dataclasses import replace

import numpy as np

from floorplan.model.graph import LayoutGraph
from floorplan.model.noise import DriftModel, ScanNoise, VerticalDrift
from floorplan.noise.estimate import with_steps
from floorplan.weighted_resolve import weighted_resolve

LENGTH_M, STEP_M, SEEN_M = 40.0, 0.1, 0.25  # too short a sight to tell the rates by
RATE = 0.06  # odometry 6 % too long on the way there, 6 % too short on the way back
NO_WHITE_ERROR = 1e-4


def _there_and_back() -> tuple[LayoutGraph, np.ndarray]:
    """A corridor along x between two walls, each seen from nearby; true positions (N, 3) from the first frame."""
    there = np.arange(0.0, LENGTH_M - 2 * STEP_M, STEP_M) + STEP_M
    x = np.concatenate((there, there[::-1]))
    position = np.stack((x - x[0], np.zeros_like(x), np.zeros_like(x)), axis=1)
    step = np.diff(position, axis=0)
    wrong = step * np.where(step[:, :1] > 0, 1 + RATE, 1 - RATE)
    frames, tracks = [], []
    for track, wall in enumerate((0.0, LENGTH_M)):
        seen = np.flatnonzero(np.abs(wall - x) < SEEN_M)
        frames.append(seen)
        tracks.append(np.full(len(seen), track))
    frame, track = np.concatenate(frames), np.concatenate(tracks)
    distance = np.array([0.0, LENGTH_M])[track] - x[frame]
    extent = np.full((2, 3, 2), np.nan)
    return LayoutGraph(np.arange(len(x)) * 0.1, wrong, frame, track, distance, np.array([0, 0]), np.array([1, -1]), extent), position


def _length(graph: LayoutGraph, noise: ScanNoise) -> float:
    offset = weighted_resolve(graph, np.array([0, 1]), noise).plane_offset_m
    return float(offset[1] - offset[0])


def test_passes_that_disagree_meet_in_the_middle_once_the_rates_are_parts_of_the_solved_step() -> None:
    graph, position = _there_and_back()
    drift = DriftModel(NO_WHITE_ERROR, RATE, RATE, global_scale_sigma=NO_WHITE_ERROR)
    noise = ScanNoise(np.full(len(graph.frame), 0.01), NO_WHITE_ERROR, drift, VerticalDrift(0.001, 0.001))
    # Rates as parts of odometry's own step: the pass that came out short counts more, 40 m come out short by about 2 * 0.06^2.
    assert -0.4 < _length(graph, noise) - LENGTH_M < -0.2
    solved = weighted_resolve(graph, np.array([0, 1]), noise)
    assert abs(_length(graph, with_steps(noise, solved.position_m)) - LENGTH_M) < 0.002
    assert abs(_length(graph, replace(noise, step_m=np.diff(position, axis=0))) - LENGTH_M) < 0.002
