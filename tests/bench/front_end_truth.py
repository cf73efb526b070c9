"""How true the front end is on a simulated scan: yaw, roll and pitch, offsets with their standard deviations, purity of tracks.

The truth is the simulator's: poses of every frame and the planes of every surface. Every figure comes from it alone.
"""

import json
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from shapely import Polygon, contains_xy

from floorplan.config import TrackingConfig
from floorplan.geometry import rotation_from_quat_xyzw, wrap_to
from floorplan.model.checks import Array
from floorplan.model.scan import IngestedScan
from floorplan.model.segment import AXIS_Z, NO_TRACK, SegmentedScan
from floorplan.tracking import track

_LARGE_PX = 500  # of the full image: the segments the bars are about
_MATCH_M = 0.06  # a segment's plane is one of the truth's this near
_BIASED_M = 0.025  # 0.4 % of the range, and ripple
_ONE_PLANE_M = 1e-3  # two ceilings, built alike
_SAME_M = 5e-4  # offsets of one plane, as the truth rounds them
_BESIDE_M = 0.05  # beyond the end of a face
_NOT_FOUND = -1


@dataclass(frozen=True)
class FrontEndTruth:
    """Errors against the truth; angles in degrees RMS, offsets in metres RMS, `coverage_px` pixels on matched segments per keyframe."""

    yaw_deg: float
    tilt_deg: float
    quarter_turns: int
    offset_m: float
    chi_square: float
    matched_share: float
    purity: float
    tracks: int
    coverage_px: float


@dataclass(frozen=True)
class _TruePoses:
    position_m: Array
    world_from_sensor: Array


def against_truth(folder: Path, scan: IngestedScan, segmented: SegmentedScan) -> FrontEndTruth:
    """The front end's result on the simulated scan in `folder` against its `truth.json`."""
    truth = json.loads((folder / "truth.json").read_text("utf-8"))
    poses = _poses_of_keyframes(truth["trajectory"], scan)
    difference = segmented.frames.world_from_sensor @ np.swapaxes(poses.world_from_sensor, 1, 2)
    yaw = np.arctan2(difference[:, 1, 0], difference[:, 0, 0])
    quarter = np.round(np.median(np.unwrap(yaw)) / (np.pi / 2))
    turned = _turned(quarter * np.pi / 2) @ poses.world_from_sensor
    error = wrap_to(yaw - quarter * np.pi / 2, 2 * np.pi)
    wrong = np.abs(error) > np.pi / 4
    tilt = np.linalg.norm((segmented.frames.world_from_sensor @ np.swapaxes(turned, 1, 2))[:, 2, :2], axis=1) / np.sqrt(2)
    plane, off = _matched(truth, poses, segmented, int(quarter))
    large = (segmented.segments.pixels >= _LARGE_PX) & (plane != _NOT_FOUND)
    found = large & (np.abs(off) < _MATCH_M)
    tracks = track(scan, segmented, TrackingConfig())
    return FrontEndTruth(
        float(np.degrees(np.sqrt(np.mean(wrap_to(error, np.pi / 2) ** 2)))),
        float(np.degrees(np.sqrt(np.mean(tilt**2)))),
        int(wrong.sum()),
        float(np.sqrt(np.mean(off[found] ** 2))),
        float(np.mean((off[found] / np.hypot(segmented.segments.sigma_m, _lasting_m(scan, segmented))[found]) ** 2)),
        float(found.sum() / max((segmented.segments.pixels >= _LARGE_PX).sum(), 1)),
        _purity(tracks.track_of_segment, plane, segmented.segments.pixels),
        len(tracks.axis),
        float(segmented.segments.pixels[plane != _NOT_FOUND].sum() / len(scan.keyframe)),
    )


def _lasting_m(scan: IngestedScan, segmented: SegmentedScan) -> Array:
    """What a scale of the depth, as large as the recording says it may be, does to each distance (S,): no scan shows it to itself."""
    accuracy = scan.recording.sensor.accuracy
    return np.zeros(len(segmented.segments)) if accuracy is None else accuracy.scale_sigma * segmented.segments.distance_m


def _turned(angle: float) -> Array:
    c, s = np.cos(angle), np.sin(angle)
    return np.array(((c, -s, 0.0), (s, c, 0.0), (0.0, 0.0, 1.0)))


def _poses_of_keyframes(trajectory: dict[str, list[float]], scan: IngestedScan) -> _TruePoses:
    """The true pose of each keyframe, by the nearest stamp."""
    stamp = np.array(trajectory["stamp_ns"], dtype=np.int64)
    rows = np.array(trajectory["pose"], dtype=np.float64)
    wanted = scan.recording.stamp_ns[scan.keyframe]
    after = np.clip(np.searchsorted(stamp, wanted), 1, len(stamp) - 1)
    nearest = after - (wanted - stamp[after - 1] < stamp[after] - wanted)
    return _TruePoses(rows[nearest, :3], rotation_from_quat_xyzw(rows[nearest, 3:7]))


def _matched(truth: dict[str, list[dict[str, float]]], poses: _TruePoses, segmented: SegmentedScan, quarter: int) -> tuple[Array, Array]:
    """The true plane (S,) of each segment as the true pose places it, _NOT_FOUND beyond `_MATCH_M`; and how far off (S,).

    Planes that lie where the segment lies go before others by what a biased depth can do: ceilings of two rooms may differ by millimetres.
    """
    segments = segmented.segments
    planes = np.array([(p["axis"], p["facing"], p["offset"]) for p in truth["planes"]])
    same_as = _first_of_equal(planes)
    true_axis, sign = _in_truth_axes(segments.axis.astype(int), quarter)
    own = poses.position_m[segments.frame, true_axis] + sign * segments.distance_m
    facing = sign * segments.facing
    place = poses.position_m[segments.frame] + np.einsum("sij,sj->si", poses.world_from_sensor[segments.frame], segments.centroid_sensor_m)
    plane, off, least = np.full(len(own), _NOT_FOUND), np.full(len(own), np.inf), np.full(len(own), np.inf)
    for number, (axis, face, offset) in enumerate(planes):
        gap = own - offset
        near = (true_axis == axis) & (facing == face) & (np.abs(gap) < _MATCH_M)
        lies_here = np.zeros(len(own), dtype=bool)
        lies_here[near] = _carries(truth, int(axis), int(face), offset, place[near])
        away = np.abs(gap) + np.where(lies_here, 0.0, _BIASED_M)
        better = near & (away < least)
        plane[better], off[better], least[better] = same_as[number], gap[better], away[better]
    return plane, off


def _first_of_equal(planes: Array) -> Array:
    """The number (P,) of the first plane of each run of planes that nobody could tell apart; `planes` (P, 3) sorted."""
    axis, facing, offset = planes.T
    new = (np.diff(axis) != 0) | (np.diff(facing) != 0) | (np.diff(offset) > _ONE_PLANE_M)
    run = np.concatenate(([0], np.cumsum(new)))
    return np.searchsorted(run, run)


def _carries(truth: dict[str, Any], axis: int, facing: int, offset: float, place_m: Array) -> Array:
    """Whether a wall's face or a room's ceiling on that plane is where each point (N, 3) is; of furniture nothing is said."""
    found = np.zeros(len(place_m), dtype=bool)
    if axis == AXIS_Z:
        for space in truth["spaces"] if facing < 0 else ():
            if abs(space["ceiling_m"] - offset) < _SAME_M:
                room = Polygon(space["outline"], space["holes"]).buffer(_BESIDE_M)
                found |= contains_xy(room, place_m[:, 0], place_m[:, 1])
        return found
    along = place_m[:, 1 - axis]
    for face in truth["faces"]:
        if face["axis"] == axis and face["facing"] == facing and abs(face["offset"] - offset) < _SAME_M:
            found |= (along > face["start"] - _BESIDE_M) & (along < face["end"] + _BESIDE_M)
    return found


def _in_truth_axes(axis: Array, quarter: int) -> tuple[Array, Array]:
    """The truth's axis and the sign of each axis of a world turned by `quarter` quarter turns against the truth."""
    back = np.round(_turned(-quarter * np.pi / 2)).astype(int)
    column = back[:, axis]
    true_axis = np.abs(column).argmax(axis=0)
    return true_axis, column[true_axis, np.arange(len(axis))]


def _purity(track_of_segment: Array, plane: Array, pixels: Array) -> float:
    """Share of the pixels on tracks that belong to their track's commonest true plane."""
    known = (track_of_segment != NO_TRACK) & (plane != _NOT_FOUND)
    table = np.zeros((track_of_segment.max(initial=0) + 1, plane.max(initial=0) + 1))
    np.add.at(table, (track_of_segment[known], plane[known]), pixels[known])
    return float(table.max(axis=1).sum() / max(table.sum(), 1.0))
