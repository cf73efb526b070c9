"""ROS 1 and ROS 2 bags: depth images with CameraInfo, LaserScan, organised PointCloud2; poses from Odometry, PoseStamped or tf."""

from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from itertools import pairwise
from pathlib import Path

import numpy as np

from floorplan.config import ReadConfig
from floorplan.errors import InputError
from floorplan.geometry import quat_xyzw_from_rotation
from floorplan.model.checks import Array
from floorplan.model.scan import Frame, GravitySource, Problem, Recording
from floorplan.readers.base import BadFrame
from floorplan.readers.cloud_grid import RingGrid
from floorplan.readers.pose_table import PoseTable
from floorplan.readers.ros_bag import bag_paths, messages, topics_of
from floorplan.readers.ros_decode import grid_points, stamp_ns_of
from floorplan.readers.ros_gravity import with_gravity
from floorplan.readers.ros_index import index_bag
from floorplan.readers.ros_sensor import ray_table, rings_of, sensor_of
from floorplan.readers.ros_topics import POINT_CLOUD, choose_topics
from floorplan.readers.row_checks import pose_gaps, usable_rows


@dataclass(frozen=True)
class RosReader:
    """See `Reader`."""

    name: str = "ros"
    description: str = "ROS 1 or ROS 2 bag: depth images, sweeps or clouds"
    looks_for: str = "a ROS bag (.bag, .db3, .mcap), or a folder with metadata.yaml or bag files"

    def sniff(self, path: Path) -> bool:
        """True for bag files and folders that hold them."""
        return bool(bag_paths(path))

    def open(self, path: Path, config: ReadConfig) -> "BagScan":
        """The opened scan. Raises `InputError` without ranges or poses, or when several topics would do."""
        paths = bag_paths(path)
        if not paths:
            raise InputError(f"{path}: no ROS bag: neither .bag, .db3, .mcap nor a folder with metadata.yaml")
        return _open(paths, config)


@dataclass(frozen=True)
class BagScan:
    """A `Source` of the range messages of a bag. `log_ns (N,)` when each was written: the bag's own index."""

    recording: Recording
    paths: tuple[Path, ...]
    topic: str
    log_ns: Array
    rays: Array
    rings: RingGrid | None = None

    def frames(self, indices: Iterable[int], stride: int = 1) -> Iterator[Frame | BadFrame]:
        """See `Source.frames`. Rows that increase are read in one pass over the bag."""
        for run in _increasing_runs(list(indices)):
            yield from self._run(run, stride)

    def _run(self, rows: list[int], stride: int) -> Iterator[Frame | BadFrame]:
        pending = {int(self.recording.stamp_ns[row]): row for row in rows}
        for message in messages(self.paths, {self.topic}, self.log_ns[rows].tolist()):
            row = pending.pop(stamp_ns_of(message.value), None)
            if row is None:
                continue
            try:
                points = grid_points(message.value, message.type, self.rays, self.rings)
            except (InputError, ValueError) as error:
                yield BadFrame(row, Problem("message-unreadable", str(error), self.topic))
                continue
            yield self._frame(row, points, stride)
        for row in pending.values():
            yield BadFrame(row, Problem("message-unreadable", "the message cannot be found again", self.topic))

    def _frame(self, row: int, points: Array, stride: int) -> Frame | BadFrame:
        sensor = self.recording.sensor
        if points.shape[:2] != (sensor.height, sensor.width):
            return BadFrame(row, Problem("message-unreadable", "the grid has another size than the first one", self.topic))
        points = np.ascontiguousarray(points[::stride, ::stride])
        points[np.einsum("hwi,hwi->hw", points, points) > sensor.max_range_m**2] = np.nan
        return Frame(row, int(self.recording.stamp_ns[row]), points)


def _increasing_runs(rows: list[int]) -> list[list[int]]:
    cuts = [0, *(i for i in range(1, len(rows)) if rows[i] <= rows[i - 1]), len(rows)]
    return [rows[a:b] for a, b in pairwise(cuts) if b > a]


def _open(paths: tuple[Path, ...], config: ReadConfig) -> BagScan:
    chosen = choose_topics(paths, topics_of(paths), config)
    index = index_bag(paths, chosen)
    sensor = sensor_of(index, chosen.ranges.type, config)
    poses = index.sensor_poses()
    table = PoseTable(index.stamp_ns, poses.position_m, quat_xyzw_from_rotation(poses.rotation))
    gaps = pose_gaps(index.stamp_ns, poses.known, chosen.ranges.name)
    usable = usable_rows(table.rows(np.flatnonzero(poses.known)), chosen.ranges.name)
    rows = np.flatnonzero(poses.known)[usable.index]
    if not len(rows):
        raise InputError(f"{paths[0]}: no message of {chosen.ranges.name} has a pose at its time: record odometry over the same time")
    rotation = poses.rotation[rows]
    recording = Recording(
        format="ros",
        sensor=sensor,
        stamp_ns=index.stamp_ns[rows],
        position_m=poses.position_m[rows],
        odom_from_sensor=rotation,
        down_sensor=np.full((len(rotation), 3), np.nan),
        gravity_source=GravitySource.UNKNOWN,
        problems=index.problems + gaps + usable.problems,
    )
    rings = rings_of(index.first) if chosen.ranges.type == POINT_CLOUD else None
    return BagScan(with_gravity(recording, index, config.world_up), paths, chosen.ranges.name, index.log_ns[rows], ray_table(sensor), rings)
