"""Poses for a folder of clouds: a TUM trajectory with stamps, or KITTI's rows of twelve numbers, one per cloud."""

from dataclasses import dataclass
from pathlib import Path

import numpy as np

from floorplan.errors import InputError
from floorplan.geometry import quat_xyzw_from_rotation, rotation_from_quat_xyzw
from floorplan.model.checks import Array
from floorplan.model.scan import Problem
from floorplan.readers.pose_table import (
    MISSING_STAMP_NS,
    PoseTable,
    interpolate,
    number_from_text,
    read_tum_trajectory,
    stamp_ns_from_text,
    text_lines,
)
from floorplan.readers.row_checks import usable_rows

TRAJECTORY_NAMES = ("trajectory.tum", "poses.tum", "odometry.tum", "trajectory.txt", "odometry.txt", "groundtruth.txt", "poses.txt")
KITTI_NUMBERS, TUM_NUMBERS = 12, 8
MAX_POSE_GAP_S = 0.5
USUAL_HZ = 10.0  # of a spinning LiDAR, where nothing tells the stamps
NANOSECOND_DIGITS = 16  # whole numbers of so many digits are nanoseconds since 1970, not a frame's number


@dataclass(frozen=True)
class CloudPoses:
    """One row per cloud (N): stamps, positions, rotations; `known (N,)`; problems of the trajectory file."""

    stamp_ns: Array
    position_m: Array
    rotation: Array
    known: Array
    problems: tuple[Problem, ...] = ()


def trajectory_file(path: Path) -> Path | None:
    """The trajectory beside the clouds, else in the folder above them: one of the usual names, or the only .tum file."""
    for folder in (path, path.parent):
        named = [folder / name for name in TRAJECTORY_NAMES if (folder / name).is_file()] or sorted(folder.glob("*.tum"))
        if named and (named[0].name in TRAJECTORY_NAMES or len(named) == 1):
            return named[0]
    return None


def cloud_poses(file: Path, clouds: list[Path]) -> CloudPoses:
    """The pose of every cloud. Raises `InputError` where rows and clouds cannot be matched."""
    rows = [line.replace(",", " ").split() for line in text_lines(file)]
    if not rows:
        raise InputError(f"{file}: no poses in it")
    if len(rows[0]) == KITTI_NUMBERS:
        return _by_number(_kitti(file, rows), file, clouds)
    if len(rows[0]) >= TUM_NUMBERS:
        return _by_stamp(file, clouds)
    raise InputError(f"{file}: rows of {len(rows[0])} numbers; a trajectory has 8 (`stamp tx ty tz qx qy qz qw`) or 12 (KITTI)")


def _by_stamp(file: Path, clouds: list[Path]) -> CloudPoses:
    table = read_tum_trajectory(file)
    usable = usable_rows(table, file.name)
    if not len(usable.index):
        raise InputError(f"{file}: no pose could be read; rows must be `stamp tx ty tz qx qy qz qw`")
    stamps = np.array([stamp_of_name(cloud) for cloud in clouds], dtype=np.int64)
    if (stamps == MISSING_STAMP_NS).any():  # numbered clouds: as many rows as clouds, or the numbers are those of the rows
        return _by_number(table, file, clouds, usable.problems)
    poses = interpolate(table.rows(usable.index), stamps, MAX_POSE_GAP_S)
    return CloudPoses(stamps, poses.position_m, poses.rotation, poses.known, usable.problems)


def _by_number(table: PoseTable, file: Path, clouds: list[Path], problems: tuple[Problem, ...] = ()) -> CloudPoses:
    """Row k belongs to the k-th cloud in the order of their names, or to the cloud called k."""
    numbers = [int(cloud.name.split(".")[0]) if cloud.name.split(".")[0].isdigit() else -1 for cloud in clouds]
    rows = np.array(numbers if len(clouds) < len(table) and min(numbers) >= 0 and max(numbers) < len(table) else range(len(clouds)))
    if len(rows) and rows[-1] >= len(table):
        raise InputError(f"{file}: {len(table)} poses for {len(clouds)} clouds; name the clouds by their stamps, or give a pose for each")
    mine = table.rows(rows)
    good = np.asarray(mine.valid, dtype=bool)
    quats = np.where(good[:, None], mine.quat_xyzw, [0.0, 0.0, 0.0, 1.0])
    return CloudPoses(mine.stamp_ns, mine.position_m, rotation_from_quat_xyzw(quats), good, problems)


def stamp_of_name(cloud: Path) -> int:
    """Nanoseconds of `1311868164.36.ply`, `1311868164360000000.pcd` and the like; MISSING_STAMP_NS for a mere number."""
    stem = cloud.name
    for suffix in (".pcd.bin", cloud.suffix):
        stem = stem.removesuffix(suffix)
    if stem.isdigit():
        return int(stem) if len(stem) >= NANOSECOND_DIGITS else int(MISSING_STAMP_NS)
    return stamp_ns_from_text(stem)


def _kitti(file: Path, rows: list[list[str]]) -> PoseTable:
    """Rows of `pose (3, 4)`, of the LiDAR; with KITTI's calib.txt those of camera 0 are turned into them."""
    values = np.array([[number_from_text(cell) for cell in (row + ["nan"] * KITTI_NUMBERS)[:KITTI_NUMBERS]] for row in rows])
    pose = np.tile(np.eye(4), (len(values), 1, 1))
    pose[:, :3] = values.reshape(-1, 3, 4)
    camera_from_lidar = _calibration(file.parent / "calib.txt")
    if camera_from_lidar is not None:
        pose = np.linalg.inv(camera_from_lidar) @ pose @ camera_from_lidar
    good = np.asarray(np.isfinite(pose).all(axis=(1, 2)), dtype=bool)
    u, _, vt = np.linalg.svd(np.where(good[:, None, None], pose[:, :3, :3], np.eye(3)))
    quats = np.where(good[:, None], quat_xyzw_from_rotation(u @ vt), np.nan)
    return PoseTable(_times(file.parent / "times.txt", len(pose)), pose[:, :3, 3], quats)


def _calibration(file: Path) -> Array | None:
    """`Tr` of calib.txt (4, 4), camera 0 from LiDAR; None without it."""
    lines = text_lines(file) if file.is_file() else []
    row = next((line.split()[1:] for line in lines if line.startswith(("Tr:", "Tr_velo_to_cam:"))), None)
    if row is None:
        return None
    values = np.array([number_from_text(cell) for cell in row])
    if len(values) != KITTI_NUMBERS or not np.isfinite(values).all():
        raise InputError(f"{file}: Tr is no 3 x 4 matrix; leave the file out where the poses are the LiDAR's own")
    transform = np.eye(4)
    transform[:3] = values.reshape(3, 4)
    return transform


def _times(file: Path, count: int) -> Array:
    """Stamps from times.txt, one a row, else at USUAL_HZ."""
    if not file.is_file():
        return np.round(np.arange(count) * 1e9 / USUAL_HZ).astype(np.int64)
    stamps = [stamp_ns_from_text(line.split()[0]) for line in text_lines(file)]
    if len(stamps) < count:
        raise InputError(f"{file}: {len(stamps)} stamps for {count} poses; leave the file out to count at {USUAL_HZ:g} Hz")
    return np.array(stamps[:count], dtype=np.int64)
