"""ScanNet-style folders: depth/<n>.png (millimetres), pose/<n>.txt (4 x 4, camera-to-world), intrinsic/intrinsic_depth.txt.

As the ScanNet SensReader exports (github.com/ScanNet/ScanNet): OpenCV camera axes; poses of -inf where tracking was lost; the
world is not level. There are no stamps: frames are counted at SCANNET_HZ. Not checked against bytes of the set (its licence asks
for a signature).
"""

from dataclasses import dataclass
from pathlib import Path

import numpy as np

from floorplan.config import ReadConfig
from floorplan.errors import InputError
from floorplan.model.checks import Array
from floorplan.model.scan import Intrinsics
from floorplan.readers.depth_files import look_at_depth_files
from floorplan.readers.depth_images import DepthImages
from floorplan.readers.pose_table import number_from_text, text_lines
from floorplan.readers.posed_images import PosedFolder, PosedImage, matrix_of, open_posed

SCANNET_HZ = 30  # of the structure sensor the set was recorded with; numbers left out keep their time
LENS_FILES = ("intrinsic/intrinsic_depth.txt", "intrinsics/intrinsic_depth.txt", "intrinsic_depth.txt")


@dataclass(frozen=True)
class ScanNetReader:
    """See `Reader`."""

    name: str = "scannet"
    description: str = "ScanNet-style folder"
    looks_for: str = "a folder with depth/, pose/ with .txt files, and intrinsic/intrinsic_depth.txt"

    def sniff(self, path: Path) -> bool:
        """True for a folder with depth/ and pose/0.txt or the like."""
        return (path / "depth").is_dir() and (path / "pose").is_dir() and any((path / "pose").glob("*.txt"))

    def open(self, path: Path, config: ReadConfig) -> DepthImages:
        """The opened scan. Raises `InputError` without frames, poses or intrinsics."""
        numbered = sorted((int(file.stem), file) for file in (path / "depth").glob("*.png") if file.stem.isdigit())
        if not numbered:
            raise InputError(f"{path / 'depth'}: no frames: no images called <number>.png")
        lens = _lens(path, [file for _, file in numbered], config)
        images = [PosedImage(_stamp_ns(n), file, _pose(path / "pose" / f"{file.stem}.txt"), lens) for n, file in numbered]
        return open_posed(PosedFolder(self.name, path, images, None, phone=False), config)


def _stamp_ns(number: int) -> int:
    return round(number * 1_000_000_000 / SCANNET_HZ)


def _pose(file: Path) -> Array:
    """NaN where the file is missing or says that tracking was lost."""
    if not file.is_file():
        return np.full((4, 4), np.nan)
    return matrix_of([number_from_text(cell) for line in text_lines(file) for cell in line.split()], file)


def _lens(path: Path, depth: list[Path], config: ReadConfig) -> Intrinsics:
    """Of the depth image, whose size its own file says."""
    files = look_at_depth_files(depth, path / "depth")
    if config.fx:
        return Intrinsics(files.width, files.height, config.fx, config.fy or config.fx, config.cx, config.cy)
    file = next((path / name for name in LENS_FILES if (path / name).is_file()), None)
    if file is None:
        raise InputError(f"{path}: intrinsics missing: no {LENS_FILES[0]}; set read.fx, read.fy, read.cx, read.cy")
    cells = [number_from_text(cell) for line in text_lines(file) for cell in line.split()]
    side = {9: 3, 16: 4}.get(len(cells), 0)
    if not side or not np.isfinite(cells).all() or cells[0] <= 0:
        raise InputError(f"{file}: intrinsics missing: not a 3 x 3 or 4 x 4 camera matrix; set read.fx, read.fy, read.cx, read.cy")
    return Intrinsics(files.width, files.height, cells[0], cells[side + 1], cells[2], cells[side + 2])
