"""ARKitScenes sequences: lowres_depth/, confidence/, lowres_wide_intrinsics/*.pincam, lowres_wide.traj.

The makers' description (github.com/apple/ARKitScenes, DATA.md): files are named `<video>_<seconds>.png`, depth in millimetres, confidence 0
to 2; a .pincam is `width height fx fy cx cy`; a .traj row is `seconds`, axis-angle (rad), translation (m). Their own loader takes these for
world-to-camera in OpenCV axes and inverts them. Not checked against bytes of the set (its licence is non-commercial).
"""

from dataclasses import dataclass
from pathlib import Path

import numpy as np

from floorplan.config import ReadConfig
from floorplan.errors import InputError
from floorplan.geometry import quat_xyzw_from_rotation, rotation_from_vector
from floorplan.model.checks import Array
from floorplan.model.scan import Intrinsics, Problem
from floorplan.readers.depth_images import DepthImages
from floorplan.readers.pose_table import PoseTable, interpolate, number_from_text, stamp_ns_from_text, text_lines
from floorplan.readers.posed_images import PosedFolder, PosedImage, open_posed
from floorplan.readers.row_checks import usable_rows

TRAJECTORY, DEPTH, INTRINSICS = "lowres_wide.traj", "lowres_depth", "lowres_wide_intrinsics"
MAX_POSE_GAP_S = 0.5  # poses come ten times a second, depth too
TRAJECTORY_COLUMNS = 7


@dataclass(frozen=True)
class ArkitScenesReader:
    """See `Reader`."""

    name: str = "arkitscenes"
    description: str = "ARKitScenes sequence (raw or 3dod)"
    looks_for: str = "a folder with lowres_depth/ and lowres_wide.traj, or one with such a folder called <video>_frames"

    def sniff(self, path: Path) -> bool:
        """True for a folder with depth images and a trajectory of those names."""
        return _frames_folder(path) is not None

    def open(self, path: Path, config: ReadConfig) -> DepthImages:
        """The opened scan. Raises `InputError` without frames, poses or intrinsics."""
        folder = _frames_folder(path)
        if folder is None:
            raise InputError(f"{path}: no {DEPTH}/ with {TRAJECTORY}; download these assets of the sequence too")
        poses, problems = _trajectory(folder / TRAJECTORY)
        depth = sorted((folder / DEPTH).glob("*.png"))
        stamps = np.array([_stamp_of(file) for file in depth], dtype=np.int64)
        return open_posed(PosedFolder(self.name, path, _images(folder, depth, stamps, poses), None, True, problems=problems), config)


def _frames_folder(path: Path) -> Path | None:
    """The folder itself, or the one inside that 3dod downloads have."""
    inside: list[Path] = sorted(path.glob("*_frames")) if path.is_dir() else []
    for folder in [path, *inside]:
        if (folder / DEPTH).is_dir() and (folder / TRAJECTORY).is_file():
            return folder
    return None


def _trajectory(file: Path) -> tuple[PoseTable, tuple[Problem, ...]]:
    """Camera-to-world poses in time order."""
    cells = [line.split() for line in text_lines(file)]
    rows = np.array([[number_from_text(cell) for cell in (row + ["nan"] * TRAJECTORY_COLUMNS)[1:TRAJECTORY_COLUMNS]] for row in cells])
    rows = rows.reshape(-1, TRAJECTORY_COLUMNS - 1)
    world_from_camera = np.swapaxes(rotation_from_vector(np.nan_to_num(rows[:, :3])), 1, 2)
    position = -np.einsum("nij,nj->ni", world_from_camera, rows[:, 3:])
    quats = np.where(np.isfinite(rows).all(axis=1)[:, None], quat_xyzw_from_rotation(world_from_camera), np.nan)
    table = PoseTable(np.array([stamp_ns_from_text(row[0]) for row in cells], dtype=np.int64), position, quats)
    usable = usable_rows(table, file.name)
    if not len(usable.index):
        raise InputError(f"{file}: no pose could be read; rows must be `seconds rx ry rz tx ty tz`")
    return table.rows(usable.index), usable.problems


def _images(folder: Path, depth: list[Path], stamps: Array, poses: PoseTable) -> list[PosedImage]:
    found = interpolate(poses, stamps, MAX_POSE_GAP_S)
    lens_files = sorted((folder / INTRINSICS).glob("*.pincam"))
    if not lens_files:
        raise InputError(f"{folder / INTRINSICS}: intrinsics missing: no .pincam; download lowres_wide_intrinsics too")
    lens_stamps = np.array([_stamp_of(file) for file in lens_files], dtype=np.int64)
    nearest = [int(np.argmin(np.abs(lens_stamps - stamp))) for stamp in stamps]
    lenses = {k: _lens(lens_files[k]) for k in set(nearest)}
    images = []
    for k, file in enumerate(depth):
        pose = np.eye(4) if found.known[k] else np.full((4, 4), np.nan)
        if found.known[k]:
            pose[:3, :3], pose[:3, 3] = found.rotation[k], found.position_m[k]
        confidence = folder / "confidence" / file.name
        told = confidence if (folder / "confidence").is_dir() else None
        images.append(PosedImage(int(stamps[k]), file, pose, lenses[nearest[k]], told))
    return images


def _stamp_of(file: Path) -> int:
    """Nanoseconds of `<video>_<seconds>.png`."""
    return stamp_ns_from_text(file.name.rsplit(".", 1)[0].rsplit("_", 1)[-1])


def _lens(file: Path) -> Intrinsics:
    lines = text_lines(file)
    cells = [number_from_text(cell) for cell in lines[0].split()] if lines else []
    if len(cells) != 6 or not np.isfinite(cells).all() or min(cells[:4]) <= 0:
        raise InputError(f"{file}: intrinsics missing: not `width height fx fy cx cy`; download the file again")
    return Intrinsics(int(cells[0]), int(cells[1]), *cells[2:])
