"""Polycam raw exports: keyframes/depth, keyframes/confidence, keyframes/cameras and corrected_cameras, named by microseconds.

The makers' description (github.com/PolyCam/polyform, "Polycam's data format"): `t_ij` are the rows of camera-to-world in ARKit's axes,
world +y up; intrinsics belong to the colour image; depth in millimetres; confidence 0, 127, 255. Poses in corrected_cameras
are optimised over the whole session; large sessions have none. Not checked against bytes of the app.
"""

from dataclasses import dataclass
from pathlib import Path

from floorplan.config import ReadConfig
from floorplan.errors import InputError
from floorplan.model.scan import Intrinsics
from floorplan.readers.depth_images import DepthImages
from floorplan.readers.json_files import numbers, read_json
from floorplan.readers.pose_table import MISSING_STAMP_NS
from floorplan.readers.posed_images import PosedFolder, PosedImage, matrix_of, open_posed
from floorplan.readers.world_up import ARKIT_UP, OPENCV_FROM_ARKIT

POSE_NAMES = tuple(f"t_{row}{column}" for row in range(3) for column in range(4))
CONFIDENCE_STEP = 127  # 0 low, 127 medium, 255 high
NANOSECONDS_PER_MICROSECOND = 1000


@dataclass(frozen=True)
class PolycamReader:
    """See `Reader`."""

    name: str = "polycam"
    description: str = "Polycam raw data export (iPhone or iPad with LiDAR)"
    looks_for: str = "a folder with keyframes/cameras (or corrected_cameras) and keyframes/depth"

    def sniff(self, path: Path) -> bool:
        """True for a folder with keyframes/depth and cameras."""
        return (path / "keyframes" / "depth").is_dir() and any(folder.is_dir() for folder in _camera_folders(path))

    def open(self, path: Path, config: ReadConfig) -> DepthImages:
        """The opened scan. Raises `InputError` without frames, poses or intrinsics."""
        folder = next((folder for folder in _camera_folders(path) if any(folder.glob("*.json"))), None)
        if folder is None:
            raise InputError(f"{path / 'keyframes'}: no poses: neither corrected_cameras nor cameras holds a .json; export again")
        images = [_image(path / "keyframes", file) for file in sorted(folder.glob("*.json"))]
        return open_posed(PosedFolder(self.name, path, images, ARKIT_UP, phone=True, confidence_step=CONFIDENCE_STEP), config)


def _camera_folders(path: Path) -> tuple[Path, ...]:
    """Optimised poses first, as the makers advise."""
    return path / "keyframes" / "corrected_cameras", path / "keyframes" / "cameras"


def _image(keyframes: Path, file: Path) -> PosedImage:
    tree = read_json(file)
    pose = matrix_of(numbers(tree, POSE_NAMES, file), file)
    pose[:3, :3] = pose[:3, :3] @ OPENCV_FROM_ARKIT
    width, height, fx, fy, cx, cy = numbers(tree, ("width", "height", "fx", "fy", "cx", "cy"), file)
    stamp_ns = int(file.stem) * NANOSECONDS_PER_MICROSECOND if file.stem.isdigit() else int(MISSING_STAMP_NS)
    lens = Intrinsics(int(width), int(height), fx, fy, cx, cy)
    name = f"{file.stem}.png"
    return PosedImage(stamp_ns, keyframes / "depth" / name, pose, lens, keyframes / "confidence" / name)
