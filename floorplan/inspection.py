"""The facts about a scan that `info` prints, and what `build` would complain about."""

import time
from dataclasses import dataclass

import numpy as np

from floorplan.config import IngestConfig
from floorplan.ingest import examine, keyframes_of
from floorplan.model.advice import Advice
from floorplan.model.scan import Frame, Intrinsics, Problem, Recording, SensorKind
from floorplan.readers.base import Source
from floorplan.recording_advice import recording_advice, walking_speed_m_s
from floorplan.recording_checks import Motion, frame_gaps, motion_of
from floorplan.reporting import Steps, no_steps

SAMPLED_FRAMES = 25  # for the median range
START_S = 4.0  # libraries loaded, plan and drawings, whatever the length
READS_PER_KEYFRAME = 5.0  # a keyframe's whole work in times its reading: measured 4.5 to 6 on PNG images of 256 to 640 columns
SWEEP_S = 0.005  # a sweep's whole work: its reading is nothing beside the matching


@dataclass(frozen=True)
class Inspection:
    """One scan in numbers. `intrinsics` are those of the depth image, None for lasers; `filled_share` of pixels with a reading.

    `speed_m_s`, `turn_deg_s`: what 95 % of the walking, and of the steps, stay under. `build_s`: what a build will take, about, on one
    core, reckoned as `build_basis` says.
    `gravity_wander_deg`: how far the vertical moves in the odometry's world, 0 for a world that is level throughout.
    """

    format: str
    sensor: str
    width: int
    height: int
    frames: int
    keyframes: int
    first_stamp_s: float
    last_stamp_s: float
    duration_s: float
    rate_hz: float
    gaps: int
    longest_gap_s: float
    path_length_m: float
    intrinsics: Intrinsics | None
    median_range_m: float | None
    filled_share: float | None
    gravity_source: str
    gravity_wander_deg: float | None
    speed_m_s: float
    turn_deg_s: float
    build_s: float
    build_basis: str
    advice: tuple[Advice, ...]
    problems: tuple[Problem, ...]
    usable: bool


@dataclass(frozen=True)
class _Ranges:
    median_m: float | None
    filled_share: float | None
    read_s: float  # a frame, in the median


def inspect_scan(source: Source, config: IngestConfig, steps: Steps = no_steps) -> Inspection:
    """Facts about an opened scan; fatal problems are listed, not raised."""
    recording = examine(source, config, steps)
    motion, sensor = motion_of(recording), recording.sensor
    gaps, ranges = frame_gaps(motion), _ranges(source)
    stamps_s, keyframes = recording.stamp_ns * 1e-9, len(keyframes_of(recording, config))
    build_s, basis = _build_time(recording, keyframes, ranges.read_s)
    return Inspection(
        format=recording.format,
        sensor=sensor.kind.value,
        width=sensor.width,
        height=sensor.height,
        frames=len(recording),
        keyframes=keyframes,
        first_stamp_s=float(stamps_s[0]),
        last_stamp_s=float(stamps_s[-1]),
        duration_s=float(motion.seconds.sum()),
        rate_hz=float(1.0 / np.median(motion.seconds)) if len(motion.seconds) else 0.0,
        gaps=int(gaps.sum()),
        longest_gap_s=float(motion.seconds[gaps].max(initial=0.0)),
        path_length_m=float(motion.moved_m.sum()),
        intrinsics=sensor.intrinsics,
        median_range_m=ranges.median_m,
        filled_share=ranges.filled_share,
        gravity_source=recording.gravity_source.value,
        gravity_wander_deg=_wander_deg(recording),
        speed_m_s=walking_speed_m_s(motion),
        turn_deg_s=_turn_deg_s(motion),
        build_s=build_s,
        build_basis=basis,
        advice=recording_advice(recording, ranges.filled_share),
        problems=recording.problems,
        usable=not any(problem.fatal for problem in recording.problems),
    )


def _ranges(source: Source) -> _Ranges:
    """Median range and share of pixels with a reading, over a few frames."""
    rows = np.unique(np.linspace(0, len(source.recording) - 1, SAMPLED_FRAMES).astype(int))
    read, seconds, begin = [], [], time.perf_counter()
    for frame in source.frames(rows.tolist(), 1):
        seconds.append(time.perf_counter() - begin)
        if isinstance(frame, Frame):
            read.append(np.linalg.norm(frame.points, axis=-1))
        begin = time.perf_counter()
    seen = [r[np.isfinite(r)] for r in read]
    medians = [float(np.median(r)) for r in seen if r.size]
    shares = [s.size / r.size for s, r in zip(seen, read, strict=True)]
    median = float(np.median(medians)) if medians else None
    return _Ranges(median, float(np.mean(shares)) if shares else None, float(np.median(seconds)))


def _build_time(recording: Recording, keyframes: int, read_s: float) -> tuple[float, str]:
    """Seconds on one core, and what they are reckoned from."""
    if recording.sensor.kind is SensorKind.LASER:
        return START_S + SWEEP_S * len(recording), f"{1000 * SWEEP_S:g} ms a sweep on the machine of docs/benchmarks.md"
    per_frame = READS_PER_KEYFRAME * read_s
    return START_S + per_frame * keyframes, f"{1000 * per_frame:.0f} ms a keyframe, from reading {SAMPLED_FRAMES} frames just now"


def _turn_deg_s(motion: Motion) -> float:
    """The turn rate that 95 % of the steps stay under."""
    steps = motion.seconds > 0
    return float(np.rad2deg(np.quantile(motion.turned_rad[steps] / motion.seconds[steps], 0.95))) if steps.any() else 0.0


def _wander_deg(recording: Recording) -> float | None:
    """Greatest angle between the vertical of a frame and the mean one, in the odometry's world."""
    up = -np.einsum("nij,nj->ni", recording.odom_from_sensor, recording.down_sensor)
    mean = up.mean(axis=0)
    if not np.isfinite(mean).all():
        return None
    sine = np.linalg.norm(np.cross(up, mean / np.linalg.norm(mean)), axis=1)  # exact near 0, unlike arccos
    return float(np.rad2deg(np.arcsin(np.clip(sine, 0.0, 1.0)).max()))
