"""Segments of consecutive keyframes to initial layout planes: temporal tracking only.

A track lives in dead-reckoned coordinates and follows its plane from one sighting to the next. A segment joins the nearest
live track of its axis and facing within the gate whose recent box it touches; otherwise it starts a new one. Nothing
is ever joined again after a real break: that is the merge's decision.
"""

import math
from dataclasses import dataclass, field

import numpy as np

from floorplan.config import TrackingConfig
from floorplan.model.checks import Array
from floorplan.model.scan import IngestedScan
from floorplan.model.segment import NO_TRACK, SegmentedScan, Segments, Tracks
from floorplan.odometry_steps import keyframe_steps

_MEMORY = 0.7  # weight of the past in a track's running offset: about three sightings
_GATE_SIGMAS = 3.0
_APART_M, _APART_SIGMAS = 0.012, 2.0  # two pieces of one view further apart than this are two planes
_NEVER = -1  # frame of a track not seen yet


@dataclass
class _Live:
    """A track while it is followed."""

    number: int
    axis: int
    facing: int
    offset_m: float
    box_m: Array
    last_frame: int
    last_walked_m: float
    last_stamp_s: float
    seen_at_m: float = 0.0  # where the last keyframe's largest piece of it was
    seen_sigma_m: float = 0.0


@dataclass
class _Found:
    """What the walk through the frames collects."""

    track_of_segment: Array
    live: list[_Live] = field(default_factory=list)
    axis: list[int] = field(default_factory=list)
    facing: list[int] = field(default_factory=list)


@dataclass(frozen=True)
class _Sighting:
    """A segment in dead-reckoned coordinates, with the gate its own noise allows."""

    axis: int
    facing: int
    offset_m: float
    sigma_m: float
    box_m: Array
    gate_m: float
    frame: int


@dataclass(frozen=True)
class _Moment:
    """One keyframe: where it is in dead-reckoned coordinates, when, and how far was walked until then."""

    frame: int
    position_m: Array
    stamp_s: float
    walked_m: float


def dead_reckoning(scan: IngestedScan, world_from_sensor: Array) -> Array:
    """Positions (F, 3) of the keyframes from their steps in the axis-aligned world, the first at the origin."""
    return np.concatenate((np.zeros((1, 3)), np.cumsum(keyframe_steps(scan, world_from_sensor), axis=0)))


def track(scan: IngestedScan, segmented: SegmentedScan, config: TrackingConfig) -> Tracks:
    """Initial layout planes of the whole scan."""
    segments = segmented.segments
    position = dead_reckoning(scan, segmented.frames.world_from_sensor)
    stamp = scan.recording.stamp_ns[scan.keyframe] * 1e-9
    walked = np.concatenate(([0.0], np.cumsum(np.linalg.norm(np.diff(position, axis=0), axis=1))))
    found = _Found(np.full(len(segments), NO_TRACK, np.int32))
    start = np.searchsorted(segments.frame, np.arange(len(position) + 1))
    begins = {part.first_keyframe for part in scan.linked}
    for k in range(len(position)):
        if k in begins:  # of another scan: what is the same there is the merge's decision
            found.live = []
        moment = _Moment(k, position[k], float(stamp[k]), float(walked[k]))
        _follow(found, segments, range(start[k], start[k + 1]), moment, config)
    return _tracks(found, segments, position, config)


def _follow(found: _Found, segments: Segments, rows: range, moment: _Moment, config: TrackingConfig) -> None:
    """Give every segment of one keyframe its track, the surest matches first."""
    found.live = [t for t in found.live if _alive(t, moment, config)]
    boxes = {s: segments.extent_m[s] + moment.position_m[:, None] for s in rows}
    by_support = sorted(rows, key=lambda s: -int(segments.pixels[s]))
    for s in by_support:
        offset = float(segments.distance_m[s] + moment.position_m[segments.axis[s]])
        gate_m = min(config.gate_m, config.tight_gate_m + _GATE_SIGMAS * float(segments.sigma_m[s]))
        sigma_m = float(segments.sigma_m[s])
        seen = _Sighting(int(segments.axis[s]), int(segments.facing[s]), offset, sigma_m, boxes[s], gate_m, moment.frame)
        match = _nearest(found.live, seen, config) or _new_track(found, seen)
        _see(match, seen, moment)
        found.track_of_segment[s] = match.number


def _new_track(found: _Found, seen: _Sighting) -> _Live:
    match = _Live(len(found.axis), seen.axis, seen.facing, seen.offset_m, seen.box_m, _NEVER, 0.0, 0.0)
    found.axis.append(match.axis)
    found.facing.append(match.facing)
    found.live.append(match)
    return match


def _alive(live: _Live, moment: _Moment, config: TrackingConfig) -> bool:
    """A track is lost once it was out of sight for too many keyframes, too long AND too far a walk."""
    if moment.frame - live.last_frame <= config.missed_frames:
        return True
    return moment.walked_m - live.last_walked_m <= config.missed_walk_m and moment.stamp_s - live.last_stamp_s <= config.missed_s


def _nearest(live: list[_Live], seen: _Sighting, config: TrackingConfig) -> _Live | None:
    """The one live track the segment belongs to; None where there is none."""
    near = [
        (abs(t.offset_m - seen.offset_m), t.number, t)
        for t in live
        if t.axis == seen.axis
        and t.facing == seen.facing
        and abs(t.offset_m - seen.offset_m) < seen.gate_m
        and _gap_m(t.box_m, seen.box_m, seen.axis) < config.gap_m
        and not _seen_apart(t, seen)
    ]
    if not near:
        return None
    near.sort(key=lambda n: n[:2])
    return near[0][2]


def _seen_apart(live: _Live, seen: _Sighting) -> bool:
    """Whether this very keyframe shows the track's plane elsewhere: errors of one view are common to both, so the difference is sure."""
    if live.last_frame != seen.frame:
        return False
    noise_m = _APART_SIGMAS * math.hypot(live.seen_sigma_m, seen.sigma_m)
    return abs(live.seen_at_m - seen.offset_m) > _APART_M + noise_m


def _gap_m(first: Array, second: Array, axis: int) -> float:
    """The larger of the gaps (0 where they overlap) between two boxes along the plane."""
    gaps = np.maximum(first[:, 0] - second[:, 1], second[:, 0] - first[:, 1])
    return float(max(np.delete(gaps, axis).max(), 0.0))


def _see(live: _Live, seen: _Sighting, moment: _Moment) -> None:
    fresh = live.last_frame != moment.frame
    live.offset_m = _MEMORY * live.offset_m + (1 - _MEMORY) * seen.offset_m
    # The box is what was seen last, widened while several pieces of one frame belong to the track.
    live.box_m = seen.box_m if fresh else _union(live.box_m, seen.box_m)
    if fresh:
        live.seen_at_m, live.seen_sigma_m = seen.offset_m, seen.sigma_m
    live.last_frame, live.last_walked_m, live.last_stamp_s = moment.frame, moment.walked_m, moment.stamp_s


def _union(first: Array, second: Array) -> Array:
    return np.stack((np.minimum(first[:, 0], second[:, 0]), np.maximum(first[:, 1], second[:, 1])), axis=1)


def _tracks(found: _Found, segments: Segments, position: Array, config: TrackingConfig) -> Tracks:
    """Renumbered tracks, less those that were seen once and hardly, with the union of their boxes."""
    count = len(found.axis)
    number = found.track_of_segment
    sightings = np.bincount(number, minlength=count)
    largest = np.zeros(count)
    np.maximum.at(largest, number, segments.area_m2)
    keep = (sightings > 1) | (largest >= config.min_single_area_m2)
    renumber = np.where(keep, np.cumsum(keep) - 1, NO_TRACK)
    track_of_segment = renumber[number] if count else number
    box = segments.extent_m + position[segments.frame][:, :, None]
    extent = np.stack((np.full((count, 3), np.inf), np.full((count, 3), -np.inf)), axis=2)
    np.minimum.at(extent[:, :, 0], number, box[:, :, 0])
    np.maximum.at(extent[:, :, 1], number, box[:, :, 1])
    return Tracks(track_of_segment, np.array(found.axis, dtype=np.int8)[keep], np.array(found.facing, dtype=np.int8)[keep], extent[keep])
