"""A simulated scan as a Stray Scanner export: odometry.csv, camera_matrix.csv, depth/, confidence/, imu.csv; world up is +y."""

from pathlib import Path

import numpy as np

from floorplan.geometry import quat_xyzw_from_rotation
from floorplan.model.checks import Array
from floorplan.simulate.odometry import Odometry
from floorplan.simulate.png import write_png8, write_png16
from floorplan.simulate.raycast import NO_SURFACE
from floorplan.simulate.sensor import DepthCamera, Shot
from floorplan.simulate.stamps import seconds_text
from floorplan.simulate.walk import Walk

UNITS_PER_METRE = 1000
COLOUR_WIDTH = 1920  # camera_matrix.csv belongs to the colour image, 1920 x 1440
ARKIT_FROM_LEVEL = np.array([[1.0, 0.0, 0.0], [0.0, 0.0, 1.0], [0.0, -1.0, 0.0]])  # +z up to +y up
SURE, UNSURE, BAD = 2, 1, 0  # confidence
UNSURE_BEYOND_M = 4.0
GRAVITY_M_S2 = 9.81
ACCELERATION_NOISE_M_S2 = 0.35  # steps and hands
IMU_STEP_NS = 10_000_000


class StrayWriter:
    """Writes depth and confidence frame by frame; the tables at the end."""

    def __init__(self, folder: Path, instrument: DepthCamera, seed: int) -> None:
        self.folder, self.camera, self.seed = folder, instrument.pinhole, seed
        for name in ("depth", "confidence"):
            (folder / name).mkdir(parents=True, exist_ok=True)

    def frame(self, index: int, shot: Shot) -> None:
        """One depth image and its confidence."""
        write_png16(self.folder / "depth" / f"{index:06d}.png", shot.depth_m * UNITS_PER_METRE)
        write_png8(self.folder / "confidence" / f"{index:06d}.png", confidence_of(shot))

    def finish(self, walk: Walk, odometry: Odometry) -> None:
        """odometry.csv, camera_matrix.csv, imu.csv."""
        position = odometry.position_m @ ARKIT_FROM_LEVEL.T
        quats = quat_xyzw_from_rotation(ARKIT_FROM_LEVEL @ odometry.odom_from_camera)
        rows = ["timestamp, frame, x, y, z, qx, qy, qz, qw"]
        for index, (ns, p, q) in enumerate(zip(walk.stamp_ns.tolist(), position, quats, strict=True)):
            rows.append(f"{seconds_text(ns)}, {index:06d}, " + ", ".join(f"{value:.7f}" for value in (*p, *q)))
        _write(self.folder / "odometry.csv", rows)
        scale, camera = COLOUR_WIDTH / self.camera.width, self.camera
        # Whole numbers are pixel centres, so the middle of an image moves by half a pixel when it is scaled.
        cx, cy = (camera.cx + 0.5) * scale - 0.5, (camera.cy + 0.5) * scale - 0.5
        matrix = ((camera.fx * scale, 0.0, cx), (0.0, camera.fy * scale, cy), (0.0, 0.0, 1.0))
        _write(self.folder / "camera_matrix.csv", [", ".join(f"{value:.4f}" for value in row) for row in matrix])
        _write(self.folder / "imu.csv", self._imu_rows(walk))

    def _imu_rows(self, walk: Walk) -> list[str]:
        """Accelerometer rows: gravity in the device's axes, shaken; rates of turn are left at 0."""
        down_frames = -walk.world_from_camera[:, 2, :]
        stamps = np.arange(walk.stamp_ns[0], walk.stamp_ns[-1] + 1, IMU_STEP_NS)
        down = np.column_stack([np.interp(stamps, walk.stamp_ns, down_frames[:, k]) for k in range(3)])
        rng = np.random.default_rng([self.seed, 80])
        force = GRAVITY_M_S2 * _device_from_down(down) + ACCELERATION_NOISE_M_S2 * rng.standard_normal(down.shape)
        rows = ["timestamp, a_x, a_y, a_z, alpha_x, alpha_y, alpha_z"]
        for ns, a in zip(stamps.tolist(), force, strict=True):
            rows.append(f"{seconds_text(ns)}, " + ", ".join(f"{value:.6f}" for value in a) + ", 0.0, 0.0, 0.0")
        return rows


def confidence_of(shot: Shot) -> Array:
    """Confidence (H, W), 0 to 2, as ARKit gives it."""
    sure = np.where(shot.depth_m < UNSURE_BEYOND_M, SURE, UNSURE)
    return np.asarray(np.where(shot.surface == NO_SURFACE, BAD, sure))


def _device_from_down(down_camera: Array) -> Array:
    """Accelerations (N, 3) in units of g as the app writes them: down in camera axes is (-a_y, -a_x, -a_z)."""
    return -down_camera[:, [1, 0, 2]]


def _write(path: Path, lines: list[str]) -> None:
    path.write_text("\n".join(lines) + "\n")
