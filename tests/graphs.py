"""Small layout graphs for tests, written as rows one can check by hand."""

from collections.abc import Sequence

import numpy as np

from floorplan.model.graph import LayoutGraph


def graph_along_x(
    steps_m: Sequence[float],
    rows: Sequence[tuple[int, int, float]],
    facing: Sequence[int],
    sigma_m: Sequence[float] | None = None,
) -> LayoutGraph:
    """A graph whose planes are all normal to x; `rows` are (frame, track, distance), y and z have odometry 0 alone."""
    frame, track, distance = zip(*rows, strict=True)
    translation = np.zeros((len(steps_m), 3))
    translation[:, 0] = steps_m
    return LayoutGraph(
        stamp_s=np.arange(len(steps_m) + 1) / 10,
        translation_m=translation,
        frame=frame,
        track=track,
        distance_m=distance,
        axis=np.zeros(len(facing), dtype=np.int64),
        facing=facing,
        extent_m=np.full((len(facing), 3, 2), np.nan),
        sigma_m=sigma_m,
    )


def loop_graph(seed: int, rounds: int = 3, sigma_m: float = 0.02, drift_m: float = 0.01) -> tuple[LayoutGraph, np.ndarray, np.ndarray]:
    """A walk of several rounds about a box with an inner block: graph, true positions (N, 3), true plane of each track.

    Every round starts new tracks of the same eight walls, floor and ceiling.
    """
    rng = np.random.default_rng(seed)
    angle = np.linspace(0, 2 * np.pi * rounds, 60 * rounds + 1)
    position = np.stack((4 * np.sin(angle), 3 - 3 * np.cos(angle), np.zeros_like(angle)), axis=1)
    wall_axis = np.array([0, 0, 1, 1, 0, 0, 1, 1, 2, 2])
    wall_facing = np.array([1, -1, 1, -1, -1, 1, -1, 1, 1, -1])
    wall_m = np.array([-6.0, 6.0, -2.0, 8.0, -1.0, 1.0, 2.0, 4.0, -1.4, 1.3])
    frame, track, distance, axis, facing, plane = [], [], [], [], [], []
    for turn in range(rounds):
        for wall in range(len(wall_m)):
            seen = np.arange(turn * 60 + rng.integers(0, 10), turn * 60 + 50)
            d = wall_m[wall] - position[seen, wall_axis[wall]]
            seen, d = seen[d * wall_facing[wall] < -0.3], d[d * wall_facing[wall] < -0.3]
            frame.append(seen)
            track.append(np.full(len(seen), len(axis)))
            distance.append(d + rng.normal(0, sigma_m, len(seen)))
            axis.append(wall_axis[wall])
            facing.append(wall_facing[wall])
            plane.append(wall)
    graph = LayoutGraph(
        stamp_s=np.arange(len(position)) / 10,
        translation_m=np.diff(position, axis=0) + rng.normal(0, drift_m, (len(position) - 1, 3)),
        frame=np.concatenate(frame),
        track=np.concatenate(track),
        distance_m=np.concatenate(distance),
        axis=axis,
        facing=facing,
        extent_m=np.full((len(axis), 3, 2), np.nan),
    )
    return graph, position, np.array(plane)
