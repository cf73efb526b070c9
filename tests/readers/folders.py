"""Tiny recordings that the reader tests write themselves: known walls seen by a known camera."""

from dataclasses import dataclass, field
from pathlib import Path

import cv2
import numpy as np

from floorplan.geometry import quat_xyzw_from_rotation, rotation_about_z
from floorplan.model.checks import Array

WIDTH, HEIGHT = 64, 48
FX, FY, CX, CY = 50.0, 52.0, 30.0, 25.0
CAMERA_LEVEL = np.array([[0.0, 0.0, 1.0], [-1.0, 0.0, 0.0], [0.0, -1.0, 0.0]])  # z-up world from a camera that looks along +x


@dataclass(frozen=True)
class Walk:
    """A walk in a z-up world: stamps from 10 s on at 10 Hz, a straight line along x, slowly turning left."""

    frames: int = 12
    stamp_s: Array = field(init=False)
    position_m: Array = field(init=False)
    rotation: Array = field(init=False)

    def __post_init__(self) -> None:
        t = np.arange(self.frames) * 0.1
        object.__setattr__(self, "stamp_s", 10.0 + t)
        object.__setattr__(self, "position_m", np.stack([0.5 * t, 0 * t, 0 * t + 1.4], axis=1))
        object.__setattr__(self, "rotation", rotation_about_z(0.2 * t) @ CAMERA_LEVEL)


def slanted_depth(width: int = WIDTH, height: int = HEIGHT) -> Array:
    """Depth (H, W) in metres that differs at every pixel, with one corner (the top left 5 x 5) without return."""
    v, u = np.mgrid[:height, :width]
    depth = 1.0 + 0.002 * u * (WIDTH / width) + 0.004 * v * (HEIGHT / height)
    depth[:5, :5] = 0.0
    return np.asarray(depth)


def write_png(path: Path, image: Array) -> None:
    path.parent.mkdir(parents=True, exist_ok=True)
    assert cv2.imwrite(str(path), image)


def write_tum(folder: Path, walk: Walk, units_per_metre: float = 5000.0, trajectory: str = "groundtruth.txt") -> Path:
    """A TUM folder of `walk` with the same depth image in every frame."""
    depth = np.round(slanted_depth() * units_per_metre).astype(np.uint16)
    for i in range(walk.frames):
        write_png(folder / "depth" / f"{i}.png", depth)
    lines = [f"{s:.6f} depth/{i}.png" for i, s in enumerate(walk.stamp_s)]
    (folder / "depth.txt").write_text("# stamp file\n" + "\n".join(lines) + "\n")
    quat = quat_xyzw_from_rotation(walk.rotation)
    rows = [f"{s:.6f} " + " ".join(f"{x:.9f}" for x in (*p, *q)) for s, p, q in zip(walk.stamp_s, walk.position_m, quat, strict=True)]
    (folder / trajectory).write_text("# stamp tx ty tz qx qy qz qw\n" + "\n".join(rows) + "\n")
    (folder / "intrinsics.json").write_text(
        f'{{"width": {WIDTH}, "height": {HEIGHT}, "fx": {FX}, "fy": {FY}, "cx": {CX}, "cy": {CY}, "depth_scale": {units_per_metre}}}'
    )
    return folder


def write_stray(folder: Path, walk: Walk, per_frame_lens: bool = False, imu: str = "rows") -> Path:
    """A Stray Scanner export of `walk`; `imu`: "rows", "header" (no rows) or "" (no file)."""
    for i in range(walk.frames):
        write_png(folder / "depth" / f"{i:06d}.png", np.round(slanted_depth() * 1000).astype(np.uint16))
        write_png(folder / "confidence" / f"{i:06d}.png", np.full((HEIGHT, WIDTH), i % 3, dtype=np.uint8))
    to_colour = 1920 / WIDTH
    lens = [FX * to_colour, FY * to_colour, (CX + 0.5) * to_colour - 0.5, (CY + 0.5) * to_colour - 0.5]
    matrix = f"{lens[0]}, 0.0, {lens[2]}\n0.0, {lens[1]}, {lens[3]}\n0.0, 0.0, 1.0"
    (folder / "camera_matrix.csv").write_text(matrix if not per_frame_lens else matrix.replace(str(lens[0]), "1.0"))
    y_up = np.array([[1.0, 0.0, 0.0], [0.0, 0.0, 1.0], [0.0, -1.0, 0.0]])  # ARKit's world from a z-up one
    rotation = y_up @ walk.rotation
    quat = quat_xyzw_from_rotation(rotation)
    lens_names = ", fx, fy, cx, cy, distortion_center_x, distortion_center_y"
    header = "timestamp, frame, x, y, z, qx, qy, qz, qw" + (lens_names if per_frame_lens else "")
    rows = []
    for i, s in enumerate(walk.stamp_s):
        cells = [f"{s:.6f}", f"{i:06d}", *(f"{x:.9f}" for x in (*(y_up @ walk.position_m[i]), *quat[i]))]
        rows.append(", ".join([*cells, *(str(x) for x in lens), "", ""] if per_frame_lens else cells))
    (folder / "odometry.csv").write_text("\n".join([header, *rows]) + "\n")
    if imu:
        down = 9.81 * np.einsum("nji,j->ni", rotation, np.array([0.0, -1.0, 0.0]))
        table = [f"{s:.6f}, {-d[1]}, {-d[0]}, {-d[2]}, 0, 0, 0" for s, d in zip(walk.stamp_s, down, strict=True)]
        imu_header = "timestamp, a_x, a_y, a_z, alpha_x, alpha_y, alpha_z"
        (folder / "imu.csv").write_text("\n".join([imu_header, *(table if imu == "rows" else [])]))
    return folder
