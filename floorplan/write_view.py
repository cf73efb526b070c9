"""A picture of a finished survey, or of one of its frames, as a file."""

from pathlib import Path

from floorplan.errors import UsageError
from floorplan.export import read_results
from floorplan.model.checks import Array
from floorplan.view import Scene3D, make_scene, scene_picture
from floorplan.work.disk import clear_disk_errors, new_file
from floorplan.work.folder import read_owner


def read_scene(work: Path, ceilings: bool = False) -> Scene3D:
    """The scene of a work folder. Raises `WorkFolderError` where a stage is missing."""
    read_owner(work)
    return make_scene(read_results(work), ceilings)


def write_screenshot(scene: Scene3D, path: Path, from_above: bool = False) -> None:
    """The scene as PNG. Raises UsageError where it cannot be written."""
    write_png(scene_picture(scene, from_above), path)


def write_png(picture: Array, path: Path) -> None:
    """An RGB image (H, W, 3) uint8 as PNG. Raises UsageError where there is no such folder."""
    import cv2

    if not path.parent.is_dir() or path.is_dir():
        raise UsageError(f"{path}: give the name of a file in a folder that exists")
    with clear_disk_errors(path), new_file(path) as making:
        making.write_bytes(cv2.imencode(".png", picture[..., ::-1])[1].tobytes())
