"""What a folder or file that no reader recognises nearly is: for a user whose copy is not whole, or who gave another file."""

from dataclasses import dataclass
from pathlib import Path

HEAD_BYTES = 4096  # of a file that is looked at


@dataclass(frozen=True)
class _Layout:
    """The parts of one format as glob patterns; the first is found in no other format."""

    format: str
    parts: tuple[str, ...]


LAYOUTS = (
    _Layout("stray", ("odometry.csv", "depth/")),
    _Layout("stray", ("camera_matrix.csv", "odometry.csv", "depth/")),
    _Layout("tum", ("rgb.txt", "depth.txt")),
    _Layout("tum", ("odometry.txt", "depth.txt")),
    _Layout("tum", ("groundtruth.txt", "depth.txt")),
    _Layout("scanner3d", ("frame_*.json", "depth_*.png")),
    _Layout("polycam", ("keyframes/", "keyframes/depth/", "keyframes/cameras/")),
    _Layout("arkitscenes", ("lowres_depth/", "lowres_wide.traj")),
    _Layout("arkitscenes", ("lowres_wide.traj", "lowres_depth/")),
    _Layout("scannet", ("pose/", "depth/")),
    _Layout("clouds", ("*.ply", "trajectory.tum or poses.txt")),
    _Layout("clouds", ("*.pcd", "trajectory.tum or poses.txt")),
    _Layout("clouds", ("velodyne/", "trajectory.tum or poses.txt")),
)


def near_miss(path: Path) -> str:
    """A sentence on what `path` seems to be; empty where nothing can be said."""
    if path.is_file():
        return _file_words(path)
    if not any(not entry.name.startswith(".") for entry in path.iterdir()):
        return "It is empty."
    for layout in LAYOUTS:
        missing = [part for part in layout.parts if not _has(path, part)]
        if missing and layout.parts[0] not in missing:
            return f"It looks like {layout.format}, but {', '.join(missing)} {'is' if len(missing) == 1 else 'are'} missing."
    return ""


def _has(folder: Path, part: str) -> bool:
    """Whether a file, or a folder where the pattern ends in a slash, is there."""
    return any(any(entry.is_dir() or not one.endswith("/") for entry in folder.glob(one.rstrip("/"))) for one in part.split(" or "))


def _file_words(path: Path) -> str:
    with path.open("rb") as file:
        head = file.read(HEAD_BYTES)
    if not head:
        return "The file is empty."
    text = head.decode("utf-8", "ignore")
    is_text = b"\0" not in head and len(text.encode()) > len(head) - len("\U0001f600".encode())  # a character may be cut at the end
    return "It is a text file without a laser sweep in it." if is_text else ""
