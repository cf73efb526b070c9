"""A walk in an empty box of known size as a `Source`, seen by an exact camera through any odometry."""

from collections.abc import Iterable, Iterator
from dataclasses import dataclass

import numpy as np

from floorplan.geometry import rotation_about_z
from floorplan.model.checks import Array
from floorplan.model.scan import Frame, GravitySource, Intrinsics, NoiseModel, Recording, Sensor, SensorKind
from floorplan.readers.base import BadFrame

BOX_M = np.array([[-4.0, 9.0], [-2.0, 3.0], [0.0, 2.6]])  # x, y, z of the room
LENS = Intrinsics(96, 72, 60.0, 60.0, 47.5, 35.5)
SENSOR = Sensor(SensorKind.CAMERA, LENS.height, LENS.width, NoiseModel(0.003, 0.0, 0.0012), 0.3, 10.0, 1 / LENS.fx, LENS)
CAMERA_LEVEL = np.array([[0.0, 0.0, 1.0], [-1.0, 0.0, 0.0], [0.0, -1.0, 0.0]])  # x right, y down, z ahead along +x of the room


@dataclass(frozen=True)
class BoxWalk:
    """A `Source`. `true_rotation (N, 3, 3)` room from sensor; `low`, `high`: heights between which surfaces give depth."""

    recording: Recording
    true_rotation: Array
    true_position_m: Array
    visible_z_m: tuple[float, float] = (-1.0, 9.0)
    range_bias_per_m: float = 0.0  # depth reads as z + bias z^2

    def frames(self, indices: Iterable[int], stride: int = 1) -> Iterator[Frame | BadFrame]:
        for i in indices:
            yield Frame(int(i), int(self.recording.stamp_ns[i]), self.frame_points(int(i))[::stride, ::stride])

    def frame_points(self, i: int) -> Array:
        """Points (H, W, 3) of frame i."""
        v, u = np.mgrid[: LENS.height, : LENS.width]
        ray = np.stack([(u - LENS.cx) / LENS.fx, (v - LENS.cy) / LENS.fy, np.ones(u.shape)], axis=-1)
        world = ray @ self.true_rotation[i].T
        with np.errstate(divide="ignore", invalid="ignore"):
            to_low, to_high = ((BOX_M[:, side] - self.true_position_m[i]) / world for side in (0, 1))
        depth = np.where(world > 0, to_high, to_low).min(axis=-1)
        noisy = depth + self.range_bias_per_m * depth**2 + np.random.default_rng(i).normal(size=depth.shape) * SENSOR.noise.sigma_m(depth)
        height = self.true_position_m[i][2] + depth * world[..., 2]
        noisy[(height < self.visible_z_m[0]) | (height > self.visible_z_m[1])] = np.nan
        return np.asarray(ray * noisy[..., None], dtype=np.float32)


def box_walk(
    odom_from_room: Array, image_roll_rad: float = 0.0, pitch_rad: float = 0.15, visible_z_m: tuple[float, float] = (-1.0, 9.0)
) -> BoxWalk:
    """40 frames at 5 Hz: 3 m along x, turning left by 60 degrees; `odom_from_room (40, 3, 3)` is the odometry's (bending) world."""
    n = len(odom_from_room)
    pitch = np.array([[1, 0, 0], [0, np.cos(pitch_rad), np.sin(pitch_rad)], [0, -np.sin(pitch_rad), np.cos(pitch_rad)]])
    turned = rotation_about_z(np.linspace(0.1, 1.15, n)) @ CAMERA_LEVEL @ pitch @ rotation_about_z(np.array(image_roll_rad))
    position = np.stack([np.linspace(-2, 1, n), np.linspace(0, 0.3, n), np.full(n, 1.5)], axis=1)
    recording = Recording(
        format="box",
        sensor=SENSOR,
        stamp_ns=(np.arange(n) * 0.2e9).astype(np.int64),
        position_m=np.einsum("nij,nj->ni", odom_from_room, position),
        odom_from_sensor=odom_from_room @ turned,
        down_sensor=np.full((n, 3), np.nan),
        gravity_source=GravitySource.UNKNOWN,
    )
    return BoxWalk(recording, turned, position, visible_z_m)


def down_error_deg(walk: BoxWalk, down_sensor: Array) -> Array:
    """Angle (N,) between `down_sensor (N, 3)` and the true one."""
    true = -walk.true_rotation[:, 2, :]
    return np.asarray(np.rad2deg(np.arcsin(np.clip(np.linalg.norm(np.cross(true, down_sensor), axis=1), 0, 1))))
