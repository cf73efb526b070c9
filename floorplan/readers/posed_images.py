"""Folders with one depth image, one pose and one set of intrinsics per frame: what the phone apps and ScanNet have in common."""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from floorplan.config import ReadConfig
from floorplan.errors import InputError
from floorplan.geometry import quat_xyzw_from_rotation
from floorplan.model.checks import Array
from floorplan.model.scan import GravitySource, Intrinsics, Problem, Recording
from floorplan.readers.depth_files import look_at_depth_files
from floorplan.readers.depth_images import DepthImages, scaled_intrinsics
from floorplan.readers.depth_unit import depth_unit_problems
from floorplan.readers.noise_models import depth_camera, phone_lidar
from floorplan.readers.pose_table import PoseTable
from floorplan.readers.row_checks import usable_rows
from floorplan.readers.simulated import returns_to_start
from floorplan.readers.world_up import down_in_sensor, named_axis

MILLIMETRES_PER_METRE = 1000.0
NOT_RIGID = 1e-2  # a rotation's columns are of length 1 to better than this


@dataclass(frozen=True)
class PosedImage:
    """One frame: `world_from_camera (4, 4)`, OpenCV camera axes, NaN where tracking was lost; `lens` of an image of the same view,
    whatever its size; `confidence` None where the format has none."""

    stamp_ns: int
    depth: Path
    world_from_camera: Array
    lens: Intrinsics
    confidence: Path | None = None


@dataclass(frozen=True)
class PosedFolder:
    """A recording of such frames. `up (3,)` the world's up direction where the format promises one; `phone`: a LiDAR phone's depth."""

    format: str
    path: Path
    images: Sequence[PosedImage]
    up: Array | None
    phone: bool
    confidence_step: int = 1
    problems: tuple[Problem, ...] = ()


def open_posed(folder: PosedFolder, config: ReadConfig) -> DepthImages:
    """The opened scan. Raises `InputError` where no frame has both a pose and an image."""
    images = folder.images
    table = _poses(images)
    usable = usable_rows(table, "frames")
    if not len(usable.index):
        raise InputError(f"{folder.path}: no frame has a pose; record again with tracking running")
    files = look_at_depth_files([images[row].depth for row in usable.index], folder.path)
    rows = usable.index[files.whole]
    kept = [images[row] for row in rows]
    lenses = [_depth_lens(image.lens, files.width, files.height, config) for image in kept]
    metres_per_unit = 1.0 / (config.depth_scale or MILLIMETRES_PER_METRE)
    paths = tuple(image.depth for image in kept)
    confidence, missing = _confidence(kept)
    problems = folder.problems + usable.problems + files.problems + missing + depth_unit_problems(paths, metres_per_unit)
    middle = Intrinsics(files.width, files.height, *np.median([[s.fx, s.fy, s.cx, s.cy] for s in lenses], axis=0).tolist())
    poses = np.array([image.world_from_camera for image in kept])
    rotation = _orthogonal(poses[:, :3, :3])
    up = named_axis(config.world_up) if config.world_up else folder.up
    recording = Recording(
        format=folder.format,
        sensor=phone_lidar(middle) if folder.phone else depth_camera(middle),
        stamp_ns=table.stamp_ns[rows],
        position_m=poses[:, :3, 3],
        odom_from_sensor=rotation,
        down_sensor=np.full((len(rows), 3), np.nan) if up is None else down_in_sensor(up, rotation),
        gravity_source=GravitySource.UNKNOWN if up is None else GravitySource.WORLD,
        problems=problems,
        returns_to_start=returns_to_start(folder.path),
    )
    focal, centre = np.array([[s.fx, s.fy] for s in lenses]), np.array([[s.cx, s.cy] for s in lenses])
    return DepthImages(recording, paths, metres_per_unit, focal, centre, confidence, confidence_step=folder.confidence_step)


def matrix_of(numbers: Sequence[float], where: Path) -> Array:
    """A rigid transform (4, 4) from its 12 or 16 numbers, row by row; NaN where they are none. Raises `InputError` for other counts."""
    if len(numbers) not in (12, 16):
        raise InputError(f"{where}: a pose has {len(numbers)} numbers, not 12 or 16; export the recording again")
    pose = np.eye(4)
    pose[:3] = np.asarray(numbers[:12], dtype=np.float64).reshape(3, 4)
    lengths = np.linalg.norm(pose[:3, :3], axis=0)
    rigid = bool(np.isfinite(pose).all()) and bool((np.abs(lengths - 1) < NOT_RIGID).all())
    return pose if rigid else np.full((4, 4), np.nan)


def _poses(images: Sequence[PosedImage]) -> PoseTable:
    """Stamps and poses of all frames; the quaternion is NaN where there is no pose."""
    poses = np.array([image.world_from_camera for image in images]).reshape(-1, 4, 4)
    known = np.isfinite(poses).all(axis=(1, 2))
    rotation = np.where(known[:, None, None], poses[:, :3, :3], np.eye(3))
    quats = np.where(known[:, None], quat_xyzw_from_rotation(rotation), np.nan)
    return PoseTable(np.array([image.stamp_ns for image in images], dtype=np.int64), poses[:, :3, 3], quats)


def _orthogonal(rotation: Array) -> Array:
    """The nearest rotations (N, 3, 3): text rounds them."""
    u, _, vt = np.linalg.svd(rotation)
    return np.asarray(u @ vt)


def _depth_lens(lens: Intrinsics, width: int, height: int, config: ReadConfig) -> Intrinsics:
    if config.fx:
        return Intrinsics(width, height, config.fx, config.fy or config.fx, config.cx, config.cy)
    return scaled_intrinsics(lens, width, height)


def _confidence(images: Sequence[PosedImage]) -> tuple[tuple[Path, ...] | None, tuple[Problem, ...]]:
    """Confidence images, all of them or none."""
    paths = [image.confidence for image in images if image.confidence is not None]
    if not paths:
        return None, ()
    missing = [path for path in paths if not path.is_file()]
    if not missing and len(paths) == len(images):
        return tuple(paths), ()
    where = str(missing[0]) if missing else str(images[0].depth)
    advice = "no confidence is used: distant and grazing points may be worse than need be"
    return None, (Problem("confidence-missing", "confidence images not there", where, max(len(missing), 1), advice),)
