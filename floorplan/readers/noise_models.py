"""Standard deviations of range readings, from the literature, where a recording does not say its own."""

import numpy as np

from floorplan.model.checks import Array
from floorplan.model.scan import Intrinsics, NoiseModel, Sensor, SensorKind

# Structured light: sigma_z grows with the square of depth (Khoshelham & Elberink 2012, Sensors 12; the coefficients are those
# of Nguyen, Izadi & Lovell 2012, 3DIMPVT, rounded up from 0.4 m to 0). Also an upper bound for time-of-flight cameras up to 4 m.
DEPTH_CAMERA = NoiseModel(constant_m=0.0015, quadratic_per_m=0.0019)
DEPTH_CAMERA_MIN_M = 0.3
DEPTH_CAMERA_MAX_M = 10.0  # a disparity step is 25 cm there

# Phones with LiDAR, against laser scanners: 1-3 cm within 5 m, growing with range (Luetzenburg et al. 2021, Sci. Rep. 11; Teo &
# Yang 2023, Open Geosciences 15). The depth is densified by a network from a few hundred points, so neighbours err together.
PHONE_LIDAR = NoiseModel(constant_m=0.006, linear=0.004)
PHONE_LIDAR_MIN_M = 0.2
PHONE_LIDAR_MAX_M = 6.5  # the LiDAR's range is 5 m; beyond it the confidence falls to 0 and the values end near 6.3 m

# Spinning LiDARs: about 2 cm (Velodyne VLP-16 data sheet: up to +-3 cm; Glennie, Kusari & Facchin 2016, ISPRS Archives XL-3/W4)
SPINNING_LIDAR = NoiseModel(constant_m=0.02)
SPINNING_LIDAR_MIN_M = 0.4
SPINNING_LIDAR_MAX_M = 100.0

# SICK LMS 200: 5 mm statistical, up to 15 mm systematic; the spot grows with range (data sheet; Ye & Borenstein 2002, ICRA)
LASER_SIGMA_M = 0.01
LASER_SIGMA_PER_M = 0.0005


def spinning_lidar(points: Array) -> Sensor:
    """A spinning LiDAR of unknown make, by one of its clouds (rings, columns, 3).

    Rings lie further apart than columns: the angle between rays is the one that gives a pixel its true solid angle.
    """
    rings, columns = points.shape[:2]
    up = np.arctan2(points[..., 2], np.hypot(points[..., 0], points[..., 1]))
    seen = up[np.isfinite(up)]
    spread = float(np.ptp(seen)) if len(seen) else 0.0
    column_step = 2 * np.pi / columns
    ring_step = spread / max(rings - 1, 1) or column_step
    step = float(np.sqrt(ring_step * column_step))
    return Sensor(SensorKind.LIDAR, rings, columns, SPINNING_LIDAR, SPINNING_LIDAR_MIN_M, SPINNING_LIDAR_MAX_M, step)


def phone_lidar(lens: Intrinsics) -> Sensor:
    """The LiDAR of an iPhone or iPad."""
    return Sensor(SensorKind.CAMERA, lens.height, lens.width, PHONE_LIDAR, PHONE_LIDAR_MIN_M, PHONE_LIDAR_MAX_M, 1.0 / lens.fx, lens)


def depth_camera(lens: Intrinsics) -> Sensor:
    """A depth camera of unknown make."""
    return Sensor(SensorKind.CAMERA, lens.height, lens.width, DEPTH_CAMERA, DEPTH_CAMERA_MIN_M, DEPTH_CAMERA_MAX_M, 1.0 / lens.fx, lens)
