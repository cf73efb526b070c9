"""The sensor behind a bag's range messages."""

import dataclasses
from typing import Any

import numpy as np

from floorplan.config import ReadConfig
from floorplan.errors import InputError
from floorplan.model.checks import Array
from floorplan.model.scan import Intrinsics, NoiseModel, Sensor, SensorKind
from floorplan.readers.cloud_grid import RingGrid, grid_of
from floorplan.readers.depth_images import scaled_intrinsics
from floorplan.readers.noise_models import (
    DEPTH_CAMERA,
    DEPTH_CAMERA_MAX_M,
    DEPTH_CAMERA_MIN_M,
    LASER_SIGMA_M,
    LASER_SIGMA_PER_M,
    depth_camera,
    spinning_lidar,
)
from floorplan.readers.ros_decode import cloud_of, cloud_points, depth_m
from floorplan.readers.ros_index import BagIndex
from floorplan.readers.ros_topics import LASER_SCAN, POINT_CLOUD

OPTICAL = "optical"  # REP 103: frames so named have z ahead, x right, y down


def sensor_of(index: BagIndex, type: str, config: ReadConfig) -> Sensor:
    """The sensor that made the first range message. Raises `InputError` when a depth camera has no intrinsics."""
    if type == LASER_SCAN:
        return _laser(index.first)
    if type == POINT_CLOUD:
        return _cloud(index.first, OPTICAL in index.sensor_frame)
    height, width = depth_m(index.first, type).shape
    return depth_camera(_lens(index.camera_info, width, height, config))


def ray_table(sensor: Sensor) -> Array:
    """x' and y' (H, W, 2) float32 of every pixel of a pinhole camera; empty for other sensors."""
    lens = sensor.intrinsics
    if lens is None:
        return np.zeros((0, 0, 2), dtype=np.float32)
    v, u = np.mgrid[: lens.height, : lens.width]
    return np.stack([(u - lens.cx) / lens.fx, (v - lens.cy) / lens.fy], axis=-1).astype(np.float32)


def _laser(sweep: Any) -> Sensor:
    noise = NoiseModel(LASER_SIGMA_M, LASER_SIGMA_PER_M)
    beams = len(sweep.ranges)
    return Sensor(SensorKind.LASER, 1, beams, noise, float(sweep.range_min), float(sweep.range_max), abs(float(sweep.angle_increment)))


def _cloud(cloud: Any, optical: bool) -> Sensor:
    rings = rings_of(cloud)
    height, width = (rings.rings, rings.columns) if rings else (cloud.height, cloud.width)
    if optical:
        step = np.deg2rad(60.0) / width  # usual field of view: only the order of magnitude of the neighbours' angle matters
        return Sensor(SensorKind.CAMERA, height, width, DEPTH_CAMERA, DEPTH_CAMERA_MIN_M, DEPTH_CAMERA_MAX_M, float(step))
    return spinning_lidar(cloud_points(cloud, rings))


def rings_of(cloud: Any) -> RingGrid | None:
    """The grid for clouds without rows, such as `cloud`; None for those that have rows."""
    return grid_of(cloud_of(cloud))


def _lens(camera_info: Any, width: int, height: int, config: ReadConfig) -> Intrinsics:
    if config.fx:
        return Intrinsics(width, height, config.fx, config.fy or config.fx, config.cx, config.cy)
    matrix = _matrix(camera_info) if camera_info is not None else np.zeros(9)
    if not matrix[0] > 0:
        raise InputError("intrinsics missing: the bag has no CameraInfo for its depth images; set read.fx, read.fy, read.cx, read.cy")
    told = Intrinsics(int(camera_info.width) or width, int(camera_info.height) or height, matrix[0], matrix[4], matrix[2], matrix[5])
    return scaled_intrinsics(told, width, height)


def _matrix(camera_info: Any) -> Array:
    """The nine numbers of K, which ROS 1 writes in capitals and ROS 2 does not."""
    name = next(field.name for field in dataclasses.fields(camera_info) if field.name.lower() == "k")
    return np.asarray(getattr(camera_info, name), dtype=np.float64)
