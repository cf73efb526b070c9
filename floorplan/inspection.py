"""The facts about a scan that `info` prints, and what `build` would complain about."""

from dataclasses import dataclass

import numpy as np

from floorplan.config import IngestConfig
from floorplan.ingest import examine, keyframes_of
from floorplan.model.scan import Frame, Intrinsics, Problem, Recording
from floorplan.readers.base import Source
from floorplan.recording_checks import frame_gaps, motion_of
from floorplan.reporting import Progress, no_progress

SAMPLED_FRAMES = 25  # for the median range


@dataclass(frozen=True)
class Inspection:
    """One scan in numbers. `intrinsics` are those of the depth image, None for lasers; `filled_share` of pixels with a reading.

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
    problems: tuple[Problem, ...]
    usable: bool


@dataclass(frozen=True)
class _Ranges:
    median_m: float | None
    filled_share: float | None


def inspect_scan(source: Source, config: IngestConfig, progress: Progress = no_progress) -> Inspection:
    """Facts about an opened scan; fatal problems are listed, not raised."""
    recording = examine(source, config, progress)
    motion, sensor = motion_of(recording), recording.sensor
    gaps, ranges = frame_gaps(motion), _ranges(source)
    stamps_s = recording.stamp_ns * 1e-9
    return Inspection(
        format=recording.format,
        sensor=sensor.kind.value,
        width=sensor.width,
        height=sensor.height,
        frames=len(recording),
        keyframes=len(keyframes_of(recording, config)),
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
        problems=recording.problems,
        usable=not any(problem.fatal for problem in recording.problems),
    )


def _ranges(source: Source) -> _Ranges:
    """Median range and share of pixels with a reading, over a few frames."""
    rows = np.unique(np.linspace(0, len(source.recording) - 1, SAMPLED_FRAMES).astype(int))
    read = [np.linalg.norm(f.points, axis=-1) for f in source.frames(rows.tolist(), 1) if isinstance(f, Frame)]
    seen = [r[np.isfinite(r)] for r in read]
    medians = [float(np.median(r)) for r in seen if r.size]
    shares = [s.size / r.size for s, r in zip(seen, read, strict=True)]
    return _Ranges(float(np.median(medians)) if medians else None, float(np.mean(shares)) if shares else None)


def _wander_deg(recording: Recording) -> float | None:
    """Greatest angle between the vertical of a frame and the mean one, in the odometry's world."""
    up = -np.einsum("nij,nj->ni", recording.odom_from_sensor, recording.down_sensor)
    mean = up.mean(axis=0)
    if not np.isfinite(mean).all():
        return None
    sine = np.linalg.norm(np.cross(up, mean / np.linalg.norm(mean)), axis=1)  # exact near 0, unlike arccos
    return float(np.rad2deg(np.arcsin(np.clip(sine, 0.0, 1.0)).max()))
