"""Stray Scanner exports (iPhone and iPad with LiDAR): odometry.csv, camera_matrix.csv, depth/ and confidence/ PNGs, imu.csv.

Poses are camera-to-world with OpenCV camera axes; ARKit's world is gravity aligned with +y up. The camera matrix
belongs to the colour image. Newer versions write fx, fy, cx, cy into every row of odometry.csv (and empty columns after them).
"""

from dataclasses import dataclass
from pathlib import Path

import numpy as np

from floorplan.config import ReadConfig
from floorplan.errors import InputError
from floorplan.geometry import rotation_from_quat_xyzw
from floorplan.model.checks import Array
from floorplan.model.scan import GravitySource, Intrinsics, Problem, Recording, Sensor
from floorplan.readers.depth_files import DepthFiles, look_at_depth_files
from floorplan.readers.depth_images import DepthImages, scaled_intrinsics
from floorplan.readers.depth_unit import depth_unit_problems
from floorplan.readers.imu import ImuTable, fused_up
from floorplan.readers.noise_models import phone_lidar
from floorplan.readers.pose_table import PoseTable, number_from_text, stamp_ns_from_text, text_lines
from floorplan.readers.row_checks import usable_rows
from floorplan.readers.simulated import returns_to_start
from floorplan.readers.world_up import ARKIT_UP, down_in_sensor

COLOUR_WIDTH, COLOUR_HEIGHT = 1920, 1440  # the image camera_matrix.csv belongs to
UNITS_PER_METRE = 1000.0  # depth in millimetres
POSE_NAMES = ("timestamp", "frame", "x", "y", "z", "qx", "qy", "qz", "qw")
POSE_COLUMNS = len(POSE_NAMES)
LENS_COLUMNS = 4  # fx, fy, cx, cy


@dataclass(frozen=True)
class StrayReader:
    """See `Reader`."""

    name: str = "stray"
    description: str = "Stray Scanner export (iPhone or iPad with LiDAR)"
    looks_for: str = "a folder with odometry.csv and depth/"

    def sniff(self, path: Path) -> bool:
        """True for a folder with odometry.csv and depth/."""
        return (path / "odometry.csv").is_file() and (path / "depth").is_dir()

    def open(self, path: Path, config: ReadConfig) -> DepthImages:
        """The opened scan. Raises `InputError` without frames, poses or intrinsics."""
        return _open(path, config)


@dataclass(frozen=True)
class _Odometry:
    frame: tuple[str, ...]
    poses: PoseTable
    lens: Array  # (N, 4) fx, fy, cx, cy of the colour image, NaN where the file has none
    problems: tuple[Problem, ...]


def _open(path: Path, config: ReadConfig) -> DepthImages:
    odometry = _odometry(path / "odometry.csv")
    usable = usable_rows(odometry.poses, "odometry.csv", first_line=2)
    if not len(usable.index):
        raise InputError(f"{path / 'odometry.csv'}: no row has a pose; record again with tracking running")
    files = look_at_depth_files([path / "depth" / f"{odometry.frame[row]}.png" for row in usable.index], path / "depth")
    rows = usable.index[files.whole]
    lens = _depth_lens(path, odometry.lens[rows], files, config)
    poses = odometry.poses.rows(rows)
    confidence, confidence_problems = _confidence_paths(path, [odometry.frame[row] for row in rows])
    paths = tuple(path / "depth" / f"{odometry.frame[row]}.png" for row in rows)
    metres_per_unit = 1.0 / (config.depth_scale or UNITS_PER_METRE)
    problems = (
        odometry.problems
        + _unposed(path / "depth", odometry.frame)
        + usable.problems
        + files.problems
        + confidence_problems
        + depth_unit_problems(paths, metres_per_unit)
    )
    return DepthImages(
        recording=_recording(path, poses, _sensor(files, lens), problems),
        depth_paths=paths,
        metres_per_unit=metres_per_unit,
        focal_px=lens[:, :2],
        centre_px=lens[:, 2:],
        confidence_paths=confidence,
    )


def _odometry(path: Path) -> _Odometry:
    """Rows of odometry.csv, old or new version; short rows are NaN."""
    header, *rows = [[cell.strip() for cell in line.split(",")] for line in text_lines(path)] or [[]]
    rows = [row for row in rows if len(row) > 1]
    if not rows:
        raise InputError(f"{path}: no frames: the file has no rows")
    width = POSE_COLUMNS + LENS_COLUMNS
    numbers = np.array([[number_from_text(cell) for cell in (row + [""] * width)[2:width]] for row in rows])
    stamps = np.array([stamp_ns_from_text(row[0]) for row in rows], dtype=np.int64)
    return _Odometry(
        tuple(row[1] for row in rows), PoseTable(stamps, numbers[:, :3], numbers[:, 3:7]), numbers[:, 7:], _header_problems(header)
    )


def _header_problems(header: list[str]) -> tuple[Problem, ...]:
    """Whether the first line is the app's; the columns are taken by their place."""
    if tuple(cell.lower() for cell in header[:POSE_COLUMNS]) == POSE_NAMES:
        return ()
    advice = (
        f"the columns are taken as {', '.join(POSE_NAMES)}, and the first line is no frame; check that the file is whole and the app's own"
    )
    return (Problem("header-unknown", "the first line is not the header of Stray Scanner", "odometry.csv, row 1", 1, advice),)


def _unposed(folder: Path, frames: tuple[str, ...]) -> tuple[Problem, ...]:
    """Depth images that odometry.csv says nothing about: it was cut off, or rows were lost."""
    lost = sorted({file.stem for file in folder.glob("*.png") if not file.name.startswith(".")} - set(frames))
    if not lost:
        return ()
    whole = len(lost) + len(set(frames))
    message = f"{len(lost)} of {whole} depth images have no row in odometry.csv: it is cut off, or rows were lost"
    advice = "these frames are left out; copy the recording again, or export it again"
    return (Problem("frame-unposed", message, str(folder / f"{lost[0]}.png"), len(lost), advice),)


def _depth_lens(path: Path, lens: Array, files: DepthFiles, config: ReadConfig) -> Array:
    """fx, fy, cx, cy (N, 4) of each depth image: from the settings, else per frame, else from camera_matrix.csv."""
    if config.fx:
        return np.tile([config.fx, config.fy or config.fx, config.cx, config.cy], (len(lens), 1))
    per_frame = np.asarray(np.isfinite(lens).all(axis=1) & (lens[:, :2] > 0).all(axis=1))
    if not per_frame.all():
        lens = np.where(per_frame[:, None], lens, _camera_matrix(path / "camera_matrix.csv"))
    colour = [Intrinsics(COLOUR_WIDTH, COLOUR_HEIGHT, *row) for row in lens.tolist()]
    depth = [scaled_intrinsics(c, files.width, files.height) for c in colour]
    return np.array([[d.fx, d.fy, d.cx, d.cy] for d in depth])


def _camera_matrix(path: Path) -> Array:
    """fx, fy, cx, cy (4,) of the colour image."""
    if not path.is_file():
        raise InputError(f"{path}: intrinsics missing: no camera_matrix.csv; export again, or set read.fx, read.fy, read.cx, read.cy")
    cells = [[number_from_text(cell) for cell in line.split(",")] for line in text_lines(path)]
    if len(cells) != 3 or any(len(row) != 3 for row in cells) or not np.isfinite(cells).all() or cells[0][0] <= 0:
        raise InputError(f"{path}: intrinsics missing: not a 3 x 3 camera matrix; set read.fx, read.fy, read.cx, read.cy instead")
    return np.array([cells[0][0], cells[1][1], cells[0][2], cells[1][2]])


def _confidence_paths(path: Path, names: list[str]) -> tuple[tuple[Path, ...] | None, tuple[Problem, ...]]:
    """Confidence images, all of them or none."""
    paths = tuple(path / "confidence" / f"{name}.png" for name in names)
    missing = [p for p in paths if not p.is_file()]
    if not missing:
        return paths, ()
    advice = "no confidence is used: distant and grazing points may be worse than need be"
    return None, (Problem("confidence-missing", "confidence images not there", str(missing[0]), len(missing), advice),)


def _sensor(files: DepthFiles, lens: Array) -> Sensor:
    fx, fy, cx, cy = np.median(lens, axis=0).tolist()
    return phone_lidar(Intrinsics(files.width, files.height, fx, fy, cx, cy))


def _recording(path: Path, poses: PoseTable, sensor: Sensor, problems: tuple[Problem, ...]) -> Recording:
    """The recording with gravity from the IMU and ARKit's world, or from the world alone where no IMU row exists."""
    rotation = rotation_from_quat_xyzw(poses.quat_xyzw)
    imu = _imu(path / "imu.csv")
    up, source = ARKIT_UP, GravitySource.WORLD
    if len(imu):
        fused = fused_up(imu, poses.stamp_ns, rotation, ARKIT_UP)
        up, source, problems = fused.up_world, fused.source, problems + fused.problems
    down_sensor = down_in_sensor(up, rotation)
    ends = returns_to_start(path)
    return Recording("stray", sensor, poses.stamp_ns, poses.position_m, rotation, down_sensor, source, problems, ends)


def _imu(path: Path) -> ImuTable:
    """Down-pointing accelerations in OpenCV camera axes; empty when there is no file or no row."""
    lines = text_lines(path)[1:] if path.is_file() else []
    rows = [cells for cells in (line.split(",") for line in lines) if len(cells) >= 4]
    stamps = np.array([stamp_ns_from_text(row[0]) for row in rows], dtype=np.int64)
    a = np.array([[number_from_text(cell) for cell in row[1:4]] for row in rows]).reshape(-1, 3)
    down = np.stack([-a[:, 1], -a[:, 0], -a[:, 2]], axis=1)  # device axes to camera axes; at rest this points down
    return ImuTable(stamps, down).usable()
