"""Chunks of the slow stage: kept in a folder beside it until the stage is whole, under the stage's own key."""

import json
import shutil
from collections.abc import Callable
from pathlib import Path
from typing import TypeVar

from floorplan.work.disk import clear_disk_errors, new_folder
from floorplan.work.recipe import Recipe
from floorplan.work.values import load_value, save_value, write_json

T = TypeVar("T")


class ChunkStore:
    """Finished parts of one stage; parts made with another recipe are thrown away when it is opened."""

    def __init__(self, folder: Path, recipe: Recipe) -> None:
        """Open `folder` for parts made with `recipe`."""
        self.folder = folder
        with clear_disk_errors(folder):
            if folder.exists() and _key_of(folder) != recipe.key:
                shutil.rmtree(folder)
            if not folder.exists():
                folder.mkdir(parents=True)
                write_json(folder / "key.json", recipe.key)

    def has(self, name: str) -> bool:
        """True when part `name` is finished."""
        return (self.folder / name).is_dir()

    def get(self, name: str, kind: type[T], make: Callable[[], T]) -> T:
        """Part `name`: read when it is finished, otherwise made, kept and given back."""
        final = self.folder / name
        if self.has(name):
            return load_value(final, kind)
        value = make()
        with clear_disk_errors(final), new_folder(final) as making:
            save_value(making, value)
        return value


def _key_of(folder: Path) -> str:
    path = folder / "key.json"
    if not path.exists() or not (text := path.read_text("utf-8").strip()).endswith('"'):
        return ""  # killed while the folder was being made
    return str(json.loads(text))
