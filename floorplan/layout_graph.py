"""From segments and tracks to the layout graph: odometry rows and measurements (METHOD.md, step 3)."""

from dataclasses import dataclass, replace

import numpy as np

from floorplan.model.checks import Array
from floorplan.model.graph import LayoutGraph
from floorplan.model.scan import NANOSECONDS_PER_SECOND, IngestedScan
from floorplan.model.segment import NO_TRACK, SegmentedScan, Segments, Tracks
from floorplan.range_accuracy import range_accuracy


def layout_graph(scan: IngestedScan, segmented: SegmentedScan, tracks: Tracks) -> LayoutGraph:
    """The graph of all keyframes and tracks; stamps are seconds since the first keyframe.

    Rows whose sign contradicts their facing are left out (see `with_signs_from_facing`, which counts them).
    """
    recording, keyframe = scan.recording, scan.keyframe
    stamp_ns = recording.stamp_ns[keyframe]
    rows = _one_row_per_frame_and_track(segmented.segments, tracks)
    graph = LayoutGraph(
        stamp_s=(stamp_ns - stamp_ns[:1]) / NANOSECONDS_PER_SECOND,
        translation_m=odometry_rows(
            recording.position_m[keyframe], recording.odom_from_sensor[keyframe], segmented.frames.world_from_sensor
        ),
        frame=rows.frame,
        track=rows.track,
        distance_m=rows.distance_m,
        axis=tracks.axis,
        facing=tracks.facing,
        extent_m=tracks.extent_m,
        sigma_m=rows.sigma_m,
        heading_sigma_rad=float(np.median(segmented.frames.yaw_sigma_rad)),
        range_accuracy=range_accuracy(recording.sensor),
    )
    return with_signs_from_facing(graph)[0]


def odometry_rows(position_odom_m: Array, odom_from_sensor: Array, world_from_sensor: Array) -> Array:
    """`t_i = R_i R_odo_i^T (o_{i+1} - o_i)` (N-1, 3): odometry's step turned into the axis-aligned world.

    Between keyframes the odometry's own poses carry the frames left out, so the keyframes' positions suffice.
    """
    world_from_odom = world_from_sensor[:-1] @ np.swapaxes(odom_from_sensor[:-1], 1, 2)
    return np.asarray(np.einsum("nij,nj->ni", world_from_odom, np.diff(position_odom_m, axis=0)))


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
