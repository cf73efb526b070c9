"""PNG files, fast."""

from pathlib import Path

import cv2
import numpy as np

from floorplan.errors import InputError
from floorplan.model.checks import Array

FASTEST = 1  # compression level: the files are big, the writing is short
LARGEST_UINT16 = 65535


def write_png16(path: Path, values: Array) -> None:
    """`values` (H, W), rounded, as 16-bit PNG; too large ones become 0 (nothing came back)."""
    rounded = np.rint(values)
    _write(path, np.where(rounded <= LARGEST_UINT16, rounded, 0).astype(np.uint16))


def write_png8(path: Path, values: Array) -> None:
    """`values` (H, W), 0 to 255, as 8-bit PNG."""
    _write(path, values.astype(np.uint8))


def _write(path: Path, image: Array) -> None:
    if not cv2.imwrite(str(path), image, [cv2.IMWRITE_PNG_COMPRESSION, FASTEST]):
        raise InputError(f"could not write {path}; is the disk full?")
