"""ROS 1 and ROS 2 bags: depth images with CameraInfo, LaserScan, organised PointCloud2; poses from Odometry, PoseStamped or tf."""

from collections.abc import Iterable, Iterator
from dataclasses import dataclass, replace
from itertools import pairwise
from pathlib import Path

import numpy as np

from floorplan.config import ReadConfig
from floorplan.errors import InputError
from floorplan.geometry import quat_xyzw_from_rotation
from floorplan.model.checks import Array
from floorplan.model.scan import Frame, GravitySource, Problem, Recording, Sensor, SensorKind
from floorplan.readers.base import BadFrame
from floorplan.readers.pose_table import PoseTable
from floorplan.readers.ros_bag import bag_paths, messages, topics_of
from floorplan.readers.ros_decode import grid_points, stamp_ns_of
from floorplan.readers.ros_index import index_bag
from floorplan.readers.ros_sensor import ray_table, sensor_of
from floorplan.readers.ros_topics import choose_topics
from floorplan.readers.row_checks import usable_rows
from floorplan.readers.world_up import down_in_sensor, named_axis

Z_UP = np.array([0.0, 0.0, 1.0])  # REP 103: odometry frames of robots


@dataclass(frozen=True)
class RosReader:
    """See `Reader`."""

    name: str = "ros"
    description: str = "ROS 1 or ROS 2 bag (.bag, .db3, .mcap, or a folder with metadata.yaml)"
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
                points = grid_points(message.value, message.type, self.rays)
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
    chosen = choose_topics(paths, topics_of(paths), config.range_topic, config.pose_topic)
    index = index_bag(paths, chosen)
    sensor = sensor_of(index, chosen.ranges.type, config)
    poses = index.sensor_poses()
    table = PoseTable(index.stamp_ns, poses.position_m, np.where(poses.known[:, None], quat_xyzw_from_rotation(poses.rotation), np.nan))
    usable = usable_rows(table, chosen.ranges.name)
    if not len(usable.index):
        raise InputError(f"{paths[0]}: no message of {chosen.ranges.name} has a pose at its time: record odometry over the same time")
    rotation = poses.rotation[usable.index]
    recording = Recording(
        format="ros",
        sensor=sensor,
        stamp_ns=index.stamp_ns[usable.index],
        position_m=poses.position_m[usable.index],
        odom_from_sensor=rotation,
        down_sensor=np.full((len(rotation), 3), np.nan),
        gravity_source=GravitySource.UNKNOWN,
        problems=index.problems + usable.problems,
    )
    recording = _with_gravity(recording, sensor, config.world_up)
    return BagScan(recording, paths, chosen.ranges.name, index.log_ns[usable.index], ray_table(sensor))


def _with_gravity(recording: Recording, sensor: Sensor, world_up: str) -> Recording:
    """Robots' odometry is level by convention; a camera's world is left to be tested against floor and ceiling."""
    if sensor.kind is SensorKind.CAMERA and not world_up:
        return recording
    down = down_in_sensor(named_axis(world_up) if world_up else Z_UP, recording.odom_from_sensor)
    source = GravitySource.LEVEL if sensor.kind is SensorKind.LASER else GravitySource.WORLD
    return replace(recording, down_sensor=down, gravity_source=source)
