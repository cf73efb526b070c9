"""Several recordings in one folder: what they are, for a user who gave the folder above them."""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from floorplan.readers.base import Reader

LEVELS = 2  # of folders looked into
LOOKED_AT = 300  # entries of a folder: more is no folder of recordings
WORK_SUFFIX = ".floorplan"  # of work folders, which hold no recordings


@dataclass(frozen=True)
class Choice:
    """One recording below the folder: where, and the name of the reader that recognises it."""

    path: Path
    format: str


def recordings_in(folder: Path, readers: Sequence[Reader], levels: int = LEVELS) -> tuple[Choice, ...]:
    """What the readers recognise in `folder`, and in folders inside it that are no recordings themselves."""
    found: list[Choice] = []
    for path in _entries(folder) if folder.is_dir() else []:
        reader = next((reader for reader in readers if reader.sniff(path)), None)
        if reader is not None:
            found.append(Choice(path, reader.name))
        elif path.is_dir() and levels > 1:
            found += recordings_in(path, readers, levels - 1)
    return tuple(found)


def _entries(folder: Path) -> list[Path]:
    names = [path for path in sorted(folder.iterdir()) if not path.name.startswith(".") and path.suffix != WORK_SUFFIX]
    return names[:LOOKED_AT]
