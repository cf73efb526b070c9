"""Stage `1-ingest`: checks the recording, finds the gravity of each frame, chooses the keyframes."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np

from floorplan.config import IngestConfig
from floorplan.errors import InputError
from floorplan.keyframes import select_keyframes
from floorplan.model.checks import Array
from floorplan.model.scan import IngestedScan, Problem, Recording, SensorKind
from floorplan.readers.base import Source

Progress = Callable[[int, int], None]


def _silent(done: int, total: int) -> None:
    """No progress is shown."""


def ingest(source: Source, config: IngestConfig, progress: Progress = _silent) -> IngestedScan:
    """The recording with gravity known, problems counted, and the frames to look at.

    Raises `InputError` when the recording cannot be used: see the problems marked fatal.
    """
    recording = source.recording
    keyframe = keyframes_of(recording, config)
    recording = with_gravity(source, keyframe, progress)
    if config.returns_to_start is not None:
        recording = replace(recording, returns_to_start=config.returns_to_start)
    stop_on_fatal(recording.problems + too_many_unreadable(recording, config.max_unreadable_share))
    return IngestedScan(recording, keyframe)


def keyframes_of(recording: Recording, config: IngestConfig) -> Array:
    """Rows (F,) of the frames that changed the view; sweeps cost little and are chosen more densely."""
    laser = recording.sensor.kind is SensorKind.LASER
    distance_m = config.laser_keyframe_distance_m if laser else config.keyframe_distance_m
    angle_deg = config.laser_keyframe_angle_deg if laser else config.keyframe_angle_deg
    return select_keyframes(
        recording.stamp_ns, recording.position_m, recording.odom_from_sensor, distance_m, np.deg2rad(angle_deg), config.keyframe_gap_s
    )


def with_gravity(source: Source, keyframe: Array, progress: Progress) -> Recording:
    """The recording with `down_sensor` known for every frame."""
    return source.recording


def too_many_unreadable(recording: Recording, max_share: float) -> tuple[Problem, ...]:
    """A fatal problem when more than `max_share` of the images are damaged."""
    damaged = [p for p in recording.problems if p.code == "png-unreadable"]
    count = sum(p.count for p in damaged)
    if count <= max_share * (len(recording) + count):
        return ()
    message = f"{count} of {len(recording) + count} depth images are damaged"
    advice = "copy the recording again, or raise ingest.max_unreadable_share to use what is left"
    return (Problem("png-unreadable", message, damaged[0].where, count, advice, fatal=True),)


def stop_on_fatal(problems: tuple[Problem, ...]) -> None:
    """Raise `InputError` with every fatal problem, if there is one."""
    fatal = [p for p in problems if p.fatal]
    if fatal:
        raise InputError("\n".join(f"{p.code}: {p.message} ({p.where}); {p.advice}" for p in fatal))
