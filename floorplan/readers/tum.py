"""TUM RGB-D folders: depth.txt, 16-bit PNGs, a trajectory, and (not in the original sets) intrinsics.json.

Poses are camera-to-world with OpenCV camera axes; nothing in the folder says which way is up.
"""

import json
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np

from floorplan.config import ReadConfig
from floorplan.errors import InputError
from floorplan.model.checks import Array
from floorplan.model.scan import POSES_MISSING, GravitySource, Intrinsics, Problem, RangeAccuracy, Recording
from floorplan.readers.depth_files import DepthFiles, look_at_depth_files
from floorplan.readers.depth_images import DepthImages, scaled_intrinsics
from floorplan.readers.depth_unit import depth_unit_problems
from floorplan.readers.noise_models import depth_camera
from floorplan.readers.pose_table import (
    Interpolated,
    PoseTable,
    interpolate,
    read_tum_trajectory,
    stamp_ns_from_text,
    text_lines,
)
from floorplan.readers.row_checks import span_text, stamp_text, usable_rows
from floorplan.readers.simulated import returns_to_start
from floorplan.readers.world_up import down_in_sensor, named_axis

TRAJECTORY_FILES = ("odometry.txt", "groundtruth.txt")  # in this order
UNITS_PER_METRE = 5000.0  # of the original sets
MAX_POSE_GAP_S = 0.5  # a hand-held camera can turn by tens of degrees in longer gaps: nothing to interpolate


@dataclass(frozen=True)
class TumReader:
    """See `Reader`."""

    name: str = "tum"
    description: str = "TUM RGB-D folder"
    looks_for: str = "a folder with depth.txt"

    def sniff(self, path: Path) -> bool:
        """True for a folder with depth.txt."""
        return (path / "depth.txt").is_file()

    def open(self, path: Path, config: ReadConfig) -> DepthImages:
        """The opened scan. Raises `InputError` without frames, poses or intrinsics."""
        return _open(path, config)


@dataclass(frozen=True)
class _DepthList:
    stamp_ns: Array  # (N,) sorted, each once
    paths: tuple[Path, ...]
    problems: tuple[Problem, ...]


@dataclass(frozen=True)
class _Lens:
    """Intrinsics, of an image that may have another size than the depth, and depth units per metre."""

    intrinsics: Intrinsics
    units_per_metre: float
    accuracy: RangeAccuracy | None = None


def _open(path: Path, config: ReadConfig) -> DepthImages:
    listed = _depth_list(path)
    files = look_at_depth_files(listed.paths, path / "depth")
    lens = _lens(path, files, config)
    without_poses = not any((path / name).is_file() for name in TRAJECTORY_FILES)
    trajectory, trajectory_problems = _still(path, listed) if without_poses else _trajectory(path)
    poses = interpolate(trajectory, listed.stamp_ns, MAX_POSE_GAP_S)
    rows = np.flatnonzero(files.whole & poses.known)
    if not len(rows):
        spans = f"depth spans {span_text(listed.stamp_ns)}, the poses {span_text(trajectory.stamp_ns)}"
        raise InputError(f"{path}: no depth image has a pose: {spans}; both need the same clock")
    paths = tuple(listed.paths[row] for row in rows)
    unit = depth_unit_problems(paths, 1.0 / lens.units_per_metre)
    problems = listed.problems + files.problems + trajectory_problems + _unposed(listed, poses) + unit
    intrinsics = lens.intrinsics
    recording = _recording(listed.stamp_ns[rows], poses, rows, lens, problems)
    return DepthImages(
        recording=replace(_with_up(recording, config.world_up), returns_to_start=returns_to_start(path)),
        depth_paths=paths,
        metres_per_unit=1.0 / lens.units_per_metre,
        focal_px=np.tile([intrinsics.fx, intrinsics.fy], (len(rows), 1)),
        centre_px=np.tile([intrinsics.cx, intrinsics.cy], (len(rows), 1)),
        colour_paths=_colour_paths(path, listed.stamp_ns[rows]) if without_poses else None,
    )


def _depth_list(path: Path) -> _DepthList:
    rows = [line.split(maxsplit=1) for line in text_lines(path / "depth.txt")]
    rows = [row for row in rows if len(row) == 2]
    stamps = np.array([stamp_ns_from_text(row[0]) for row in rows], dtype=np.int64)
    table = PoseTable(stamps, np.zeros((len(rows), 3)), np.tile([0.0, 0.0, 0.0, 1.0], (len(rows), 1)))  # stamps alone are checked
    usable = usable_rows(table, "depth.txt")
    if not len(usable.index):
        raise InputError(f"{path / 'depth.txt'}: no frames: no line of the form `stamp file`")
    problems = tuple(replace(p, code="stamp-unreadable", message="no numbers") if p.code == "pose-missing" else p for p in usable.problems)
    return _DepthList(stamps[usable.index], tuple(path / rows[row][1].strip() for row in usable.index), problems)


def _trajectory(path: Path) -> tuple[PoseTable, tuple[Problem, ...]]:
    """The poses that can be used, in time order."""
    file = next((path / name for name in TRAJECTORY_FILES if (path / name).is_file()), None)
    if file is None:
        raise InputError(f"{path}: poses missing: no {' and no '.join(TRAJECTORY_FILES)}; add a trajectory `stamp tx ty tz qx qy qz qw`")
    table = read_tum_trajectory(file)
    usable = usable_rows(table, file.name)
    if not len(usable.index):
        raise InputError(f"{file}: no pose could be read; lines must be `stamp tx ty tz qx qy qz qw`")
    return table.rows(usable.index), usable.problems


def _still(path: Path, listed: _DepthList) -> tuple[PoseTable, tuple[Problem, ...]]:
    """A camera that does not move, in place of the poses that are missing, with the problem that says so."""
    count = len(listed.stamp_ns)
    poses = PoseTable(listed.stamp_ns, np.zeros((count, 3)), np.tile([0.0, 0.0, 0.0, 1.0], (count, 1)))
    message = f"poses missing: no {' and no '.join(TRAJECTORY_FILES)}"
    advice = 'add a trajectory `stamp tx ty tz qx qy qz qw`, or set ingest.odometry = "rgbd" to have it made from the images'
    blind = not (path / "rgb.txt").is_file()  # depth alone slides along corridors: only when asked for
    return poses, (Problem(POSES_MISSING, message, str(path), advice=advice, fatal=blind),)


def _colour_paths(path: Path, stamp_ns: Array) -> tuple[Path, ...] | None:
    """The colour image nearest in time to each depth image (N,); None without rgb.txt."""
    file = path / "rgb.txt"
    rows = [row for line in text_lines(file) if len(row := line.split(maxsplit=1)) == 2] if file.is_file() else []
    if not rows:
        return None
    stamps = np.array([stamp_ns_from_text(row[0]) for row in rows], dtype=np.int64)
    return tuple(path / rows[int(np.argmin(np.abs(stamps - stamp)))][1].strip() for stamp in stamp_ns)


def _lens(path: Path, files: DepthFiles, config: ReadConfig) -> _Lens:
    """From the settings, else from intrinsics.json; scaled when it belongs to another image size."""
    file = path / "intrinsics.json"
    stored = _intrinsics_json(file) if file.is_file() else None
    units = config.depth_scale or (stored.units_per_metre if stored else UNITS_PER_METRE)
    if config.fx:
        return _Lens(Intrinsics(files.width, files.height, config.fx, config.fy or config.fx, config.cx, config.cy), units)
    if stored is None:
        advice = "set read.fx, read.fy, read.cx, read.cy, or write intrinsics.json with width, height, fx, fy, cx, cy"
        raise InputError(f"{path}: intrinsics missing: no intrinsics.json; {advice}")
    return _Lens(scaled_intrinsics(stored.intrinsics, files.width, files.height), units, stored.accuracy)


def _intrinsics_json(file: Path) -> _Lens:
    try:
        data: dict[str, Any] = json.loads(file.read_text(encoding="utf-8-sig"))
        fx, fy, cx, cy = (float(data[key]) for key in ("fx", "fy", "cx", "cy"))
        width, height = int(data["width"]), int(data["height"])
        units = float(data.get("depth_scale", UNITS_PER_METRE))
        accuracy = _accuracy(data)
    except (ValueError, KeyError, TypeError, AttributeError) as error:
        raise InputError(f"{file}: intrinsics missing: {error}; it needs width, height, fx, fy, cx, cy and may have depth_scale") from error
    if min(fx, fy, units, width, height) <= 0:
        raise InputError(f"{file}: width, height, fx, fy and depth_scale must be greater than 0")
    return _Lens(Intrinsics(width, height, fx, fy, cx, cy), units, accuracy)


def _accuracy(data: dict[str, Any]) -> RangeAccuracy | None:
    """What intrinsics.json may say of errors that last all scan long: `range_scale_sigma` (part), `range_bias_sigma` (m)."""
    if "range_scale_sigma" not in data:
        return None
    return RangeAccuracy(float(data["range_scale_sigma"]), float(data.get("range_bias_sigma", 0.0)))


def _unposed(listed: _DepthList, poses: Interpolated) -> tuple[Problem, ...]:
    if poses.known.all():
        return ()
    first = stamp_text(int(listed.stamp_ns[int(np.argmin(poses.known))]))
    message = f"depth images without a pose within {MAX_POSE_GAP_S} s"
    return (Problem("pose-gap", message, first, int((~poses.known).sum()), "these frames are left out"),)


def _recording(stamp_ns: Array, poses: Interpolated, rows: Array, lens: _Lens, problems: tuple[Problem, ...]) -> Recording:
    sensor = replace(depth_camera(lens.intrinsics), accuracy=lens.accuracy)
    unknown = np.full((len(rows), 3), np.nan)
    return Recording("tum", sensor, stamp_ns, poses.position_m[rows], poses.rotation[rows], unknown, GravitySource.UNKNOWN, problems)


def _with_up(recording: Recording, world_up: str) -> Recording:
    """The recording with gravity from the setting `read.world_up`, where that is given."""
    if not world_up:
        return recording
    down = down_in_sensor(named_axis(world_up), recording.odom_from_sensor)
    return replace(recording, down_sensor=down, gravity_source=GravitySource.WORLD)
