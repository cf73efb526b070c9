"""What is odd about a recording's stamps and poses, whatever its format: gaps, jumps, frozen odometry, wrong units."""

from dataclasses import dataclass, replace

import numpy as np

from floorplan.model.checks import Array
from floorplan.model.scan import Problem, Recording, SensorKind

MIN_GAP_S = 1.0  # a shorter one loses little view at walking speed
GAP_IN_STEPS = 5.0  # ... unless frames usually come that rarely
MAX_SPEED_M_S = 5.0  # a running person, a fast robot
MAX_TURN_RAD_S = np.deg2rad(720.0)
JUMP_SLACK_M = 0.10  # noise of a pose, so that close stamps make no jump
JUMP_SLACK_RAD = np.deg2rad(5.0)
UNIT_SPEED_M_S = 20.0  # a recording that moves faster in the median is in other units
FROZEN_S = 0.2  # shorter repeats are two stamps of one pose


@dataclass(frozen=True)
class Motion:
    """Steps between the N frames: `seconds (N-1,)`, `moved_m (N-1,)`, `turned_rad (N-1,)`."""

    seconds: Array
    moved_m: Array
    turned_rad: Array


def motion_of(recording: Recording) -> Motion:
    """Time, way and turn from each frame to the next."""
    rotation = recording.odom_from_sensor
    trace = np.einsum("nij,nij->n", rotation[1:], rotation[:-1])
    return Motion(
        seconds=np.diff(recording.stamp_ns) * 1e-9,
        moved_m=np.linalg.norm(np.diff(recording.position_m, axis=0), axis=1),
        turned_rad=np.arccos(np.clip((trace - 1) / 2, -1.0, 1.0)),
    )


def frame_gaps(motion: Motion) -> Array:
    """Boolean (N-1,): so long between two frames that much was missed."""
    usual = float(np.median(motion.seconds)) if len(motion.seconds) else 0.0
    return np.asarray(motion.seconds > max(MIN_GAP_S, GAP_IN_STEPS * usual))


def motion_problems(recording: Recording) -> tuple[Problem, ...]:
    """Gaps, jumps, wrong units and frozen odometry of a recording."""
    motion = motion_of(recording)
    too_fast = motion.moved_m > JUMP_SLACK_M + MAX_SPEED_M_S * motion.seconds
    spun = motion.turned_rad > JUMP_SLACK_RAD + MAX_TURN_RAD_S * motion.seconds
    longest = float(motion.seconds.max(initial=0.0))
    widest = float(motion.moved_m[too_fast | spun].max(initial=0.0))
    gap = Problem("frame-gap", f"gaps between frames, the longest {longest:.1f} s", advice="what was passed meanwhile is not drawn")
    jump = Problem("pose-jump", f"the odometry jumps, by up to {widest:.2f} m", advice="the plan may be off beyond that place")
    found = (
        _unit_problem(motion),
        _at(recording, frame_gaps(motion), gap),
        _at(recording, too_fast | spun, jump),
        _frozen_problem(recording, motion),
    )
    return tuple(problem for problem in found if problem)


def frozen_start(recording: Recording) -> int:
    """Row of the first frame worth using: the last of those whose pose repeats the first one exactly.

    Visual odometry never repeats a pose to the last digit: it had not started. Wheels do, when they stand.
    """
    if recording.sensor.kind is SensorKind.LASER:
        return 0
    moving = ~_repeated(motion_of(recording))
    return int(np.argmax(moving)) if moving.any() else 0


def _repeated(motion: Motion) -> Array:
    return np.asarray((motion.moved_m == 0.0) & (motion.turned_rad < 1e-6))  # arccos leaves rounding near 0


def _frozen_problem(recording: Recording, motion: Motion) -> Problem | None:
    """Runs of exactly equal poses from a camera's odometry."""
    if recording.sensor.kind is SensorKind.LASER:
        return None
    edges = np.diff(np.concatenate([[0], _repeated(motion).astype(int), [0]]))
    starts, ends = np.flatnonzero(edges == 1), np.flatnonzero(edges == -1)
    long = (recording.stamp_ns[ends] - recording.stamp_ns[starts]) * 1e-9 >= FROZEN_S
    if not long.any():
        return None
    frames = int((ends - starts)[long].sum())
    where = f"{recording.stamp_ns[starts[long][0]] * 1e-9:.6f} s"
    advice = "tracking was off or had not started there"
    return Problem("pose-frozen", "frames whose pose repeats the one before exactly", where, frames, advice)


def _unit_problem(motion: Motion) -> Problem | None:
    moving = motion.moved_m > 0
    if not moving.any():
        return None
    speed = float(np.median(motion.moved_m[moving] / np.maximum(motion.seconds[moving], 1e-9)))
    if speed < UNIT_SPEED_M_S:
        return None
    message = f"the odometry moves at {speed:.0f} m/s: its positions are not metres, or its stamps not seconds"
    return Problem("pose-unit", message, advice="convert positions to metres and stamps to seconds", fatal=True)


def _at(recording: Recording, affected: Array, problem: Problem) -> Problem | None:
    """The problem with its first place and its count, None when no step (N-1,) is affected."""
    if not affected.any():
        return None
    where = f"{recording.stamp_ns[int(np.argmax(affected))] * 1e-9:.3f} s"
    return replace(problem, where=where, count=int(affected.sum()))
