"""A simulated spinning LiDAR as a folder of clouds with a trajectory: PLY, PCD with rings, or KITTI's layout."""

from pathlib import Path

import numpy as np

from floorplan.geometry import quat_xyzw_from_rotation
from floorplan.model.checks import Array
from floorplan.simulate.lidar import SpinningLidar
from floorplan.simulate.odometry import Odometry
from floorplan.simulate.sensor import Shot
from floorplan.simulate.stamps import seconds_text
from floorplan.simulate.walk import Walk

KINDS = ("ply", "pcd", "kitti")


class CloudsWriter:
    """Writes clouds numbered; renames them by stamp at the end (not KITTI's)."""

    def __init__(self, folder: Path, instrument: SpinningLidar, kind: str) -> None:
        self.instrument, self.kind, self.folder = instrument, kind, folder
        self.clouds = folder / ("velodyne" if kind == "kitti" else "clouds")
        self.clouds.mkdir(parents=True, exist_ok=True)
        self._written: list[Path] = []

    def frame(self, index: int, shot: Shot) -> None:
        """One cloud: the points that came back."""
        back = shot.depth_m > 0
        points = (self.instrument.rays.reshape(*shot.depth_m.shape, 3)[back] * shot.depth_m[back][:, None]).astype("<f4")
        path = self.clouds / f"{index:06d}.{'bin' if self.kind == 'kitti' else self.kind}"
        if self.kind == "kitti":
            path.write_bytes(np.column_stack((points, np.zeros(len(points), "<f4"))).tobytes())
        elif self.kind == "ply":
            path.write_bytes(ply_bytes(points))
        else:
            path.write_bytes(pcd_bytes(points, np.nonzero(back)[0]))
        self._written.append(path)

    def finish(self, walk: Walk, odometry: Odometry) -> None:
        """The trajectory, and the clouds' names."""
        stamps = [seconds_text(ns) for ns in walk.stamp_ns.tolist()]
        if self.kind == "kitti":
            rows = np.concatenate((odometry.odom_from_camera, odometry.position_m[:, :, None]), axis=2).reshape(-1, 12)
            (self.folder / "poses.txt").write_text("".join(" ".join(f"{value:.9e}" for value in row) + "\n" for row in rows))
            (self.folder / "times.txt").write_text("".join(f"{stamp}\n" for stamp in stamps))
            return
        numbers = np.column_stack((odometry.position_m, quat_xyzw_from_rotation(odometry.odom_from_camera)))
        lines = [f"{stamp} " + " ".join(f"{value:.7f}" for value in row) for stamp, row in zip(stamps, numbers, strict=True)]
        (self.folder / "trajectory.tum").write_text("\n".join(lines) + "\n")
        for path, stamp in zip(self._written, stamps, strict=True):
            path.rename(path.with_name(f"{stamp}{path.suffix}"))


def ply_bytes(points: Array) -> bytes:
    """Points (N, 3) float32 as a binary PLY file."""
    fields = "".join(f"property float {name}\n" for name in "xyz")
    return f"ply\nformat binary_little_endian 1.0\nelement vertex {len(points)}\n{fields}end_header\n".encode() + points.tobytes()


def pcd_bytes(points: Array, ring: Array) -> bytes:
    """Points (N, 3) float32 with the number of their ring (N,) as a binary PCD file."""
    table = np.empty(len(points), dtype=[("x", "<f4"), ("y", "<f4"), ("z", "<f4"), ("ring", "<u2")])
    for k, name in enumerate("xyz"):
        table[name] = points[:, k]
    table["ring"] = ring
    head = "VERSION 0.7\nFIELDS x y z ring\nSIZE 4 4 4 2\nTYPE F F F U\nCOUNT 1 1 1 1\n"
    size = f"WIDTH {len(points)}\nHEIGHT 1\nVIEWPOINT 0 0 0 1 0 0 0\nPOINTS {len(points)}\nDATA binary\n"
    return (head + size).encode() + table.tobytes()
