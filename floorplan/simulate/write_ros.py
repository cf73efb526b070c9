"""A simulated scan as a ROS bag: depth images with CameraInfo, or clouds of a spinning LiDAR, and odometry, in the order of time."""

import tempfile
from pathlib import Path

import numpy as np

from floorplan.geometry import quat_xyzw_from_rotation
from floorplan.model.checks import Array
from floorplan.simulate.lidar import SpinningLidar
from floorplan.simulate.odometry import Odometry
from floorplan.simulate.ros_messages import Bag
from floorplan.simulate.sensor import DepthCamera, Shot
from floorplan.simulate.walk import Walk

CAMERA_FRAME, LIDAR_FRAME = "camera_optical", "lidar"
UNITS_PER_METRE = 1000
POSE_DECIMALS = 7  # as in text formats: the same scan is the same in all of them


class RosWriter:
    """Keeps the ranges in a temporary file until the odometry is known: a bag holds both in the order of time."""

    def __init__(self, folder: Path, instrument: DepthCamera | SpinningLidar, kind: str) -> None:
        self.folder, self.instrument, self.kind = folder, instrument, kind
        folder.mkdir(parents=True, exist_ok=True)
        self._kept = tempfile.TemporaryFile()  # noqa: SIM115 - closed in finish

    def frame(self, index: int, shot: Shot) -> None:
        """One shot's ranges."""
        del index
        exact = np.float32 if isinstance(self.instrument, SpinningLidar) else np.uint16
        scale = 1 if exact is np.float32 else UNITS_PER_METRE
        values = shot.depth_m * scale
        self._kept.write(np.ascontiguousarray(np.round(values) if scale > 1 else values, dtype=exact).tobytes())

    def finish(self, walk: Walk, odometry: Odometry) -> None:
        """The bag."""
        self._kept.seek(0)
        quats = quat_xyzw_from_rotation(odometry.odom_from_camera).round(POSE_DECIMALS)
        frame = LIDAR_FRAME if isinstance(self.instrument, SpinningLidar) else CAMERA_FRAME
        with Bag(self.folder, self.kind) as bag:
            for index, stamp_ns in enumerate(walk.stamp_ns.tolist()):
                pose = odometry.position_m[index].round(POSE_DECIMALS), quats[index]
                bag.write("/odom", bag.odometry(stamp_ns, frame, *pose), stamp_ns)
                self._ranges(bag, stamp_ns)
        self._kept.close()

    def _ranges(self, bag: Bag, stamp_ns: int) -> None:
        if isinstance(self.instrument, SpinningLidar):
            ranges = self._next(self.instrument.shape, np.dtype(np.float32))
            back = ranges > 0
            points = self.instrument.rays.reshape(*ranges.shape, 3)[back] * ranges[back][:, None]
            bag.write("/points", bag.cloud(stamp_ns, LIDAR_FRAME, points, np.nonzero(back)[0]), stamp_ns)
            return
        lens = self.instrument.pinhole
        bag.write("/camera/depth/camera_info", bag.camera_info(stamp_ns, CAMERA_FRAME, lens), stamp_ns)
        depth = self._next((lens.height, lens.width), np.dtype(np.uint16))
        bag.write("/camera/depth/image", bag.depth_image(stamp_ns, CAMERA_FRAME, depth), stamp_ns)

    def _next(self, shape: tuple[int, int], kind: "np.dtype[np.generic]") -> Array:
        count = shape[0] * shape[1]
        return np.asarray(np.frombuffer(self._kept.read(count * kind.itemsize), dtype=kind).reshape(shape))
