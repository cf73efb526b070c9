"""Reading recordings: the table of formats, and the sniffer that picks one.

Units, axes and quaternion order are converted in the readers and nowhere else.
"""

from pathlib import Path

from floorplan.config import ReadConfig
from floorplan.errors import InputError, UsageError
from floorplan.readers.arkitscenes import ArkitScenesReader
from floorplan.readers.base import BadFrame, Reader, Source
from floorplan.readers.carmen import CarmenReader
from floorplan.readers.choices import Choice, recordings_in
from floorplan.readers.clouds import CloudsReader
from floorplan.readers.corrected import corrected
from floorplan.readers.near_misses import near_miss
from floorplan.readers.polycam import PolycamReader
from floorplan.readers.record3d import Record3dReader
from floorplan.readers.ros import RosReader
from floorplan.readers.scanner3d import Scanner3dReader
from floorplan.readers.scannet import ScanNetReader
from floorplan.readers.stray import StrayReader
from floorplan.readers.tum import TumReader

READERS: tuple[Reader, ...] = (
    StrayReader(),
    TumReader(),
    Scanner3dReader(),
    PolycamReader(),
    Record3dReader(),
    ArkitScenesReader(),
    ScanNetReader(),
    CarmenReader(),
    RosReader(),
    CloudsReader(),
)

LFS_POINTER = b"version https://git-lfs"  # what stands in place of a large file in a clone without LFS

__all__ = ["READERS", "BadFrame", "Choice", "Reader", "Source", "choices_in", "open_scan", "reader_for"]


def open_scan(path: Path, format: str | None = None, config: ReadConfig | None = None) -> Source:
    """The scan at `path`, opened by the reader called `format`, or by the first one that recognises it.

    Raises `InputError` when there is nothing at `path`, when no reader recognises it, or when the recording
    cannot be used at all; `UsageError` when there is no format of that name.
    """
    config = config or ReadConfig()
    return corrected(reader_for(path, format).open(path, config), config)


def reader_for(path: Path, format: str | None = None) -> Reader:
    """The reader called `format`, or the first one that recognises what is at `path`. Errors as in `open_scan`."""
    if not path.exists():
        raise InputError(f"{path}: no such file or folder. Give the folder that holds the recording, or the log file.")
    if path.is_file() and _is_lfs_pointer(path):
        raise InputError(f"{path}: a Git LFS pointer, not the recording itself; 'git lfs pull' brings it")
    if format is not None:
        return _named(format)
    choices = choices_in(path)
    for reader in READERS:
        if not choices and reader.sniff(path):
            return reader
    if choices:
        listed = "\n".join(f"  {choice.path} ({choice.format})" for choice in choices)
        raise InputError(f"{path}: {len(choices)} recordings, not one:\n{listed}\nGive one of them, or several of one floor.")
    sought = "\n".join(f"  {reader.name}: {reader.looks_for}" for reader in READERS)
    seems = " ".join(("the format is not recognised.", near_miss(path))).strip()
    raise InputError(f"{path}: {seems} Looked for:\n{sought}\nGive the folder that holds these, or name the format.")


def choices_in(path: Path) -> tuple[Choice, ...]:
    """The recordings in a folder that is none itself, or that holds several logs; empty where `path` is one recording."""
    reader = next((reader for reader in READERS if reader.sniff(path)), None)
    if reader is not None and not (isinstance(reader, CarmenReader) and path.is_dir()):
        return ()
    found = recordings_in(path, READERS)
    return found if reader is None or len(found) > 1 else ()


def _is_lfs_pointer(path: Path) -> bool:
    with path.open("rb") as file:
        return file.read(len(LFS_POINTER)) == LFS_POINTER


def _named(format: str) -> Reader:
    for reader in READERS:
        if reader.name == format:
            return reader
    raise UsageError(
        f"{format!r} is no format of a recording; --format is one of {', '.join(reader.name for reader in READERS)}. "
        "Leave it out to have the format recognised; what is written has options of its own, such as --dxf FILE"
    )
