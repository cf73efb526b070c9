"""A simulated scan as a Record3D recording: a ZIP of metadata, depth and confidence; LZFSE streams of stored blocks."""

import json
import zipfile
from pathlib import Path

import numpy as np

from floorplan.geometry import quat_xyzw_from_rotation
from floorplan.readers.lzfse import stored
from floorplan.simulate.odometry import Odometry
from floorplan.simulate.sensor import DepthCamera, Shot
from floorplan.simulate.walk import Walk
from floorplan.simulate.write_posed import ARKIT_FROM_OPENCV, colour_lens
from floorplan.simulate.write_stray import ARKIT_FROM_LEVEL, confidence_of

FILE_NAME = "scan.r3d"


class Record3dWriter:
    """Writes the archive as the frames come, the metadata at the end."""

    def __init__(self, folder: Path, instrument: DepthCamera) -> None:
        folder.mkdir(parents=True, exist_ok=True)
        self.camera = instrument.pinhole
        self._archive = zipfile.ZipFile(folder / FILE_NAME, "w", zipfile.ZIP_DEFLATED)

    def frame(self, index: int, shot: Shot) -> None:
        """Depth in metres and confidence."""
        self._write(f"rgbd/{index}.depth", stored(shot.depth_m.astype("<f4").tobytes()))
        self._write(f"rgbd/{index}.conf", stored(confidence_of(shot).astype(np.uint8).tobytes()))

    def finish(self, walk: Walk, odometry: Odometry) -> None:
        """The metadata."""
        lens = colour_lens(self.camera)
        quats = quat_xyzw_from_rotation(ARKIT_FROM_LEVEL @ odometry.odom_from_camera @ ARKIT_FROM_OPENCV)
        poses = np.column_stack((quats, odometry.position_m @ ARKIT_FROM_LEVEL.T))
        tree = {
            "w": lens.width, "h": lens.height, "dw": self.camera.width, "dh": self.camera.height,
            "K": [lens.fx, 0, 0, 0, lens.fy, 0, lens.cx, lens.cy, 1],
            "poses": poses.round(9).tolist(),
            "frameTimestamps": ((walk.stamp_ns - walk.stamp_ns[0]) / 1e9).tolist(),
        }  # fmt: skip
        self._write("metadata", json.dumps(tree).encode())
        self._archive.close()

    def _write(self, name: str, data: bytes) -> None:
        """Under one date, so that the same scan is the same bytes."""
        self._archive.writestr(zipfile.ZipInfo(name), data)
