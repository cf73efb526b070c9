"""A simulated scan as a TUM RGB-D folder: depth.txt, 16-bit PNGs, odometry.txt, intrinsics.json; world up is +z."""

import json
from pathlib import Path

import numpy as np

from floorplan.geometry import quat_xyzw_from_rotation
from floorplan.simulate.odometry import Odometry
from floorplan.simulate.png import write_png16
from floorplan.simulate.sensor import DepthCamera, Shot
from floorplan.simulate.stamps import seconds_text
from floorplan.simulate.walk import Walk

DEPTH_SCALE = 1000  # PNG values per metre


class TumWriter:
    """Writes depth frame by frame; the small files at the end."""

    def __init__(self, folder: Path, instrument: DepthCamera, seed: int) -> None:
        del seed  # nothing random in this format
        self.folder, self.pinhole, self.accuracy = folder, instrument.pinhole, instrument.accuracy
        (folder / "depth").mkdir(parents=True, exist_ok=True)

    def frame(self, index: int, shot: Shot) -> None:
        """One depth image."""
        write_png16(self.folder / "depth" / f"{index:06d}.png", shot.depth_m * DEPTH_SCALE)

    def finish(self, walk: Walk, odometry: Odometry) -> None:
        """depth.txt, odometry.txt, intrinsics.json."""
        stamps = [seconds_text(ns) for ns in walk.stamp_ns.tolist()]
        names = [f"{stamp} depth/{index:06d}.png" for index, stamp in enumerate(stamps)]
        _write(self.folder / "depth.txt", ["# timestamp filename", *names])
        write_odometry(self.folder, walk, odometry)
        camera = self.pinhole
        facts = {"width": camera.width, "height": camera.height, "fx": camera.fx, "fy": camera.fy, "cx": camera.cx, "cy": camera.cy}
        errors = {"range_scale_sigma": self.accuracy.scale_sigma, "range_bias_sigma": self.accuracy.bias_sigma_m}
        (self.folder / "intrinsics.json").write_text(json.dumps({**facts, "depth_scale": DEPTH_SCALE, **errors}, indent=1) + "\n")


def write_odometry(folder: Path, walk: Walk, odometry: Odometry) -> None:
    """odometry.txt."""
    numbers = np.column_stack((odometry.position_m, quat_xyzw_from_rotation(odometry.odom_from_camera)))
    stamps = [seconds_text(ns) for ns in walk.stamp_ns.tolist()]
    rows = [f"{stamp} " + " ".join(f"{value:.7f}" for value in row) for stamp, row in zip(stamps, numbers, strict=True)]
    _write(folder / "odometry.txt", ["# timestamp tx ty tz qx qy qz qw", *rows])


def _write(path: Path, lines: list[str]) -> None:
    path.write_text("\n".join(lines) + "\n")
