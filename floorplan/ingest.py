"""Stage `1-ingest`: checks the recording, finds the gravity of each frame, chooses the keyframes."""

from collections.abc import Iterable, Iterator
from dataclasses import dataclass, replace

import numpy as np

from floorplan.config import IngestConfig
from floorplan.errors import InputError, UsageError
from floorplan.gravity import estimate_gravity
from floorplan.keyframes import select_keyframes
from floorplan.model.checks import Array
from floorplan.model.scan import POSES_MISSING, Frame, GravitySource, IngestedScan, Problem, Recording, SensorKind, Trajectory
from floorplan.readers.base import BadFrame, Source
from floorplan.recording_checks import frozen_start, motion_problems
from floorplan.reporting import Steps, no_steps
from floorplan.rgbd_odometry import with_rgbd_odometry


def ingest(source: Source, config: IngestConfig, steps: Steps = no_steps) -> IngestedScan:
    """The recording with gravity known, problems counted, and the frames to look at.

    Raises `InputError` when the recording cannot be used: it names every fatal problem.
    """
    recording = examine(source, config, steps)
    stop_on_fatal(recording.problems)
    if not _is_to_be_refined(recording, config):
        return IngestedScan(recording, keyframes_of(recording, config))
    from floorplan.matched_recording import matched_recording  # a camera's build waits for none of it

    matched = matched_recording(source, recording, config.close_loops, steps)
    recorded = Trajectory(recording.stamp_ns, recording.position_m, recording.odom_from_sensor)
    keyframes = keyframes_of(matched.recording, config)
    return IngestedScan(matched.recording, keyframes, recorded, map_sigma_m=matched.map_sigma_m, wheels=matched.wheels)


def _is_to_be_refined(recording: Recording, config: IngestConfig) -> bool:
    """Whether sweeps are matched. Raises `UsageError` where that is asked of a sensor that gives no level sweeps."""
    level_laser = recording.sensor.kind is SensorKind.LASER and recording.gravity_source is GravitySource.LEVEL
    if config.odometry == "refine" and not level_laser:
        raise UsageError("ingest.odometry = refine matches level laser sweeps; this scan has none. Use auto or recorded.")
    return level_laser and config.odometry != "recorded"


def _stands_still(recording: Recording) -> bool:
    """Whether the recording has no trajectory, but colour to make one from."""
    return any(problem.code == POSES_MISSING and not problem.fatal for problem in recording.problems)


@dataclass(frozen=True)
class _Reposed:
    """A `Source` with another trajectory."""

    source: Source
    recording: Recording

    def frames(self, indices: Iterable[int], stride: int = 1) -> Iterator[Frame | BadFrame]:
        """See `Source.frames`."""
        return self.source.frames(indices, stride)


def examine(source: Source, config: IngestConfig, steps: Steps = no_steps) -> Recording:
    """The recording with every problem listed, fatal ones too, and its gravity where it can be had."""
    recording = source.recording
    if config.odometry == "rgbd" or (config.odometry == "auto" and _stands_still(recording)):
        recording = with_rgbd_odometry(source, recording, steps("odometry from images"))
        source = _Reposed(source, recording)
    found = motion_problems(recording) + too_many_unreadable(recording, config.max_unreadable_share)
    if recording.gravity_source is GravitySource.UNKNOWN:
        recording = estimate_gravity(source, keyframes_of(recording, config), steps("gravity"))
    if config.returns_to_start is not None:
        recording = replace(recording, returns_to_start=config.returns_to_start)
    return replace(recording, problems=recording.problems + found)


def keyframes_of(recording: Recording, config: IngestConfig) -> Array:
    """Rows (F,) of the frames that changed the view; sweeps cost little and are chosen more densely."""
    laser = recording.sensor.kind is SensorKind.LASER
    distance_m = config.laser_keyframe_distance_m if laser else config.keyframe_distance_m
    angle_deg = config.laser_keyframe_angle_deg if laser else config.keyframe_angle_deg
    first = frozen_start(recording)
    rows = slice(first, None)
    chosen = select_keyframes(
        recording.stamp_ns[rows],
        recording.position_m[rows],
        recording.odom_from_sensor[rows],
        distance_m,
        float(np.deg2rad(angle_deg)),
        config.keyframe_gap_s,
    )
    return chosen + first


def too_many_unreadable(recording: Recording, max_share: float) -> tuple[Problem, ...]:
    """A fatal problem when more than `max_share` of the images are damaged."""
    damaged = [p for p in recording.problems if p.code == "png-unreadable"]
    count = sum(p.count for p in damaged)
    if count <= max_share * (len(recording) + count):
        return ()
    message = f"{count} of {len(recording) + count} depth images are damaged"
    advice = "copy the recording again, or raise ingest.max_unreadable_share to use what is left"
    return (Problem("too-many-unreadable", message, damaged[0].where, count, advice, fatal=True),)


def stop_on_fatal(problems: tuple[Problem, ...]) -> None:
    """Raise `InputError` with every fatal problem, if there is one."""
    fatal = [p for p in problems if p.fatal]
    if fatal:
        raise InputError("\n".join(_sentence(p) for p in fatal))


def _sentence(problem: Problem) -> str:
    where = f" ({problem.where})" if problem.where else ""
    return f"{problem.code}: {problem.message}{where}; {problem.advice}"
