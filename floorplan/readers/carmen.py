"""CARMEN laser logs (.clf, .log, also .bz2 and .gz): FLASER and ROBOTLASER1 lines.

A sweep is a 1 x N grid at an assumed level: x ahead, y left, z up, origin where the beams start. Lengths are in metres,
angles in radians. The frame stamp is the message's own time, the first of the last three columns.
"""

from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from floorplan.config import ReadConfig
from floorplan.errors import InputError
from floorplan.geometry import quat_xyzw_from_rotation, rotation_about_z
from floorplan.model.checks import Array
from floorplan.model.scan import Frame, GravitySource, NoiseModel, Problem, Recording, Sensor, SensorKind
from floorplan.readers.base import BadFrame
from floorplan.readers.carmen_lines import Sweeps, parse_log
from floorplan.readers.laser_checks import range_unit_problems
from floorplan.readers.noise_models import LASER_SIGMA_M, LASER_SIGMA_PER_M
from floorplan.readers.packed_lines import packed_by, packed_lines
from floorplan.readers.pose_table import PoseTable
from floorplan.readers.row_checks import usable_rows

LOG_SUFFIXES = (".clf", ".log", ".carmen")
PACKED_SUFFIXES = (".bz2", ".gz")
SNIFFED_LINES = 200  # parameters and comments can stand before the first sweep
LOG_WORDS = (b"FLASER", b"ROBOTLASER", b"ODOM", b"PARAM", b"# CARMEN", b"# message_name", b"RLASER")
MIN_RANGE_M = 0.05
SHARE_OF_NO_RETURN = 1e-4  # the greatest reading is the code for "no return" when so many readings have it exactly ...
NO_RETURN_TO_NEIGHBOURS = 3.0  # ... and that is so many times what the last metre before it holds


@dataclass(frozen=True)
class CarmenReader:
    """See `Reader`."""

    name: str = "carmen"
    description: str = "CARMEN laser log of a robot"
    looks_for: str = "a CARMEN log (.clf, .log, also .bz2 or .gz) with FLASER or ROBOTLASER1 lines, or a folder with exactly one"

    def sniff(self, path: Path) -> bool:
        """True for a log whose first lines are CARMEN messages, and for a folder that holds such logs."""
        return bool(_logs(path))

    def open(self, path: Path, config: ReadConfig) -> "LaserLog":
        """The opened scan. Raises `InputError` without sweeps, or when a folder holds several logs."""
        logs = _logs(path) or ([path] if path.is_file() else [])
        if len(logs) != 1:
            names = ", ".join(log.name for log in logs) or "none"
            raise InputError(f"{path}: a folder must hold exactly one CARMEN log, found: {names}; name the log itself")
        return _open(logs[0], config.depth_scale)


@dataclass(frozen=True)
class LaserLog:
    """A `Source` of level sweeps. A packed log cannot be read at random places, so its ranges are kept: 4 bytes per beam.

    `range_m (N, B) float32`, NaN for no return; `angle_rad (B,)` counter-clockwise from the sensor's x.
    """

    recording: Recording
    range_m: Array
    angle_rad: Array

    def frames(self, indices: Iterable[int], stride: int = 1) -> Iterator[Frame | BadFrame]:
        """See `Source.frames`."""
        cosine = np.cos(self.angle_rad[::stride]).astype(np.float32)
        sine = np.sin(self.angle_rad[::stride]).astype(np.float32)
        for index in indices:
            distance = self.range_m[index, ::stride]
            points = np.stack([distance * cosine, distance * sine, distance * np.float32(0)], axis=-1)[None]
            yield Frame(int(index), int(self.recording.stamp_ns[index]), points)


def _logs(path: Path) -> list[Path]:
    """CARMEN logs at `path`: itself, or those directly inside the folder."""
    files = sorted(path.iterdir()) if path.is_dir() else [path]
    return [file for file in files if file.is_file() and _has_log_suffix(file) and _reads_like_log(file)]


def _has_log_suffix(file: Path) -> bool:
    suffixes = [suffix.lower() for suffix in file.suffixes]
    if suffixes and suffixes[-1] in PACKED_SUFFIXES:
        suffixes.pop()
    return bool(suffixes) and suffixes[-1] in LOG_SUFFIXES


def _reads_like_log(file: Path) -> bool:
    try:
        return any(line.startswith(LOG_WORDS) for line, _ in zip(packed_lines(file), range(SNIFFED_LINES), strict=False))
    except (OSError, EOFError):
        return _is_damaged(file)  # a packed log cut before its first lines; whatever else it is, sniffing must not fail


def _is_damaged(file: Path) -> bool:
    try:
        return packed_by(file) != ""
    except OSError:
        return False


def _open(file: Path, units_per_m: float) -> LaserLog:
    sweeps = parse_log(packed_lines(file), str(file))
    quat = quat_xyzw_from_rotation(rotation_about_z(sweeps.pose_xy_yaw[:, 2]))
    position = np.column_stack([sweeps.pose_xy_yaw[:, :2], np.zeros(len(quat))])
    usable = usable_rows(PoseTable(sweeps.stamp_ns, position, quat), file.name)
    if not len(usable.index):
        raise InputError(f"{file}: no sweep has a pose and a stamp")
    ranges = sweeps.range_m[usable.index] / np.float32(units_per_m or 1.0)
    limit = no_return_range_m(ranges, sweeps.stated_max_range_m)
    ranges[~((ranges > MIN_RANGE_M) & (ranges < limit))] = np.nan
    problems = sweeps.problems + usable.problems + range_unit_problems(ranges, file.name)
    return LaserLog(
        recording=_recording(sweeps, usable.index, position, _sensor(sweeps, ranges, limit), problems),
        range_m=ranges,
        angle_rad=sweeps.angle_rad,
    )


def no_return_range_m(ranges: Array, stated_max_m: float) -> float:
    """Readings of at least this length mean that nothing came back; `stated_max_m` is what the log says, inf if nothing.

    A log that says nothing gives itself away: one exact greatest value that occurs far too often.
    """
    finite = ranges[np.isfinite(ranges)]
    if not finite.size:
        return stated_max_m
    greatest = float(finite.max())
    at_greatest = int((finite == finite.max()).sum())
    just_below = int(((finite < greatest) & (finite >= greatest - 1.0)).sum())
    is_code = at_greatest > SHARE_OF_NO_RETURN * finite.size and at_greatest > NO_RETURN_TO_NEIGHBOURS * just_below
    return min(stated_max_m, greatest if is_code else np.inf)


def _sensor(sweeps: Sweeps, ranges: Array, limit_m: float) -> Sensor:
    """The scanner, with the rounding of its ranges in this log as part of the noise."""
    step = _rounding_step_m(ranges)
    noise = NoiseModel(constant_m=float(np.hypot(LASER_SIGMA_M, step / np.sqrt(12))), linear=LASER_SIGMA_PER_M)
    seen = ranges[np.isfinite(ranges)]
    farthest = float(seen.max()) if seen.size else MIN_RANGE_M
    ray_step = float(np.median(np.diff(sweeps.angle_rad))) if len(sweeps.angle_rad) > 1 else np.pi / 180
    return Sensor(SensorKind.LASER, 1, ranges.shape[1], noise, MIN_RANGE_M, min(limit_m, farthest), ray_step)


def _rounding_step_m(ranges: Array) -> float:
    """The usual distance between neighbouring values that occur: 0.05 where a log keeps every fifth centimetre."""
    values, counts = np.unique(np.round(ranges[np.isfinite(ranges)], 3), return_counts=True)
    if len(values) < 2:
        return 0.0
    steps = np.diff(values)
    order = np.argsort(steps)
    below = np.cumsum(counts[:-1][order])  # weighted median: by readings, so that rare odd values count little
    return float(steps[order][np.searchsorted(below, below[-1] / 2)])


def _recording(sweeps: Sweeps, rows: Array, position_m: Array, sensor: Sensor, problems: tuple[Problem, ...]) -> Recording:
    return Recording(
        format="carmen",
        sensor=sensor,
        stamp_ns=sweeps.stamp_ns[rows],
        position_m=position_m[rows],
        odom_from_sensor=rotation_about_z(sweeps.pose_xy_yaw[rows, 2]),
        down_sensor=np.tile([0.0, 0.0, -1.0], (len(rows), 1)),
        gravity_source=GravitySource.LEVEL,
        problems=problems,
    )
