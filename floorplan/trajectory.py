"""Trajectories of EVERY frame of the recording, from poses that were solved for the keyframes alone.

Between two keyframes the odometry's own steps are carried by the corrected frame, and what they miss the second
keyframe by (in rotation and in position) is spread over the path between them.
"""

from dataclasses import dataclass

import numpy as np

from floorplan.geometry import rotation_about_z, rotation_from_vector, vector_from_rotation
from floorplan.model.checks import Array
from floorplan.model.scan import NANOSECONDS_PER_SECOND, IngestedScan, Recording, Trajectory

STANDING_RATE_M_PER_S = 1e-3  # path a standing sensor is taken to walk, so that a path of no length can be divided too


@dataclass(frozen=True)
class PlanFrame:
    """How the axis-aligned world lies in the plan frame: quarter turns counter-clockwise, then `shift_m (3,)`."""

    rotation_quarters: int
    shift_m: Array


@dataclass(frozen=True)
class _Spans:
    """For every frame the keyframe before it, the one after it, and how far between them it lies (0 to 1)."""

    before: Array
    after: Array
    fraction: Array


def keyframe_trajectory(scan: IngestedScan, world_from_sensor: Array, position_m: Array) -> Trajectory:
    """The keyframes' poses (F) as a trajectory with the recording's stamps."""
    return Trajectory(scan.recording.stamp_ns[scan.keyframe], position_m, world_from_sensor)


def every_frame(scan: IngestedScan, keyframes: Trajectory) -> Trajectory:
    """Poses of all N frames of the recording from those of its F keyframes; frames outside them follow the odometry."""
    recording, spans = scan.recording, _spans(scan)
    odom_position, odom_from_sensor = recording.position_m, recording.odom_from_sensor
    world_from_odom = keyframes.world_from_sensor @ np.swapaxes(odom_from_sensor[scan.keyframe], -1, -2)
    turn = world_from_odom[spans.after] @ np.swapaxes(world_from_odom[spans.before], -1, -2)
    part_turn = rotation_from_vector(spans.fraction[:, None] * vector_from_rotation(turn))
    step = odom_position - odom_position[scan.keyframe[spans.before]]
    whole_step = odom_position[scan.keyframe[spans.after]] - odom_position[scan.keyframe[spans.before]]
    start, end = keyframes.position_m[spans.before], keyframes.position_m[spans.after]
    closing_error = end - start - _turned(world_from_odom[spans.before], whole_step)
    position = start + _turned(world_from_odom[spans.before], step) + spans.fraction[:, None] * closing_error
    rotation = part_turn @ world_from_odom[spans.before] @ odom_from_sensor
    return Trajectory(recording.stamp_ns, position, rotation)


def odometry_trajectory(scan: IngestedScan, first_world_from_sensor: Array) -> Trajectory:
    """The odometry as recorded, turned and shifted as a whole so that the first keyframe stands at the origin in its solved rotation."""
    recording, first = scan.recording, scan.keyframe[0]
    raw = scan.recorded_odometry or Trajectory(recording.stamp_ns, recording.position_m, recording.odom_from_sensor)
    world_from_odom = first_world_from_sensor @ raw.world_from_sensor[first].T
    position = (raw.position_m - raw.position_m[first]) @ world_from_odom.T
    return Trajectory(recording.stamp_ns, position, world_from_odom @ raw.world_from_sensor)


def in_plan_frame(trajectory: Trajectory, frame: PlanFrame) -> Trajectory:
    """The same poses in the plan frame."""
    turn = np.rint(rotation_about_z(np.asarray(frame.rotation_quarters * np.pi / 2)))
    position = trajectory.position_m @ turn.T + frame.shift_m
    return Trajectory(trajectory.stamp_ns, position, turn @ trajectory.world_from_sensor)


def path_length_m(position_m: Array) -> float:
    """Length of the polyline through `position_m (N, 3)`."""
    return float(np.linalg.norm(np.diff(position_m, axis=0), axis=1).sum())


def _spans(scan: IngestedScan) -> _Spans:
    frame = np.arange(len(scan.recording))
    rows, keyframes = _of_scan(scan)
    before = np.clip(np.searchsorted(scan.keyframe, frame, side="right") - 1, keyframes[:-1][rows], keyframes[1:][rows] - 1)
    after = np.where(frame > scan.keyframe[before], np.minimum(before + 1, keyframes[1:][rows] - 1), before)
    path = _path(scan.recording)
    walked, whole = path - path[scan.keyframe[before]], path[scan.keyframe[after]] - path[scan.keyframe[before]]
    return _Spans(before, after, np.divide(walked, whole, out=np.zeros(len(frame)), where=whole > 0))


def _of_scan(scan: IngestedScan) -> tuple[Array, Array]:
    """Which of the joined scans each frame (N,) belongs to, and the first keyframe of each (B,), with their number at the end."""
    first_row = [part.first_row for part in scan.linked]
    first_keyframe = [0, *(part.first_keyframe for part in scan.linked), len(scan.keyframe)]
    return np.searchsorted(first_row, np.arange(len(scan.recording)), side="right"), np.array(first_keyframe)


def _path(recording: Recording) -> Array:
    """Path walked up to each frame (N,), m; strictly increasing because a standing sensor counts a little too."""
    steps = np.linalg.norm(np.diff(recording.position_m, axis=0), axis=1)
    seconds = np.diff(recording.stamp_ns) / NANOSECONDS_PER_SECOND
    return np.concatenate(([0.0], np.cumsum(steps + STANDING_RATE_M_PER_S * seconds)))


def _turned(rotation: Array, vector: Array) -> Array:
    return np.asarray(np.einsum("nij,nj->ni", rotation, vector))
