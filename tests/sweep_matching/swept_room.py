"""A level laser among straight walls, rendered exactly, with any odometry: the truth of the matching tests."""

from collections.abc import Iterable, Iterator
from dataclasses import dataclass

import numpy as np

from floorplan.geometry import rotation_about_z
from floorplan.model.checks import Array
from floorplan.model.scan import Frame, GravitySource, NoiseModel, Recording, Sensor, SensorKind

ANGLE_RAD = np.radians(np.arange(-90.0, 90.0, 1.0))
SIGMA_M = 0.01


@dataclass(frozen=True)
class SweptRoom:
    """A `Source` of sweeps seen from `pose (N, 3)` (the truth) among `wall (W, 4)` (x1, y1, x2, y2)."""

    recording: Recording
    pose: Array
    wall: Array

    def frames(self, indices: Iterable[int], stride: int = 1) -> Iterator[Frame]:
        for index in indices:
            random = np.random.default_rng((3, index))
            angle = ANGLE_RAD[::stride]
            distance = _ranges(self.pose[index], angle, self.wall) + SIGMA_M * random.standard_normal(len(angle))
            points = distance[:, None] * np.column_stack((np.cos(angle), np.sin(angle), np.zeros(len(angle))))
            yield Frame(int(index), int(self.recording.stamp_ns[index]), points[None].astype(np.float32))


def swept_room(pose: Array, odometry: Array, wall: Array) -> SweptRoom:
    """Sweeps seen from `pose (N, 3)` x, y, yaw, recorded with `odometry (N, 3)`."""
    count = len(pose)
    sensor = Sensor(SensorKind.LASER, 1, len(ANGLE_RAD), NoiseModel(SIGMA_M), 0.05, 40.0, float(np.radians(1.0)))
    recording = Recording(
        "test",
        sensor,
        np.arange(count) * 200_000_000,
        np.column_stack((odometry[:, :2], np.zeros(count))),
        rotation_about_z(odometry[:, 2]),
        np.tile((0.0, 0.0, -1.0), (count, 1)),
        GravitySource.LEVEL,
    )
    return SweptRoom(recording, pose, wall)


def box(x1: float, y1: float, x2: float, y2: float) -> Array:
    """The four sides (4, 4) of a rectangle."""
    return np.array([(x1, y1, x2, y1), (x2, y1, x2, y2), (x2, y2, x1, y2), (x1, y2, x1, y1)])


def _ranges(pose: Array, angle_rad: Array, wall: Array) -> Array:
    """Distance (B,) along each beam to the nearest wall; NaN where there is none."""
    heading = pose[2] + angle_rad
    ray = np.column_stack((np.cos(heading), np.sin(heading)))[:, None]
    start, along = wall[:, :2] - pose[:2], wall[:, 2:] - wall[:, :2]
    with np.errstate(divide="ignore", invalid="ignore"):
        cross = ray[..., 0] * along[:, 1] - ray[..., 1] * along[:, 0]
        distance = (start[:, 0] * along[:, 1] - start[:, 1] * along[:, 0]) / cross
        part = (start[:, 0] * ray[..., 1] - start[:, 1] * ray[..., 0]) / cross
    hit = (distance > 0) & (part >= 0) & (part <= 1)
    nearest = np.where(hit, distance, np.inf).min(axis=1)
    return np.asarray(np.where(np.isfinite(nearest), nearest, np.nan))
