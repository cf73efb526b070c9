"""Which way is down in a bag: told by the setting, by convention of robots, or by an accelerometer."""

from dataclasses import replace

import numpy as np

from floorplan.model.checks import Array
from floorplan.model.scan import GravitySource, Problem, Recording, SensorKind
from floorplan.readers.imu import DISAGREEMENT_RAD, FusedUp, ImuTable, fused_up, mean_down_world
from floorplan.readers.ros_index import BagIndex
from floorplan.readers.world_up import down_in_sensor, named_axis

Z_UP = np.array([0.0, 0.0, 1.0])  # REP 103: odometry frames of robots


def with_gravity(recording: Recording, index: BagIndex, world_up: str) -> Recording:
    """Robots' odometry is level by convention; a camera's world is left to the accelerometer, or to floor and ceiling."""
    kind = recording.sensor.kind
    if world_up or kind is not SensorKind.CAMERA:
        source = GravitySource.LEVEL if kind is SensorKind.LASER else GravitySource.WORLD
        return _pointing(recording, FusedUp(named_axis(world_up) if world_up else Z_UP, source))
    if not index.imu:
        return recording
    mounting = _sensor_from_imu(index)
    if mounting is None:
        message = f"no transform from the IMU's frame {index.imu_frame or '(not named)'} to the sensor {index.sensor_frame}"
        problem = Problem("transform-missing", message, advice="the vertical is found from floor and ceiling; record /tf_static too")
        return replace(recording, problems=(*recording.problems, problem))
    return _pointing(recording, _up(_imu_table(index, mounting), recording))


def _pointing(recording: Recording, up: FusedUp) -> Recording:
    if up.source is GravitySource.UNKNOWN:
        return replace(recording, problems=recording.problems + up.problems)
    down = down_in_sensor(up.up_world, recording.odom_from_sensor)
    return replace(recording, down_sensor=down, gravity_source=up.source, problems=recording.problems + up.problems)


def _up(imu: ImuTable, recording: Recording) -> FusedUp:
    """The accelerometer's up, fused with the world's +z where that is plainly meant to be up."""
    down = mean_down_world(imu, recording.stamp_ns, recording.odom_from_sensor)
    length = np.linalg.norm(down)
    level = bool(length > 0 and -down[2] / length > np.cos(DISAGREEMENT_RAD))
    fused = fused_up(imu, recording.stamp_ns, recording.odom_from_sensor, Z_UP if level or not length > 0 else -down / length)
    if fused.source is GravitySource.IMU:
        return fused
    told = tuple(replace(p, advice="the vertical is found from floor and ceiling") for p in fused.problems)
    return FusedUp(fused.up_world, GravitySource.UNKNOWN, told)


def _imu_table(index: BagIndex, sensor_from_imu: Array) -> ImuTable:
    """Forces turned to point down at rest, in the sensor's axes."""
    stamps = np.array([reading.stamp_ns for reading in index.imu], dtype=np.int64)
    force = np.array([reading.force_m_s2 for reading in index.imu])
    return ImuTable(stamps, -force @ sensor_from_imu.T).usable()


def _sensor_from_imu(index: BagIndex) -> Array | None:
    """Rotation (3, 3), None where no transforms connect both. Both are fixed to the same body: any time will do."""
    from_imu, from_sensor = index.tree.ancestors(index.imu_frame), index.tree.ancestors(index.sensor_frame)
    common = next((frame for frame in from_imu if frame in from_sensor), None)
    if common is None:
        return None
    when = index.stamp_ns[len(index.stamp_ns) // 2 :][:1]
    common_from_imu = index.tree.lookup(common, index.imu_frame, when)
    common_from_sensor = index.tree.lookup(common, index.sensor_frame, when)
    return np.asarray(common_from_sensor.rotation[0].T @ common_from_imu.rotation[0])
