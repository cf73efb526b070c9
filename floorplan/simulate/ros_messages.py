"""ROS messages of a simulated scan, and the bag they are written to: the one module of the simulator that imports rosbags."""

import shutil
from pathlib import Path
from types import TracebackType
from typing import Any

import numpy as np

from floorplan.model.checks import Array
from floorplan.simulate.sensor import Pinhole

ODOM_FRAME = "odom"
NANOSECONDS = 1_000_000_000
FLOAT32, UINT16 = 7, 4  # of PointField


class Bag:
    """A bag being written; `kind` "ros1", "db3" or "mcap". Used in a `with`; the files of ROS 2 end in `folder` itself."""

    def __init__(self, folder: Path, kind: str) -> None:
        from rosbags.rosbag1 import Writer as Writer1
        from rosbags.rosbag2 import StoragePlugin
        from rosbags.rosbag2 import Writer as Writer2
        from rosbags.typesys import Stores, get_typestore

        self._folder, self._ros1 = folder, kind == "ros1"
        self._store = get_typestore(Stores.ROS1_NOETIC if self._ros1 else Stores.ROS2_HUMBLE)
        self._inside = folder / "scan"  # ROS 2 writers insist on a folder of their own
        plugin = StoragePlugin.MCAP if kind == "mcap" else StoragePlugin.SQLITE3
        self._writer: Any = (
            Writer1(folder / "scan.bag") if self._ros1 else Writer2(self._inside, version=9, storage_plugin=plugin)
        )
        self._connections: dict[str, Any] = {}

    def __enter__(self) -> "Bag":
        self._writer.open()
        return self

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None) -> None:
        self._writer.close()
        if not self._ros1:
            for file in list(self._inside.iterdir()):
                shutil.move(file, self._folder / file.name)
            self._inside.rmdir()

    def make(self, type: str, **values: Any) -> Any:
        """One message of a type named as in ROS 2."""
        return self._store.types[type](**values)

    def write(self, topic: str, message: Any, stamp_ns: int) -> None:
        """Append a message."""
        type = message.__msgtype__
        if topic not in self._connections:
            self._connections[topic] = self._writer.add_connection(topic, type, typestore=self._store)
        raw = self._store.serialize_ros1(message, type) if self._ros1 else self._store.serialize_cdr(message, type)
        self._writer.write(self._connections[topic], stamp_ns, raw)

    def header(self, stamp_ns: int, frame: str) -> Any:
        """std_msgs/Header."""
        stamp = self.make("builtin_interfaces/msg/Time", sec=stamp_ns // NANOSECONDS, nanosec=stamp_ns % NANOSECONDS)
        number = {"seq": 0} if self._ros1 else {}
        return self.make("std_msgs/msg/Header", **number, stamp=stamp, frame_id=frame)

    def depth_image(self, stamp_ns: int, frame: str, depth_mm: Array) -> Any:
        """Depth (H, W) uint16 as sensor_msgs/Image 16UC1."""
        height, width = depth_mm.shape
        shape = {"height": height, "width": width, "is_bigendian": 0, "step": 2 * width}
        data = np.ascontiguousarray(depth_mm, dtype="<u2").view(np.uint8).reshape(-1)
        return self.make("sensor_msgs/msg/Image", header=self.header(stamp_ns, frame), encoding="16UC1", data=data, **shape)

    def camera_info(self, stamp_ns: int, frame: str, lens: Pinhole) -> Any:
        """sensor_msgs/CameraInfo without distortion."""
        k = np.array([lens.fx, 0, lens.cx, 0, lens.fy, lens.cy, 0, 0, 1.0])
        p = np.array([lens.fx, 0, lens.cx, 0, 0, lens.fy, lens.cy, 0, 0, 0, 1.0, 0])
        matrices = {"d": np.zeros(5), "k": k, "r": np.eye(3).reshape(-1), "p": p}
        named = {name.upper() if self._ros1 else name: value for name, value in matrices.items()}
        region = self.make("sensor_msgs/msg/RegionOfInterest", x_offset=0, y_offset=0, height=0, width=0, do_rectify=False)
        size = {"height": lens.height, "width": lens.width, "binning_x": 0, "binning_y": 0, "roi": region}
        return self.make("sensor_msgs/msg/CameraInfo", header=self.header(stamp_ns, frame), distortion_model="plumb_bob", **size, **named)

    def cloud(self, stamp_ns: int, frame: str, points: Array, ring: Array) -> Any:
        """Points (N, 3) and their rings (N,) as sensor_msgs/PointCloud2 of one row."""
        kinds = (("x", 0, FLOAT32), ("y", 4, FLOAT32), ("z", 8, FLOAT32), ("ring", 12, UINT16))
        fields = [self.make("sensor_msgs/msg/PointField", name=n, offset=at, datatype=kind, count=1) for n, at, kind in kinds]
        rows = np.zeros(len(points), dtype=[("xyz", "<f4", 3), ("ring", "<u2")])
        rows["xyz"], rows["ring"] = points, ring
        shape = {"height": 1, "width": len(rows), "fields": fields, "is_bigendian": False, "is_dense": True}
        step = {"point_step": rows.itemsize, "row_step": rows.nbytes, "data": rows.view(np.uint8).reshape(-1)}
        return self.make("sensor_msgs/msg/PointCloud2", header=self.header(stamp_ns, frame), **shape, **step)

    def odometry(self, stamp_ns: int, frame: str, position_m: Array, quat_xyzw: Array) -> Any:
        """nav_msgs/Odometry of the sensor's own frame; speeds are left at 0."""
        vector, pair = "geometry_msgs/msg/Vector3", dict(zip("xyz", map(float, position_m), strict=True))
        point = self.make("geometry_msgs/msg/Point", **pair)
        turned = self.make("geometry_msgs/msg/Quaternion", **dict(zip("xyzw", map(float, quat_xyzw), strict=True)))
        pose = self.make("geometry_msgs/msg/Pose", position=point, orientation=turned)
        still = self.make(vector, x=0.0, y=0.0, z=0.0)
        twist = self.make("geometry_msgs/msg/Twist", linear=still, angular=still)
        posed = self.make("geometry_msgs/msg/PoseWithCovariance", pose=pose, covariance=np.zeros(36))
        moving = self.make("geometry_msgs/msg/TwistWithCovariance", twist=twist, covariance=np.zeros(36))
        head = self.header(stamp_ns, ODOM_FRAME)
        return self.make("nav_msgs/msg/Odometry", header=head, child_frame_id=frame, pose=posed, twist=moving)
