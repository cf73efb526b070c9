"""Record3D recordings (`.r3d`, a ZIP file): metadata (JSON), rgbd/<n>.depth (float32 metres), rgbd/<n>.conf, both LZFSE.

After public readers of the format (nerfstudio's record3d_utils, github.com/marek-simonik/record3d): `poses` are camera-to-world,
`qx qy qz qw tx ty tz`, in ARKit's axes; `K` is column by column and, as `perFrameIntrinsicCoeffs` (fx, fy, cx, cy), belongs to the
colour image `w` x `h`; depth images are `dw` x `dh`. Not checked against bytes of the app.
"""

import zipfile
import zlib
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from floorplan.config import ReadConfig
from floorplan.errors import InputError
from floorplan.geometry import rotation_from_quat_xyzw
from floorplan.model.checks import Array
from floorplan.model.scan import Frame, GravitySource, Intrinsics, Problem, Recording
from floorplan.readers.base import BadFrame
from floorplan.readers.depth_images import BEST_CONFIDENCE, scaled_intrinsics
from floorplan.readers.json_files import numbers, text_object
from floorplan.readers.lzfse import unpacked
from floorplan.readers.noise_models import phone_lidar
from floorplan.readers.pose_table import MISSING_STAMP_NS, PoseTable
from floorplan.readers.row_checks import usable_rows
from floorplan.readers.world_up import ARKIT_UP, OPENCV_FROM_ARKIT, down_in_sensor, named_axis

SUFFIX = ".r3d"
USUAL_HZ = 60.0  # of the app, where the metadata tell neither stamps nor rate
POSE_NUMBERS, LENS_NUMBERS = 7, 4
FLOAT_BYTES = 4


@dataclass(frozen=True)
class Record3dReader:
    """See `Reader`."""

    name: str = "record3d"
    description: str = "Record3D recording (.r3d, iPhone or iPad with LiDAR)"
    looks_for: str = "a .r3d file"

    def sniff(self, path: Path) -> bool:
        """True for a .r3d file."""
        return path.is_file() and path.suffix.lower() == SUFFIX

    def open(self, path: Path, config: ReadConfig) -> "Record3dScan":
        """The opened scan. Raises `InputError` when it is no such file, or has no frames."""
        with _opened(path) as archive:
            names = set(archive.namelist())
            if "metadata" not in names:
                raise InputError(f"{path}: no metadata in it; share the recording from Record3D as .r3d again")
            tree = text_object(_member(archive, "metadata", path), path)
        return _open(path, tree, names, config)


@dataclass(frozen=True)
class Record3dScan:
    """A `Source` of the archive's depth images. `number (N,)` of each row's frame; `lens (N, 4)` fx, fy, cx, cy of its depth image."""

    recording: Recording
    path: Path
    number: Array
    lens: Array
    confident: bool

    def frames(self, indices: Iterable[int], stride: int = 1) -> Iterator[Frame | BadFrame]:
        """See `Source.frames`."""
        with _opened(self.path) as archive:
            for index in indices:
                yield self._frame(archive, int(index), stride)

    def _frame(self, archive: zipfile.ZipFile, index: int, stride: int) -> Frame | BadFrame:
        sensor, stem = self.recording.sensor, f"rgbd/{self.number[index]}"
        count = sensor.height * sensor.width
        try:
            depth = np.frombuffer(_read(archive, f"{stem}.depth", count * FLOAT_BYTES, self.path), dtype="<f4")
            confidence = _read(archive, f"{stem}.conf", count, self.path) if self.confident else None
        except InputError as error:
            return BadFrame(index, Problem("depth-unreadable", str(error), str(self.path), advice="copy the recording again"))
        points = self._points(index, depth.reshape(sensor.height, sensor.width), stride)
        levels = None if confidence is None else np.frombuffer(confidence, dtype=np.uint8).reshape(sensor.height, sensor.width)
        thinned = None if levels is None else np.ascontiguousarray(np.minimum(levels, BEST_CONFIDENCE)[::stride, ::stride])
        return Frame(index, int(self.recording.stamp_ns[index]), points, thinned)

    def _points(self, index: int, depth: Array, stride: int) -> Array:
        from floorplan.readers.back_project import back_project

        sensor = self.recording.sensor
        fx, fy, cx, cy = self.lens[index]
        ray_x = ((np.arange(0, sensor.width, stride) - cx) / fx).astype(np.float32)
        ray_y = ((np.arange(0, sensor.height, stride) - cy) / fy).astype(np.float32)
        return back_project(depth, stride, 1.0, sensor.max_range_m, ray_x, ray_y)


def _opened(path: Path) -> zipfile.ZipFile:
    try:
        return zipfile.ZipFile(path)
    except (OSError, zipfile.BadZipFile) as error:
        raise InputError(f"{path}: no ZIP file, or cut off ({error}); share the recording from Record3D again") from error


def _read(archive: zipfile.ZipFile, name: str, size: int, path: Path) -> bytes:
    return unpacked(_member(archive, name, path), size, f"{path}: {name}")


def _member(archive: zipfile.ZipFile, name: str, path: Path) -> bytes:
    """One file of the archive. Raises `InputError` where it is missing or damaged."""
    try:
        return archive.read(name)
    except (KeyError, OSError, EOFError, zipfile.BadZipFile, zlib.error) as error:
        raise InputError(f"{path}: {name} cannot be read ({error})") from error


def _open(path: Path, tree: dict[str, Any], names: set[str], config: ReadConfig) -> Record3dScan:
    width, height = (int(value) for value in numbers(tree, ("dw", "dh"), path))
    poses = _table(tree, "poses", POSE_NUMBERS, path)
    table = PoseTable(_stamps(tree, len(poses), path), poses[:, 4:], poses[:, :4])
    usable = usable_rows(table, "metadata, poses")
    there = np.array([f"rgbd/{row}.depth" in names for row in usable.index], dtype=bool)
    rows = usable.index[there]
    if not len(rows):
        raise InputError(f"{path}: no frame has both a pose and a depth image")
    lens = _depth_lens(tree, rows, width, height, path, config)
    rotation = rotation_from_quat_xyzw(table.quat_xyzw[rows]) @ OPENCV_FROM_ARKIT
    up = named_axis(config.world_up) if config.world_up else ARKIT_UP
    confident = all(f"rgbd/{row}.conf" in names for row in rows)
    advice = "no confidence is used: distant and grazing points may be worse than need be"
    gone = () if there.all() else (Problem("frame-missing", "depth images of posed frames not there", str(path), int((~there).sum())),)
    bare = () if confident else (Problem("confidence-missing", "confidence images not there", str(path), advice=advice),)
    recording = Recording(
        format="record3d",
        sensor=phone_lidar(Intrinsics(width, height, *np.median(lens, axis=0).tolist())),
        stamp_ns=table.stamp_ns[rows],
        position_m=table.position_m[rows],
        odom_from_sensor=rotation,
        down_sensor=down_in_sensor(up, rotation),
        gravity_source=GravitySource.WORLD,
        problems=usable.problems + gone + bare,
    )
    return Record3dScan(recording, path, rows, lens, confident)


def _table(tree: dict[str, Any], name: str, width: int, path: Path) -> Array:
    """Rows of `width` numbers called `name`. Raises `InputError` for anything else."""
    try:
        return np.array(tree[name], dtype=np.float64).reshape(len(tree[name]), width)
    except (KeyError, TypeError, ValueError) as error:
        raise InputError(f"{path}: {name} in its metadata are no rows of {width} numbers ({error})") from error


def _stamps(tree: dict[str, Any], count: int, path: Path) -> Array:
    """From `frameTimestamps`, else counted at `fps`."""
    told = tree.get("frameTimestamps")
    if isinstance(told, list) and len(told) == count:
        seconds = _table({"frameTimestamps": [[value] for value in told]}, "frameTimestamps", 1, path)[:, 0]
        good = np.isfinite(seconds)
        return np.where(good, np.round(np.where(good, seconds, 0.0) * 1e9), MISSING_STAMP_NS).astype(np.int64)
    rate = tree.get("fps")
    hz = float(rate) if isinstance(rate, int | float) and rate > 0 else USUAL_HZ
    return np.asarray(np.round(np.arange(count) * 1e9 / hz).astype(np.int64))


def _depth_lens(tree: dict[str, Any], rows: Array, width: int, height: int, path: Path, config: ReadConfig) -> Array:
    """fx, fy, cx, cy (N, 4) of each depth image."""
    if config.fx:
        return np.tile([config.fx, config.fy or config.fx, config.cx, config.cy], (len(rows), 1))
    w, h = (int(value) for value in numbers(tree, ("w", "h"), path))
    if tree.get("perFrameIntrinsicCoeffs"):
        table = _table(tree, "perFrameIntrinsicCoeffs", LENS_NUMBERS, path)
        colour = table[np.minimum(rows, len(table) - 1)]
    else:
        k = _table({"K": [tree.get("K")]}, "K", 9, path)[0]
        colour = np.tile([k[0], k[4], k[6], k[7]], (len(rows), 1))
    if not (np.isfinite(colour).all() and (colour[:, :2] > 0).all()):
        raise InputError(f"{path}: intrinsics missing: K in its metadata is no camera matrix; set read.fx, read.fy, read.cx, read.cy")
    depth = [scaled_intrinsics(Intrinsics(w, h, *row), width, height) for row in colour.tolist()]
    return np.array([[d.fx, d.fy, d.cx, d.cy] for d in depth])
