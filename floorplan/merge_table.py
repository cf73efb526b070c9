"""Every hypothesis of the merge as a row to read: the two tracks, the numbers, the verdict, the frames that saw both sides."""

from dataclasses import dataclass

import numpy as np

from floorplan.initial_layout import InitialLayout
from floorplan.model.checks import Array
from floorplan.model.graph import MergeResult
from floorplan.model.scan import IngestedScan

AXIS_NAMES = ("x", "y", "z")


@dataclass(frozen=True)
class TrackSighting:
    """One side: row of the track, its offset after the least squares that the merge started from (m), how many keyframes saw it,

    first and last frame of the recording.
    """

    track: int
    offset_m: float
    keyframes: int
    first_frame: int
    last_frame: int


@dataclass(frozen=True)
class MergeRow:
    """One hypothesis. `distance_m` after least squares, `solved_distance_m` when it was decided.

    `sigma_m` and `chi_square` are None where the method has none.
    `frames_of_both`: frames of the recording (0 is the first) that measured both sides at once; `plane`: the final planes they went to.
    """

    first: TrackSighting
    second: TrackSighting
    axis: str
    facing: int
    distance_m: float
    solved_distance_m: float
    sigma_m: float | None
    chi_square: float | None
    verdict: str
    accepted: bool
    plane: tuple[int, int]
    frames_of_both: tuple[int, ...]


def merge_rows(scan: IngestedScan, layout: InitialLayout, merged: MergeResult) -> tuple[MergeRow, ...]:
    """One row per hypothesis, in the order of the merge."""
    seen, offset_m = _frames_of_tracks(scan, layout), layout.before_merge(merged.method).track_offset_m
    pairs, accepted = merged.hypotheses, merged.hypotheses.accepted
    rows = []
    for h, (a, b) in enumerate(zip(pairs.first.tolist(), pairs.second.tolist(), strict=True)):
        rows.append(
            MergeRow(
                _sighting(a, seen[a], offset_m),
                _sighting(b, seen[b], offset_m),
                AXIS_NAMES[int(layout.graph.axis[a])],
                int(layout.graph.facing[a]),
                float(pairs.distance_m[h]),
                float(pairs.solved_distance_m[h]),
                _number(pairs.sigma_m[h]),
                _number(pairs.chi_square[h]),
                pairs.verdict[h].value,
                bool(accepted[h]),
                (int(merged.plane_of_track[a]), int(merged.plane_of_track[b])),
                tuple(np.intersect1d(seen[a], seen[b]).tolist()),
            )
        )
    return tuple(rows)


def _frames_of_tracks(scan: IngestedScan, layout: InitialLayout) -> list[Array]:
    """For each track the rows of the recording that measured it, increasing."""
    graph = layout.graph
    order = np.lexsort((graph.frame, graph.track))
    starts = np.searchsorted(graph.track[order], np.arange(1, len(graph.axis)))
    return [np.unique(scan.keyframe[frames]) for frames in np.split(graph.frame[order], starts)]


def _sighting(track: int, frames: Array, offset_m: Array) -> TrackSighting:
    return TrackSighting(track, float(offset_m[track]), len(frames), int(frames[0]), int(frames[-1]))


def _number(value: float) -> float | None:
    return float(value) if np.isfinite(value) else None
