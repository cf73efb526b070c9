"""One pass over a bag: stamps of the ranges, poses, transforms, intrinsics; no ranges are kept."""

from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from floorplan.errors import InputError
from floorplan.model.checks import Array
from floorplan.model.scan import Problem
from floorplan.readers.ros_bag import bag_problems, messages
from floorplan.readers.ros_decode import stamp_ns_of, why_unreadable
from floorplan.readers.ros_topics import CAMERA_INFO, IMU, OLD_TF, TF, ChosenTopics
from floorplan.readers.ros_transforms import Poses, TimedPose, TransformTree, poses_at, table_of

STATIC_TOPIC = "/tf_static"


@dataclass(frozen=True)
class Force:
    """One reading of an accelerometer: specific force in the IMU's axes, pointing up at rest."""

    stamp_ns: int
    force_m_s2: tuple[float, float, float]


@dataclass(frozen=True)
class BagIndex:
    """What the pass found, N range messages: `stamp_ns (N,)` of their headers, `log_ns (N,)` when they were written.

    `first` is the first range message and `camera_info` the first of its kind, None without; `poses` of frame
    `posed_frame` (empty where the message does not say) from the pose topic.
    """

    stamp_ns: Array
    log_ns: Array
    sensor_frame: str
    first: Any
    camera_info: Any
    poses: list[TimedPose]
    posed_frame: str
    tree: TransformTree
    problems: tuple[Problem, ...]
    imu: tuple[Force, ...] = ()
    imu_frame: str = ""

    def sensor_poses(self) -> Poses:
        """Pose of the sensor at each range message, in the frame of the odometry."""
        if not self.poses:
            return self.tree.lookup(self.tree.fixed_frame(self.sensor_frame), self.sensor_frame, self.stamp_ns)
        moved = poses_at(table_of(self.poses), self.stamp_ns)
        if self.posed_frame not in self.tree.ancestors(self.sensor_frame):
            return moved
        return moved.times(self.tree.lookup(self.posed_frame, self.sensor_frame, self.stamp_ns))


def index_bag(paths: tuple[Path, ...], chosen: ChosenTopics) -> BagIndex:
    """The index of a bag. Raises `InputError` when not one range message can be read."""
    gathered = _Gathered(chosen)
    problems = bag_problems(paths)
    try:
        for message in messages(paths, gathered.topics()):
            gathered.add(message.topic, message.type, message.log_ns, message.value)
    except InputError as error:
        problems += (Problem("file-damaged", str(error), str(paths[0]), advice="what was read before is used"),)
    if gathered.first is None:
        why = f": {gathered.why}" if gathered.why else ""
        raise InputError(f"{paths[0]}: no frames: no message of {chosen.ranges.name} can be read{why}")
    return gathered.index(problems)


class _Gathered:
    """Collects while the bag is read."""

    def __init__(self, chosen: ChosenTopics) -> None:
        self.chosen = chosen
        self.stamps: list[int] = []
        self.logs: list[int] = []
        self.first: Any = None
        self.why = ""
        self.camera_info: Any = None
        self.poses: list[TimedPose] = []
        self.posed_frame = ""
        self.tree = TransformTree()
        self.imu: list[Force] = []
        self.imu_frame = ""

    def topics(self) -> set[str]:
        """Names of the topics to read."""
        others = [t.name for t in (self.chosen.camera_info, self.chosen.pose, self.chosen.imu) if t]
        return {self.chosen.ranges.name, *others, *self.chosen.tf}

    def add(self, topic: str, type: str, log_ns: int, value: Any) -> None:
        """One message."""
        if topic == self.chosen.ranges.name:
            self.stamps.append(stamp_ns_of(value))
            self.logs.append(log_ns)
            if self.first is None and not (why := why_unreadable(value, type)):
                self.first = value
            elif self.first is None:
                self.why = why
        elif type == CAMERA_INFO:
            self.camera_info = value if self.camera_info is None else self.camera_info
        elif type == IMU:
            force = value.linear_acceleration
            self.imu.append(Force(stamp_ns_of(value), (float(force.x), float(force.y), float(force.z))))
            self.imu_frame = value.header.frame_id.lstrip("/")
        elif type in (TF, OLD_TF):
            for edge in value.transforms:
                pose = _transform_pose(edge)
                self.tree.add(edge.header.frame_id, edge.child_frame_id, pose, topic == STATIC_TOPIC)
        else:
            self._add_pose(type, value)

    def _add_pose(self, type: str, value: Any) -> None:
        if type.endswith("/TransformStamped"):
            self.posed_frame = value.child_frame_id.lstrip("/")
            self.poses.append(_transform_pose(value))
            return
        if type.endswith("/Odometry"):
            self.posed_frame = value.child_frame_id.lstrip("/")
        pose = value.pose if type.endswith("/PoseStamped") else value.pose.pose
        self.poses.append(_timed(value, pose.position, pose.orientation))

    def index(self, problems: tuple[Problem, ...]) -> BagIndex:
        """Everything gathered; a sensor whose mounting is unknown is a problem."""
        frame = self.first.header.frame_id.lstrip("/")
        if self.poses and self.posed_frame != frame and self.posed_frame not in self.tree.ancestors(frame):
            message = f"no transform from {self.posed_frame or 'the posed frame (not named)'} to the sensor {frame}"
            advice = "the poses are taken for the sensor's own; record /tf_static too"
            problems += (Problem("transform-missing", message, advice=advice),)
        stamps, logs = np.array(self.stamps, dtype=np.int64), np.array(self.logs, dtype=np.int64)
        seen = (self.first, self.camera_info, self.poses, self.posed_frame, self.tree)
        return BagIndex(stamps, logs, frame, *seen, problems, tuple(self.imu), self.imu_frame)


def _transform_pose(edge: Any) -> TimedPose:
    return _timed(edge, edge.transform.translation, edge.transform.rotation)


def _timed(message: Any, position: Any, rotation: Any) -> TimedPose:
    return TimedPose(
        stamp_ns_of(message),
        (float(position.x), float(position.y), float(position.z)),
        (float(rotation.x), float(rotation.y), float(rotation.z), float(rotation.w)),
    )
