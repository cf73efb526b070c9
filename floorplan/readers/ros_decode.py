"""ROS messages to arrays: depth images, sweeps, clouds. Lengths in metres, NaN for no return."""

from typing import Any

import numpy as np

from floorplan.errors import InputError
from floorplan.model.checks import Array
from floorplan.readers.cloud_grid import RING_FIELDS, Cloud, RingGrid, on_grid
from floorplan.readers.ros_topics import COMPRESSED_IMAGE, IMAGE, LASER_SCAN

MILLIMETRE_M = 0.001  # of 16-bit depth (REP 118)
COMPRESSED_HEADER_BYTES = 12  # config enum and two quantisation floats before the PNG
FIELD_TYPES = {1: "i1", 2: "u1", 3: "i2", 4: "u2", 5: "i4", 6: "u4", 7: "f4", 8: "f8"}  # of PointField


def stamp_ns_of(message: Any) -> int:
    """The header's stamp; both ROS versions call its parts sec and nanosec here."""
    return int(message.header.stamp.sec) * 1_000_000_000 + int(message.header.stamp.nanosec)


def depth_m(message: Any, type: str) -> Array:
    """Depth (H, W) float32 in metres of an Image or CompressedImage."""
    raw = _compressed(message) if type == COMPRESSED_IMAGE else _image(message)
    depth = raw.astype(np.float32) * np.float32(MILLIMETRE_M) if raw.dtype.kind == "u" else raw.astype(np.float32)
    depth[~(np.isfinite(depth) & (depth > 0))] = np.nan
    return np.asarray(depth)


def _image(message: Any) -> Array:
    """Rows without their padding, in the byte order of the message."""
    kind = np.dtype(np.float32 if message.encoding == "32FC1" else np.uint16).newbyteorder(">" if message.is_bigendian else "<")
    rows = _rows(message.data, message.height, message.step, message.width * kind.itemsize)
    return np.ascontiguousarray(rows[:, : message.width * kind.itemsize]).view(kind)


def _rows(data: Array, height: int, step: int, used: int) -> Array:
    """Bytes (height, step) of a message, `used` of each row. Raises `InputError` when they are fewer or more than it says."""
    found = np.frombuffer(data, dtype=np.uint8)
    if found.size != height * step or step < used:
        raise InputError(f"a message holds {found.size} bytes, not {height} rows of {step}")
    return found.reshape(height, step)


def why_unreadable(message: Any, type: str) -> str:
    """What is wrong with a range message; empty where nothing is."""
    try:
        if type == LASER_SCAN:
            return "" if len(message.ranges) and message.angle_increment else "a sweep has no ranges, or no angle between its beams"
        _ = cloud_of(message) if type not in (IMAGE, COMPRESSED_IMAGE) else depth_m(message, type)
    except (InputError, ValueError) as error:
        return str(error)
    return ""


def _compressed(message: Any) -> Array:
    import cv2

    png = np.frombuffer(message.data, dtype=np.uint8)[COMPRESSED_HEADER_BYTES:]
    image = cv2.imdecode(png, cv2.IMREAD_UNCHANGED) if png.size else None
    if image is None or image.dtype != np.uint16:
        raise InputError("a compressed depth image is no 16-bit PNG; republish it with 16UC1 depth")
    return np.asarray(image)


def sweep_points(message: Any) -> Array:
    """Points (1, N, 3) float32 of a LaserScan in its own frame."""
    ranges = np.asarray(message.ranges, dtype=np.float32)
    good = np.isfinite(ranges) & (ranges >= message.range_min) & (ranges < message.range_max)
    ranges = np.where(good, ranges, np.float32(np.nan))
    angle = message.angle_min + message.angle_increment * np.arange(len(ranges))
    points = np.stack([ranges * np.cos(angle), ranges * np.sin(angle), ranges * 0], axis=-1)
    return np.asarray(points[None], dtype=np.float32)


def cloud_of(message: Any) -> Cloud:
    """The points of a PointCloud2. Raises `InputError` for fields that cannot be read."""
    fields = {field.name: field for field in message.fields}
    names = ["x", "y", "z", *(name for name in RING_FIELDS if name in fields)][:4]
    kinds = {name: FIELD_TYPES.get(fields[name].datatype) for name in names if name in fields}
    if len(kinds) < len(names) or None in kinds.values():
        raise InputError("the point cloud has no x, y, z of 32 or 64 bit")
    order = ">" if message.is_bigendian else "<"
    formats, offsets = [order + str(kinds[n]) for n in names], [fields[n].offset for n in names]
    layout = np.dtype({"names": names, "formats": formats, "offsets": offsets, "itemsize": message.point_step})
    rows = _rows(message.data, message.height, message.row_step, message.width * message.point_step)
    grid = np.ascontiguousarray(rows[:, : message.width * message.point_step]).view(layout)
    points = np.stack([grid[n].astype(np.float32) for n in "xyz"], axis=-1)
    points[~np.isfinite(points).all(axis=-1) | (points == 0).all(axis=-1)] = np.nan
    return Cloud(points, np.asarray(grid[names[3]]) if len(names) > 3 else None)


def cloud_points(message: Any, rings: RingGrid | None) -> Array:
    """Points (H, W, 3) float32 of a PointCloud2: its own rows, or put on the grid `rings`."""
    return on_grid(cloud_of(message), rings)


def grid_points(message: Any, type: str, rays: Array, rings: RingGrid | None = None) -> Array:
    """Points (H, W, 3) float32 of any range message; `rays (H, W, 2)` x', y' of a depth image's pixels; `rings` for clouds without rows."""
    if type == LASER_SCAN:
        return sweep_points(message)
    if type not in (IMAGE, COMPRESSED_IMAGE):
        return cloud_points(message, rings)
    depth = depth_m(message, type)
    points = np.empty((*depth.shape, 3), dtype=np.float32)
    points[..., 2] = depth
    np.multiply(depth[..., None], rays, out=points[..., :2])
    return points
