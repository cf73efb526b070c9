"""A folder of clouds of a spinning LiDAR (PLY, PCD, KITTI `.bin`) with a trajectory: organised into rings x columns.

Sensor axes x ahead, y left, z up; the trajectory's world has +z up unless `read.world_up` says otherwise.
"""

from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from floorplan.config import ReadConfig
from floorplan.errors import InputError
from floorplan.geometry import quat_xyzw_from_rotation
from floorplan.model.scan import Frame, GravitySource, Problem, Recording
from floorplan.readers.base import BadFrame
from floorplan.readers.cloud_files import SUFFIXES, read_cloud
from floorplan.readers.cloud_grid import Cloud, RingGrid, grid_of, on_grid
from floorplan.readers.cloud_poses import TRAJECTORY_NAMES, CloudPoses, cloud_poses, trajectory_file
from floorplan.readers.noise_models import spinning_lidar
from floorplan.readers.pose_table import PoseTable
from floorplan.readers.row_checks import pose_gaps, usable_rows
from floorplan.readers.simulated import returns_to_start
from floorplan.readers.world_up import down_in_sensor, named_axis

FOLDERS = ("", "velodyne", "clouds", "points", "lidar", "pcd", "ply", "velodyne_points/data")  # where clouds lie, as seen from the scan
MIN_CLOUDS = 2  # one cloud is a model, not a recording


@dataclass(frozen=True)
class CloudsReader:
    """See `Reader`."""

    name: str = "clouds"
    description: str = "folder of LiDAR clouds (PLY, PCD, KITTI .bin) with a trajectory"
    looks_for: str = "a folder with .ply, .pcd or .bin clouds (or with velodyne/, clouds/) and trajectory.tum or poses.txt"

    def sniff(self, path: Path) -> bool:
        """True for a folder of clouds beside a trajectory."""
        found = cloud_folder(path)
        return found is not None and trajectory_file(found) is not None

    def open(self, path: Path, config: ReadConfig) -> "CloudScan":
        """The opened scan. Raises `InputError` without clouds or poses."""
        folder = cloud_folder(path)
        if folder is None:
            raise InputError(f"{path}: no clouds: no folder with {', '.join(SUFFIXES)} files")
        poses_file = trajectory_file(folder)
        if poses_file is None:
            raise InputError(f"{path}: poses missing: no {', '.join(TRAJECTORY_NAMES)}; add a trajectory `stamp tx ty tz qx qy qz qw`")
        return _open(path, clouds_in(folder), poses_file, config)


@dataclass(frozen=True)
class CloudScan:
    """A `Source` of cloud files, one per row of `recording`."""

    recording: Recording
    paths: tuple[Path, ...]
    rings: RingGrid | None

    def frames(self, indices: Iterable[int], stride: int = 1) -> Iterator[Frame | BadFrame]:
        """See `Source.frames`."""
        for index in indices:
            yield self._frame(int(index), stride)

    def _frame(self, index: int, stride: int) -> Frame | BadFrame:
        path, sensor = self.paths[index], self.recording.sensor
        try:
            points = on_grid(read_cloud(path), self.rings)
        except InputError as error:
            return BadFrame(index, Problem("cloud-unreadable", str(error), str(path), advice="copy the recording again"))
        if points.shape[:2] != (sensor.height, sensor.width):
            return BadFrame(index, Problem("cloud-unreadable", "the cloud has another size than the first one", str(path)))
        points = np.array(points[::stride, ::stride])
        points[np.einsum("hwi,hwi->hw", points, points) > sensor.max_range_m**2] = np.nan
        return Frame(index, int(self.recording.stamp_ns[index]), points)


def cloud_folder(path: Path) -> Path | None:
    """The folder at or below `path` that holds the clouds; None where there is none."""
    if not path.is_dir():
        return None
    return next((path / name for name in FOLDERS if (path / name).is_dir() and len(clouds_in(path / name)) >= MIN_CLOUDS), None)


def clouds_in(folder: Path) -> list[Path]:
    """The clouds of a folder by name, those of its commonest kind."""
    kinds = [sorted(path for path in folder.iterdir() if path.suffix == suffix and path.is_file()) for suffix in SUFFIXES]
    return max(kinds, key=len)


def _open(path: Path, clouds: list[Path], poses_file: Path, config: ReadConfig) -> CloudScan:
    poses = cloud_poses(poses_file, clouds)
    table = PoseTable(poses.stamp_ns, poses.position_m, quat_xyzw_from_rotation(poses.rotation))
    usable = usable_rows(table.rows(np.flatnonzero(poses.known)), poses_file.name)
    rows = np.flatnonzero(poses.known)[usable.index]
    if not len(rows):
        raise InputError(f"{path}: no cloud has a pose in {poses_file.name}; both need the same clock")
    first, damaged = _first_readable([clouds[row] for row in rows])
    rings = grid_of(first)
    sensor = spinning_lidar(on_grid(first, rings))
    rotation, up = poses.rotation[rows], named_axis(config.world_up or "+z")
    recording = Recording(
        format="clouds",
        sensor=sensor,
        stamp_ns=poses.stamp_ns[rows],
        position_m=poses.position_m[rows],
        odom_from_sensor=rotation,
        down_sensor=down_in_sensor(up, rotation),
        gravity_source=GravitySource.WORLD,
        problems=poses.problems + _gaps(poses, poses_file) + usable.problems + damaged,
        returns_to_start=returns_to_start(path),
    )
    return CloudScan(recording, tuple(clouds[row] for row in rows), rings)


def _first_readable(clouds: list[Path]) -> tuple[Cloud, tuple[Problem, ...]]:
    """The first cloud that can be read, and what is wrong with those before it. Raises `InputError` where none can."""
    wrong: list[InputError] = []
    for path in clouds:
        try:
            cloud = read_cloud(path)
        except InputError as error:
            wrong.append(error)
            continue
        told = (Problem("cloud-unreadable", str(wrong[0]), count=len(wrong), advice="copy the recording again"),) if wrong else ()
        return cloud, told
    raise InputError(f"not one of {len(clouds)} clouds can be read; the first: {wrong[0]}")


def _gaps(poses: CloudPoses, file: Path) -> tuple[Problem, ...]:
    return pose_gaps(poses.stamp_ns, np.asarray(poses.known, dtype=bool), file.name)
