"""Lines of a CARMEN log to arrays.

FLASER n r_1 .. r_n x y theta odom_x odom_y odom_theta time host logger_time
ROBOTLASER1 type start fov step max accuracy remission n r_1 .. r_n m remissions laser_x laser_y laser_theta
    robot_x robot_y robot_theta tv rv forward side axis time host logger_time
"""

from collections import Counter
from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np

from floorplan.errors import InputError
from floorplan.model.checks import Array
from floorplan.model.scan import Problem
from floorplan.readers.laser_checks import headings_in_radians, stands_still
from floorplan.readers.pose_table import stamp_ns_from_text

FLASER_TAIL = 9  # columns after the ranges
FLASER_POSE = 3  # odom_x is this many columns after the ranges; x, y, theta before it may be corrected poses
OTHER_LASERS = (b"RLASER", b"ROBOTLASER0", b"ROBOTLASER2", b"ROBOTLASER3", b"ROBOTLASER4", b"LASER3", b"LASER4", b"RAWLASER")
ROBOTLASER_HEAD = 9  # columns before the ranges
ROBOTLASER_TAIL = 14  # columns after the remissions
MAX_RANGE_PARAMETER = b"robot_front_laser_max"


@dataclass(frozen=True)
class Fan:
    """Directions of the beams: `count` of them from `start_rad`, counter-clockwise, each `step_rad` further."""

    count: int
    start_rad: float
    step_rad: float


@dataclass(frozen=True)
class Sweep:
    """One line: `pose_xy_yaw` of the sensor in the odometry's world, the `other_xy_yaw` that the line has beside it, ranges as logged."""

    fan: Fan
    range_m: Array
    pose_xy_yaw: tuple[float, ...]
    other_xy_yaw: tuple[float, ...]
    stamp_ns: int
    max_range_m: float = np.inf


@dataclass(frozen=True)
class Sweeps:
    """All sweeps of a log, N rows of B beams, in the log's order.

    `stamp_ns (N,)`; `pose_xy_yaw (N, 3)` metres and radians; `range_m (N, B) float32`; `angle_rad (B,)` from the
    sensor's x; `stated_max_range_m` what the log says, inf if nothing.
    """

    stamp_ns: Array
    pose_xy_yaw: Array
    range_m: Array
    angle_rad: Array
    stated_max_range_m: float
    problems: tuple[Problem, ...]


def parse_log(lines: Iterable[bytes], where: str) -> Sweeps:
    """The sweeps of a log. Raises `InputError` when there is none."""
    sweeps: list[Sweep] = []
    bad_lines: list[int] = []
    others: Counter[bytes] = Counter()
    stated_max = np.inf
    problems: tuple[Problem, ...] = ()
    try:
        for number, line in enumerate(lines, 1):
            if line.startswith((b"FLASER ", b"ROBOTLASER1 ")):
                try:
                    sweeps.append(_flaser(line.split()) if line.startswith(b"F") else _robotlaser(line.split()))
                except (ValueError, IndexError):
                    bad_lines.append(number)
            elif line.startswith(b"PARAM " + MAX_RANGE_PARAMETER):
                stated_max = _stated_max_m(line, stated_max)
            elif line.startswith(OTHER_LASERS):
                others[line.split(maxsplit=1)[0]] += 1
    except (EOFError, OSError) as error:
        problems = (Problem("file-damaged", f"the packed log ends early ({error})", where, advice="what could be unpacked is used"),)
    if not sweeps:
        raise InputError(f"{where}: no frames: no readable FLASER or ROBOTLASER1 line{_instead(bad_lines, others, problems)}")
    if bad_lines:
        advice = "these sweeps are left out"
        problems += (Problem("line-unreadable", "laser lines cut off or damaged", f"line {bad_lines[0]}", len(bad_lines), advice),)
    return _of_one_fan(sweeps, stated_max, problems, where)


def _stated_max_m(line: bytes, otherwise_m: float) -> float:
    cells = line.split()
    try:
        return float(cells[2])
    except (ValueError, IndexError):
        return otherwise_m


def _instead(bad_lines: list[int], others: Counter[bytes], problems: tuple[Problem, ...]) -> str:
    """What there is in place of sweeps, for the message."""
    if problems:
        return f"; {problems[0].message}: copy the log again"
    if bad_lines:
        damaged = f"{len(bad_lines)} are cut off or damaged, the first is line {bad_lines[0]}"
        return f"; {damaged}: numbers need a decimal point, and a line as many ranges as it says"
    if others:
        name, count = others.most_common(1)[0]
        return f"; {count} are {name.decode('ascii', errors='replace')}, of a scanner that does not look ahead: rename them if yours does"
    return ""


def _of_one_fan(sweeps: list[Sweep], stated_max_m: float, problems: tuple[Problem, ...], where: str) -> Sweeps:
    """The sweeps of the commonest fan: a grid has one width."""
    fan, _ = Counter(sweep.fan for sweep in sweeps).most_common(1)[0]
    same = [sweep for sweep in sweeps if sweep.fan == fan]
    if len(same) < len(sweeps):
        message = f"sweeps of another scanner than the commonest ({fan.count} beams)"
        problems += (Problem("sweep-other-scanner", message, count=len(sweeps) - len(same), advice="these sweeps are left out"),)
    beams = fan.start_rad + fan.step_rad * np.arange(fan.count)
    told = _poses(same, where)
    poses, problems = told.pose_xy_yaw, problems + told.problems
    # x ahead along the fan's middle: a fan from -90 degrees in n steps of 180/n has its middle at 0, half a step past the middle beam
    middle = fan.start_rad + 0.5 * fan.step_rad * fan.count
    middle = 0.0 if abs(middle) <= abs(fan.step_rad) else middle
    poses[:, 2] += middle
    return Sweeps(
        stamp_ns=np.array([sweep.stamp_ns for sweep in same], dtype=np.int64),
        pose_xy_yaw=poses,
        range_m=np.array([sweep.range_m for sweep in same]),
        angle_rad=beams - middle,
        stated_max_range_m=min(stated_max_m, max(sweep.max_range_m for sweep in same)),
        problems=problems,
    )


@dataclass(frozen=True)
class _Poses:
    """`pose_xy_yaw (N, 3)` and what was odd about them."""

    pose_xy_yaw: Array
    problems: tuple[Problem, ...]


def _poses(sweeps: list[Sweep], where: str) -> _Poses:
    """The odometry of the sweeps; the log's other poses where that never moves; headings in radians."""
    poses, other = np.array([sweep.pose_xy_yaw for sweep in sweeps]), np.array([sweep.other_xy_yaw for sweep in sweeps])
    problems: tuple[Problem, ...] = ()
    if stands_still(poses) and not stands_still(other):
        advice = "make sure that these are poses of this log's own sweeps"
        problems = (Problem("odometry-still", "the odometry never moves; the poses beside it were read instead", where, advice=advice),)
        poses = other
    headings = headings_in_radians(poses, where)
    return _Poses(np.column_stack((poses[:, :2], headings.yaw_rad)), problems + headings.problems)


def _flaser(cells: list[bytes]) -> Sweep:
    count = int(cells[1])
    tail = cells[2 + count :]
    if len(tail) != FLASER_TAIL:
        raise ValueError("number of columns")
    corrected, odometry = (tuple(float(cell) for cell in tail[at : at + 3]) for at in (0, FLASER_POSE))
    return Sweep(_flaser_fan(count), np.array(cells[2 : 2 + count], dtype=np.float32), odometry, corrected, _stamp(tail))


def _flaser_fan(count: int) -> Fan:
    """FLASER does not say its angles: 180 degrees from -90, the last beam at +90 only when the count is odd (181, 361, 401)."""
    return Fan(count, -np.pi / 2, np.pi / (count - 1 if count % 2 else count))


def _robotlaser(cells: list[bytes]) -> Sweep:
    count = int(cells[8])
    remissions = int(cells[ROBOTLASER_HEAD + count])
    tail = cells[ROBOTLASER_HEAD + count + 1 + remissions :]
    if len(tail) != ROBOTLASER_TAIL:
        raise ValueError("number of columns")
    laser, robot = (tuple(float(cell) for cell in tail[at : at + 3]) for at in (0, 3))
    ranges = np.array(cells[ROBOTLASER_HEAD : ROBOTLASER_HEAD + count], dtype=np.float32)
    fan = Fan(count, float(cells[2]), float(cells[4]))
    max_range_m = float(cells[5]) or np.inf
    return Sweep(fan, ranges, laser, robot, _stamp(tail), max_range_m)


def _stamp(tail: list[bytes]) -> int:
    return stamp_ns_from_text(tail[-3].decode("ascii", errors="replace"))
