"""3D Scanner App exports, "All Data": frame_00000.json, depth_00000.png, conf_00000.png and, of some frames, frame_00000.jpg.

`cameraPoseARFrame` is camera-to-world, row by row, in ARKit's axes (camera y up, looking along -z; world +y up). `intrinsics` belong
to the colour image, whose size follows from `projectionMatrix`; depth is in millimetres, confidence 0, 1, 2.
Checked against a recording of app version 1.9.7.
"""

from dataclasses import dataclass
from decimal import Decimal
from pathlib import Path
from typing import Any

import numpy as np

from floorplan.config import ReadConfig
from floorplan.model.scan import Intrinsics
from floorplan.readers.depth_images import DepthImages
from floorplan.readers.json_files import number_list, read_json
from floorplan.readers.pose_table import MISSING_STAMP_NS
from floorplan.readers.posed_images import PosedFolder, PosedImage, matrix_of, open_posed
from floorplan.readers.world_up import ARKIT_UP, OPENCV_FROM_ARKIT

COLOUR_WIDTH, COLOUR_HEIGHT = 1920, 1440  # where the projection matrix is missing


@dataclass(frozen=True)
class Scanner3dReader:
    """See `Reader`."""

    name: str = "scanner3d"
    description: str = "3D Scanner App export, all data (iPhone or iPad with LiDAR)"
    looks_for: str = "a folder with frame_00000.json and depth_00000.png"

    def sniff(self, path: Path) -> bool:
        """True for a folder with frames and depth images of that naming."""
        return path.is_dir() and any(path.glob("frame_*.json")) and any(path.glob("depth_*.png"))

    def open(self, path: Path, config: ReadConfig) -> DepthImages:
        """The opened scan. Raises `InputError` without frames, poses or intrinsics."""
        images = [_image(path, file) for file in sorted(path.glob("frame_*.json"))]
        return open_posed(PosedFolder(self.name, path, images, ARKIT_UP, phone=True), config)


def _image(path: Path, file: Path) -> PosedImage:
    tree = read_json(file)
    number = file.stem.removeprefix("frame_")
    pose = matrix_of(number_list(tree, "cameraPoseARFrame", 16, file), file)
    pose[:3, :3] = pose[:3, :3] @ OPENCV_FROM_ARKIT
    time = tree.get("time")
    stamp_ns = int(Decimal(repr(time)).scaleb(9)) if isinstance(time, int | float) and np.isfinite(time) else int(MISSING_STAMP_NS)
    return PosedImage(stamp_ns, path / f"depth_{number}.png", pose, _lens(tree, file), path / f"conf_{number}.png")


def _lens(tree: dict[str, Any], file: Path) -> Intrinsics:
    fx, _, cx, _, fy, cy, *_ = number_list(tree, "intrinsics", 9, file)
    if "projectionMatrix" not in tree:
        return Intrinsics(COLOUR_WIDTH, COLOUR_HEIGHT, fx, fy, cx, cy)
    projection = number_list(tree, "projectionMatrix", 16, file)  # 2 fx / width, 2 fy / height on its diagonal
    return Intrinsics(round(2 * fx / projection[0]), round(2 * fy / projection[5]), fx, fy, cx, cy)
