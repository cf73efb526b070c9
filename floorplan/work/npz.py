"""Arrays in `.npz` files without pickles, the same bytes for the same arrays."""

import os
import zipfile
from collections.abc import Mapping
from pathlib import Path

import numpy as np

from floorplan.model.checks import Array

_LARGE_BYTES = 1 << 30  # an entry that may pass the two gigabytes of the plain format says so beforehand
_EPOCH = (1980, 1, 1, 0, 0, 0)  # the earliest time a zip entry can carry: no clock in the bytes


def write_npz(path: Path, arrays: Mapping[str, Array]) -> None:
    """Write `arrays` to `path`, uncompressed (compressed bytes depend on the library's version), and flush to disk."""
    with path.open("wb") as raw:
        with zipfile.ZipFile(raw, "w", zipfile.ZIP_STORED) as archive:
            for name, array in arrays.items():
                _write_entry(archive, name, np.ascontiguousarray(array) if array.ndim else np.asarray(array))
        raw.flush()
        os.fsync(raw.fileno())


def read_npz(path: Path) -> dict[str, Array]:
    """All arrays of a `.npz` file; one that would need pickles raises ValueError."""
    with np.load(path, allow_pickle=False) as archive:
        return {name: archive[name] for name in archive.files}


def _write_entry(archive: zipfile.ZipFile, name: str, array: Array) -> None:
    """One `.npy` inside the archive, a block at a time: no second copy of a large array."""
    entry = zipfile.ZipInfo(f"{name}.npy", _EPOCH)
    with archive.open(entry, "w", force_zip64=array.nbytes > _LARGE_BYTES) as file:
        np.lib.format.write_array(file, array, allow_pickle=False)
