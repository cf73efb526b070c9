"""A box room seen by a small depth camera, rendered exactly: the truth of the front end's tests."""

from collections.abc import Iterable, Iterator
from dataclasses import dataclass, replace

import numpy as np

from floorplan.geometry import rotation_about_z
from floorplan.model.checks import Array
from floorplan.model.scan import Frame, GravitySource, IngestedScan, Intrinsics, NoiseModel, Recording, Sensor, SensorKind

ROOM_M = ((-2.0, 2.5), (-1.5, 3.0), (-1.2, 1.4))  # inner faces; the sensor walks about the origin
NOISE = NoiseModel(0.004, 0.002)
CAMERA_FROM_FORWARD = np.array([[0.0, 0.0, 1.0], [-1.0, 0.0, 0.0], [0.0, -1.0, 0.0]])  # camera axes in x forward, y left, z up


@dataclass(frozen=True)
class BoxScan:
    """A `Source` of rendered frames, with the truth: `position_m (N, 3)`, `world_from_sensor (N, 3, 3)`."""

    recording: Recording
    position_m: Array
    world_from_sensor: Array
    rays: Array
    clutter_share: float = 0.0
    no_wall: tuple[int, int] = (0, 0)  # from the first frame to before the second only floor and ceiling are within range

    @property
    def scan(self) -> IngestedScan:
        return IngestedScan(self.recording, np.arange(len(self.recording)))

    def frames(self, indices: Iterable[int], stride: int = 1) -> Iterator[Frame]:
        for index in indices:
            yield self._render(int(index), stride)

    def _render(self, index: int, stride: int) -> Frame:
        random = np.random.default_rng((7, index))
        rays = self.rays
        direction = rays @ self.world_from_sensor[index].T
        position = self.position_m[index]
        distance = np.full(direction.shape[:-1], np.inf)
        for axis in range(3):
            for wall in () if axis < 2 and self.no_wall[0] <= index < self.no_wall[1] else ROOM_M[axis]:
                with np.errstate(divide="ignore"):
                    t = (wall - position[axis]) / direction[..., axis]
                distance = np.where((t > 0) & (t < distance), t, distance)
        covered = np.zeros(distance.shape, dtype=bool)
        while covered.mean() < self.clutter_share:
            _put_clutter(distance, covered, direction, random)
        distance += random.normal(size=distance.shape) * NOISE.sigma_m(distance)
        points = (rays * distance[..., None]).astype(np.float32)
        points[distance > self.recording.sensor.max_range_m] = np.nan
        return Frame(index, int(self.recording.stamp_ns[index]), points[::stride, ::stride] if rays.shape[0] > 1 else points)


def _put_clutter(distance: Array, covered: Array, direction: Array, random: np.random.Generator) -> None:
    """A flat upright patch at a random angle before the walls, where nothing else hides it."""
    height, width = distance.shape
    i, j = int(random.integers(0, height - 20)), int(random.integers(0, width - 20))
    patch = (slice(i, i + 20), slice(j, j + 20))
    angle = random.uniform(0, 2 * np.pi)
    normal = np.array([np.cos(angle), np.sin(angle), 0.0])
    centre = direction[i + 10, j + 10] * distance[i + 10, j + 10] * random.uniform(0.5, 0.9)
    with np.errstate(divide="ignore", invalid="ignore"):
        patch_m = (centre @ normal) / (direction[patch] @ normal)
    nearer = (patch_m > 0.3) & (patch_m < distance[patch])
    distance[patch] = np.where(nearer, patch_m, distance[patch])
    covered[patch] |= nearer


def camera_scan(frames: int = 24, odometry_yaw_drift_deg: float = 0.1, turn_deg: float = 6.0, start_yaw_deg: float = 17.0) -> BoxScan:
    """Turning on the spot while stepping aside; odometry whose heading drifts by a fixed angle per frame."""
    sensor = Sensor(SensorKind.CAMERA, 120, 160, NOISE, 0.2, 8.0, 1 / 90.0, Intrinsics(160, 120, 90.0, 90.0, 79.5, 59.5))
    u, v = np.meshgrid((np.arange(160) - 79.5) / 90.0, (np.arange(120) - 59.5) / 90.0)
    rays = np.stack((u, v, np.ones_like(u)), axis=-1)
    rays /= np.linalg.norm(rays, axis=-1, keepdims=True)
    return _scan(sensor, rays, CAMERA_FROM_FORWARD, frames, odometry_yaw_drift_deg, turn_deg, start_yaw_deg)


def with_heading(box: BoxScan, heading_deg: Array) -> BoxScan:
    """The same scan under an odometry whose heading is off by `heading_deg (N,)`."""
    odom_from_world = rotation_about_z(np.radians(heading_deg))
    steps = np.einsum("nij,nj->ni", odom_from_world[:-1], np.diff(box.position_m, axis=0))
    position = np.concatenate((np.zeros((1, 3)), np.cumsum(steps, axis=0)))
    rotation = odom_from_world @ box.world_from_sensor
    return replace(box, recording=replace(box.recording, position_m=position, odom_from_sensor=rotation))


def laser_scan(frames: int = 24, odometry_yaw_drift_deg: float = 0.5, turn_deg: float = 6.0) -> BoxScan:
    """The same walk with one level sweep of 181 beams."""
    sensor = Sensor(SensorKind.LASER, 1, 181, NOISE, 0.1, 20.0, np.radians(1.0))
    beam = np.radians(np.arange(-90.0, 91.0))
    rays = np.stack((np.cos(beam), np.sin(beam), 0 * beam), axis=-1)[None]
    return _scan(sensor, rays, np.eye(3), frames, odometry_yaw_drift_deg, turn_deg, 17.0)


def _scan(
    sensor: Sensor, rays: Array, forward_from_sensor: Array, frames: int, drift_deg: float, turn_deg: float, start_yaw_deg: float
) -> BoxScan:
    k = np.arange(frames)
    yaw = np.radians(turn_deg * k)
    position = np.stack((0.4 * np.sin(k / 5), 0.3 * np.cos(k / 7) - 0.3, 0 * k), axis=1)
    world_from_sensor = rotation_about_z(yaw) @ forward_from_sensor
    odom_from_world = rotation_about_z(np.radians(start_yaw_deg + drift_deg * k))
    steps = np.diff(position, axis=0)
    odom_steps = np.einsum("nij,nj->ni", odom_from_world[:-1], steps)
    recording = Recording(
        "box",
        sensor,
        (k * 100_000_000).astype(np.int64),
        np.concatenate((np.zeros((1, 3)), np.cumsum(odom_steps, axis=0))),
        odom_from_world @ world_from_sensor,
        -world_from_sensor[:, 2, :],
        GravitySource.LEVEL,
    )
    return BoxScan(recording, position, world_from_sensor, rays)


def yaw_error_rad(estimated: Array, truth: Array) -> Array:
    """Yaw (N,) of `estimated` less the truth's, less the whole quarter turns they may differ by."""
    off = estimated @ np.swapaxes(truth, 1, 2)
    yaw = np.arctan2(off[:, 1, 0], off[:, 0, 0])
    quarter = np.pi / 2
    return np.asarray(yaw - np.round(np.median(yaw) / quarter) * quarter)
