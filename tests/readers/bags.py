"""Tiny ROS bags that the tests write themselves with rosbags' writers."""

from collections.abc import Collection
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import cv2
import numpy as np
from rosbags.rosbag1 import Writer as Writer1
from rosbags.rosbag2 import StoragePlugin
from rosbags.rosbag2 import Writer as Writer2
from rosbags.typesys import Stores, get_typestore

from floorplan.geometry import quat_xyzw_from_rotation
from floorplan.model.checks import Array
from tests.readers.folders import CX, CY, FX, FY, HEIGHT, WIDTH, Walk, slanted_depth

KINDS = ("bag", "db3", "mcap")
BASE_FROM_CAMERA = np.array([[0.0, 0.0, 1.0], [-1.0, 0.0, 0.0], [0.0, -1.0, 0.0]])
CAMERA_ON_BASE_M = np.array([0.1, 0.0, 0.4])


@dataclass
class Bag:
    """Messages to write; `kind` of KINDS."""

    kind: str
    written: list[tuple[str, str, int, Any]] = field(default_factory=list)
    unreadable_definition: bool = False  # as of a service's events, which no parser of messages understands

    def __post_init__(self) -> None:
        self.store = get_typestore(Stores.ROS1_NOETIC if self.kind == "bag" else Stores.ROS2_HUMBLE)

    def make(self, type: str, **values: Any) -> Any:
        return self.store.types[type](**values)

    def header(self, stamp_s: float, frame: str) -> Any:
        stamp_ns = round(stamp_s * 1e9)
        stamp = self.make("builtin_interfaces/msg/Time", sec=stamp_ns // 10**9, nanosec=stamp_ns % 10**9)
        number = {"seq": 0} if self.kind == "bag" else {}
        return self.make("std_msgs/msg/Header", **number, stamp=stamp, frame_id=frame)

    def add(self, topic: str, type: str, stamp_s: float, delay_s: float = 0.02, **values: Any) -> None:
        """One message, written `delay_s` after its stamp."""
        self.written.append((topic, type, round((stamp_s + delay_s) * 1e9), self.make(type, **values)))

    def write(self, path: Path) -> Path:
        """A .bag file, or the folder of a ROS 2 bag."""
        if self.kind == "bag":
            path = path.with_suffix(".bag")
            writer: Any = Writer1(path)
        else:
            writer = Writer2(path, version=9, storage_plugin=StoragePlugin.SQLITE3 if self.kind == "db3" else StoragePlugin.MCAP)
        with writer:
            connections: dict[str, Any] = {}
            if self.unreadable_definition:
                told = {"msgdef": "A a\n" + "=" * 80 + "\nMSG: test_msgs/srv/A\n!", "rihs01": "RIHS01_" + "0" * 64}
                writer.add_connection("/service/_service_event", "test_msgs/srv/A_Event", **told)
            for topic, type, log_ns, value in sorted(self.written, key=lambda row: row[2]):
                if topic not in connections:
                    connections[topic] = writer.add_connection(topic, type, typestore=self.store)
                raw = self.store.serialize_ros1(value, type) if self.kind == "bag" else self.store.serialize_cdr(value, type)
                writer.write(connections[topic], log_ns, raw)
        return path

    # --- messages of a walk ---

    def add_depth(self, walk: Walk, encoding: str = "16UC1", topic: str = "/camera/depth/image") -> None:
        """The same slanted depth image at every stamp, with CameraInfo beside it."""
        depth = slanted_depth()
        image = np.round(depth * 1000).astype(np.uint16) if encoding == "16UC1" else depth.astype(np.float32)
        data = np.pad(image.view(np.uint8).reshape(HEIGHT, -1), ((0, 0), (0, 8)))  # rows may be padded
        for stamp in walk.stamp_s.tolist():
            head = self.header(stamp, "camera_optical")
            shape = {"height": HEIGHT, "width": WIDTH, "is_bigendian": 0, "step": data.shape[1]}
            self.add(topic, "sensor_msgs/msg/Image", stamp, header=head, encoding=encoding, data=data.reshape(-1), **shape)
            self._add_camera_info(stamp, topic.rsplit("/", 1)[0] + "/camera_info")

    def add_compressed_depth(self, walk: Walk) -> None:
        """The same as PNG behind 12 bytes of header."""
        png = cv2.imencode(".png", np.round(slanted_depth() * 1000).astype(np.uint16))[1].reshape(-1)
        data = np.concatenate([np.zeros(12, dtype=np.uint8), png])
        for stamp in walk.stamp_s.tolist():
            head = self.header(stamp, "camera_optical")
            what = {"format": "16UC1; compressedDepth", "data": data}
            self.add("/d/compressedDepth", "sensor_msgs/msg/CompressedImage", stamp, header=head, **what)
            self._add_camera_info(stamp, "/d/camera_info")

    def _add_camera_info(self, stamp: float, topic: str) -> None:
        matrices = {"d": np.zeros(5), "k": np.array([FX, 0, CX, 0, FY, CY, 0, 0, 1.0]), "r": np.eye(3).reshape(-1), "p": np.zeros(12)}
        named = {name.upper() if self.kind == "bag" else name: value for name, value in matrices.items()}
        region = self.make("sensor_msgs/msg/RegionOfInterest", x_offset=0, y_offset=0, height=0, width=0, do_rectify=False)
        size = {"height": HEIGHT, "width": WIDTH, "binning_x": 0, "binning_y": 0, "roi": region, "distortion_model": "plumb_bob"}
        self.add(topic, "sensor_msgs/msg/CameraInfo", stamp, header=self.header(stamp, "camera_optical"), **size, **named)

    def add_sweeps(self, walk: Walk, ranges: Array) -> None:
        """The same sweep at every stamp."""
        fan = {"angle_min": -1.0, "angle_max": 1.0, "angle_increment": 2.0 / (len(ranges) - 1), "time_increment": 0.0, "scan_time": 0.1}
        for stamp in walk.stamp_s.tolist():
            limits = {"range_min": 0.1, "range_max": 20.0, "ranges": ranges.astype(np.float32), "intensities": np.zeros(0, np.float32)}
            self.add("/scan", "sensor_msgs/msg/LaserScan", stamp, header=self.header(stamp, "laser"), **fan, **limits)

    def add_cloud(self, walk: Walk, points: Array) -> None:
        """The same organised cloud (H, W, 3) at every stamp, 16 bytes a point."""
        height, width = points.shape[:2]
        data = np.zeros((height, width, 4), dtype=np.float32)
        data[..., :3] = points
        fields = [self.make("sensor_msgs/msg/PointField", name=n, offset=4 * i, datatype=7, count=1) for i, n in enumerate("xyz")]
        shape = {"height": height, "width": width, "fields": fields, "is_bigendian": False, "is_dense": False}
        steps = {"point_step": 16, "row_step": 16 * width, "data": data.view(np.uint8).reshape(-1)}
        for stamp in walk.stamp_s.tolist():
            self.add("/points", "sensor_msgs/msg/PointCloud2", stamp, header=self.header(stamp, "lidar"), **shape, **steps)

    def add_loose_cloud(self, walk: Walk, points: Array, ring: Array | None) -> None:
        """The same points (N, 3) in one row at every stamp, with their rings (N,) where given."""
        kinds = [("x", "<f4"), ("y", "<f4"), ("z", "<f4"), *([("ring", "<u2")] if ring is not None else [])]
        rows = np.zeros(len(points), dtype=kinds)
        for axis, name in enumerate("xyz"):
            rows[name] = points[:, axis]
        if ring is not None:
            rows["ring"] = ring
        types = {"<f4": 7, "<u2": 4}
        fields = [
            self.make("sensor_msgs/msg/PointField", name=name, offset=4 * at, datatype=types[kind], count=1)
            for at, (name, kind) in enumerate(kinds)
        ]
        shape = {"height": 1, "width": len(rows), "fields": fields, "is_bigendian": False, "is_dense": True}
        steps = {"point_step": rows.itemsize, "row_step": rows.nbytes, "data": rows.view(np.uint8).reshape(-1)}
        for stamp in walk.stamp_s.tolist():
            self.add("/points", "sensor_msgs/msg/PointCloud2", stamp, header=self.header(stamp, "lidar"), **shape, **steps)

    def add_odometry(self, walk: Walk, child: str = "camera_optical", topic: str = "/odom", skip: Collection[int] = ()) -> None:
        """Poses of `walk` for the frame `child`, a tenth of a second between; rows of `skip` left out."""
        rows = zip(walk.stamp_s.tolist(), walk.position_m, quat_xyzw_from_rotation(walk.rotation), strict=True)
        for stamp, position, quat in (pose for row, pose in enumerate(rows) if row not in skip):
            posed = self.make("geometry_msgs/msg/PoseWithCovariance", pose=self._pose(position, quat), covariance=np.zeros(36))
            zero = self.make("geometry_msgs/msg/Vector3", x=0.0, y=0.0, z=0.0)
            twist = self.make("geometry_msgs/msg/Twist", linear=zero, angular=zero)
            moving = self.make("geometry_msgs/msg/TwistWithCovariance", twist=twist, covariance=np.zeros(36))
            head = self.header(stamp, "odom")
            self.add(topic, "nav_msgs/msg/Odometry", stamp, 0.01, header=head, child_frame_id=child, pose=posed, twist=moving)

    def add_poses(self, walk: Walk, type: str) -> None:
        """Poses of `walk` as another message type."""
        for stamp, position, quat in zip(walk.stamp_s.tolist(), walk.position_m, quat_xyzw_from_rotation(walk.rotation), strict=True):
            head, pose = self.header(stamp, "odom"), self._pose(position, quat)
            if type == "PoseStamped":
                what = {"pose": pose}
            elif type == "PoseWithCovarianceStamped":
                what = {"pose": self.make("geometry_msgs/msg/PoseWithCovariance", pose=pose, covariance=np.zeros(36))}
            else:
                moved = self.make("geometry_msgs/msg/Vector3", **dict(zip("xyz", map(float, position), strict=True)))
                turned = self.make("geometry_msgs/msg/Transform", translation=moved, rotation=pose.orientation)
                what = {"child_frame_id": "camera_optical", "transform": turned}
            self.add("/pose", f"geometry_msgs/msg/{type}", stamp, 0.01, header=head, **what)

    def add_imu(self, walk: Walk, force: Array) -> None:
        """Specific force (N, 3) m/s^2 in the axes of the frame `imu`."""
        zero = self.make("geometry_msgs/msg/Vector3", x=0.0, y=0.0, z=0.0)
        level = self.make("geometry_msgs/msg/Quaternion", x=0.0, y=0.0, z=0.0, w=1.0)
        unknown = {f"{name}_covariance": np.zeros(9) for name in ("orientation", "angular_velocity", "linear_acceleration")}
        for stamp, row in zip(walk.stamp_s.tolist(), force.tolist(), strict=True):
            pushed = self.make("geometry_msgs/msg/Vector3", **dict(zip("xyz", row, strict=True)))
            what = {"orientation": level, "angular_velocity": zero, "linear_acceleration": pushed, **unknown}
            self.add("/imu", "sensor_msgs/msg/Imu", stamp, header=self.header(stamp, "imu"), **what)

    def _pose(self, position: Array, quat: Array) -> Any:
        where = self.make("geometry_msgs/msg/Point", **dict(zip("xyz", map(float, position), strict=True)))
        turned = self.make("geometry_msgs/msg/Quaternion", **dict(zip("xyzw", map(float, quat), strict=True)))
        return self.make("geometry_msgs/msg/Pose", position=where, orientation=turned)

    def add_tf(self, parent: str, child: str, stamp_s: float, position: Array, rotation: Array, topic: str = "/tf") -> None:
        """One transform."""
        where = self.make("geometry_msgs/msg/Vector3", **dict(zip("xyz", map(float, position), strict=True)))
        quat = quat_xyzw_from_rotation(rotation)
        turned = self.make("geometry_msgs/msg/Quaternion", **dict(zip("xyzw", map(float, quat), strict=True)))
        transform = self.make("geometry_msgs/msg/Transform", translation=where, rotation=turned)
        head = self.header(stamp_s, parent)
        edge = self.make("geometry_msgs/msg/TransformStamped", header=head, child_frame_id=child, transform=transform)
        self.add(topic, "tf2_msgs/msg/TFMessage", stamp_s, 0.01, transforms=[edge])

    def add_mounting(self, stamp_s: float) -> None:
        """The static transform from base to camera."""
        self.add_tf("base_link", "camera_optical", stamp_s, CAMERA_ON_BASE_M, BASE_FROM_CAMERA, "/tf_static")


def base_walk(walk: Walk) -> tuple[Array, Array]:
    """Positions (N, 3) and rotations (N, 3, 3) of the base that carries the camera of `walk`."""
    rotation = walk.rotation @ BASE_FROM_CAMERA.T
    return walk.position_m - np.einsum("nij,j->ni", rotation, CAMERA_ON_BASE_M), rotation
