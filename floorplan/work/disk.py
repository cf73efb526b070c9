"""Writing that leaves either the whole thing or nothing, and says so when the disk is full."""

import errno
import os
import shutil
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from floorplan.errors import UsageError, WorkFolderError

_FULL = (errno.ENOSPC, errno.EDQUOT)
_FORBIDDEN = (errno.EACCES, errno.EPERM, errno.EROFS)


@contextmanager
def clear_disk_errors(path: Path) -> Iterator[None]:
    """Turn "disk full" and "not allowed" while writing `path` into errors that say what to do."""
    try:
        yield
    except OSError as error:
        if error.errno in _FULL:
            raise WorkFolderError(
                f"the disk is full: {path} could not be written; everything finished before it is kept: "
                "free some space and give the same command again"
            ) from error
        if error.errno in _FORBIDDEN:
            raise WorkFolderError(f"{path} cannot be written ({error.strerror}); choose another place") from error
        raise


def need_folder(folder: Path) -> None:
    """Make `folder` where there is none. Raises `UsageError` for a path that is a file, or where no folder can be made."""
    try:
        with clear_disk_errors(folder):
            folder.mkdir(parents=True, exist_ok=True)
    except (FileExistsError, NotADirectoryError) as error:
        raise UsageError(f"{folder} is a file, or lies under one; a folder is needed there: give another place") from error
    except OSError as error:
        raise UsageError(f"{folder}: no folder can be made there ({error.strerror}); give another place") from error


@contextmanager
def new_folder(final: Path) -> Iterator[Path]:
    """A folder to fill that becomes `final` in one step at the end, replacing what was there; removed on any error."""
    making, old = final.with_name(f".{final.name}.new"), final.with_name(f".{final.name}.old")
    for left_behind in (making, old):
        if left_behind.exists():
            shutil.rmtree(left_behind)
    try:
        making.mkdir(parents=True)
        yield making
        if final.exists():
            os.rename(final, old)
        os.rename(making, final)
    except BaseException:
        shutil.rmtree(making, ignore_errors=True)
        raise
    shutil.rmtree(old, ignore_errors=True)


@contextmanager
def new_file(final: Path) -> Iterator[Path]:
    """A path to write that becomes `final` in one step at the end; removed on any error."""
    making = final.with_name(f".{final.name}.new")
    try:
        yield making
        os.replace(making, final)
    except BaseException:
        making.unlink(missing_ok=True)
        raise


def size_bytes(folder: Path) -> int:
    """Bytes of all files below `folder`."""
    return sum(path.stat().st_size for path in folder.rglob("*") if path.is_file())
