"""From segments and tracks to the layout graph: odometry rows and measurements (METHOD.md, step 3)."""

from dataclasses import dataclass, replace

import numpy as np

from floorplan.model.checks import Array
from floorplan.model.graph import LayoutGraph
from floorplan.model.scan import NANOSECONDS_PER_SECOND, IngestedScan
from floorplan.model.segment import NO_TRACK, SegmentedScan, Segments, Tracks
from floorplan.noise.range_accuracy import range_accuracy
from floorplan.odometry_steps import keyframe_steps


def layout_graph(scan: IngestedScan, segmented: SegmentedScan, tracks: Tracks) -> LayoutGraph:
    """The graph of all keyframes and tracks; stamps are seconds since the first keyframe.

    Rows whose sign contradicts their facing are left out (see `with_signs_from_facing`, which counts them).
    """
    recording = scan.recording
    rows = _one_row_per_frame_and_track(segmented.segments, tracks)
    graph = LayoutGraph(
        stamp_s=_seconds(scan),
        translation_m=keyframe_steps(scan, segmented.frames.world_from_sensor),
        frame=rows.frame,
        track=rows.track,
        distance_m=rows.distance_m,
        axis=tracks.axis,
        facing=tracks.facing,
        extent_m=tracks.extent_m,
        sigma_m=rows.sigma_m,
        heading_sigma_rad=0.0 if scan.mapped else float(np.median(segmented.frames.yaw_sigma_rad)),
        range_accuracy=range_accuracy(recording.sensor),
        map_sigma_m=None if scan.map_sigma_m is None else scan.map_sigma_m[scan.keyframe],
        link=np.array([part.first_keyframe - 1 for part in scan.linked], dtype=np.int64),
        link_sigma_m=np.array([part.link_sigma_m for part in scan.linked]).reshape(-1, 3),
    )
    return with_signs_from_facing(graph)[0]


def _seconds(scan: IngestedScan) -> Array:
    """Seconds (F,) since the first keyframe; scans recorded at other times follow each other without a pause."""
    stamp_ns = scan.recording.stamp_ns[scan.keyframe]
    steps = np.diff(stamp_ns)
    steps[[part.first_keyframe - 1 for part in scan.linked]] = 0
    return np.concatenate(([0.0], np.cumsum(steps))) / NANOSECONDS_PER_SECOND


def sign_disagrees(graph: LayoutGraph) -> Array:
    """Boolean (K,): measurements whose distance has the sign of their facing, as if the sensor had seen a surface from behind."""
    return np.asarray(graph.distance_m * graph.facing[graph.track] > 0)


def with_signs_from_facing(graph: LayoutGraph) -> tuple[LayoutGraph, int]:
    """The graph without the rows whose sign contradicts their facing, and how many those were.

    A track of which every row disagrees keeps them with the sign of its facing, because a track without rows has no place.
    """
    wrong = sign_disagrees(graph)
    if not wrong.any():
        return graph, 0
    right_of_track = np.bincount(graph.track[~wrong], minlength=len(graph.axis))
    keep = ~wrong | (right_of_track[graph.track] == 0)
    signed = np.where(wrong, -graph.distance_m, graph.distance_m)
    return with_rows(replace(graph, distance_m=signed), keep), int(wrong.sum())


def with_rows(graph: LayoutGraph, keep: Array) -> LayoutGraph:
    """The graph with the measurements selected by the boolean `keep (K,)` alone."""
    sigma = None if graph.sigma_m is None else graph.sigma_m[keep]
    return replace(graph, frame=graph.frame[keep], track=graph.track[keep], distance_m=graph.distance_m[keep], sigma_m=sigma)


@dataclass(frozen=True)
class _Measurements:
    """Rows before they join the graph: `frame (K,)`, `track (K,)`, `distance_m (K,)`, `sigma_m (K,)`."""

    frame: Array
    track: Array
    distance_m: Array
    sigma_m: Array


def _one_row_per_frame_and_track(segments: Segments, tracks: Tracks) -> _Measurements:
    """Several pieces of one track in one frame become one row, weighted by inverse variance.

    Pieces of one wall in one frame share the frame's yaw and depth errors: kept apart, a wall would count
    once per door and window in it.
    """
    used = np.flatnonzero(tracks.track_of_segment != NO_TRACK)
    frame, track = segments.frame[used].astype(np.int64), tracks.track_of_segment[used].astype(np.int64)
    count = len(tracks.axis)
    key, row = np.unique(frame * count + track, return_inverse=True)
    weight = segments.sigma_m[used] ** -2.0
    total = np.bincount(row, weight, len(key))
    distance = np.bincount(row, weight * segments.distance_m[used], len(key)) / total
    return _Measurements(key // max(count, 1), key % max(count, 1), distance, total**-0.5)
