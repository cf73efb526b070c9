"""Greyscale PNGs are decoded exactly, whatever filters their writer chose; damaged and unusual ones are told apart."""

import struct
import zlib
from pathlib import Path

import cv2
import numpy as np
import pytest

from floorplan.model.checks import Array
from floorplan.readers.png import SIGNATURE, decode_grey, read_png


def depth_like(dtype: type, seed: int = 1) -> Array:
    """Slanted planes, an edge, holes and noise: what makes writers choose every kind of filter."""
    rng = np.random.default_rng(seed)
    row, column = np.mgrid[0:61, 0:83]
    image = 900 + 13 * column + 5 * row + rng.integers(0, 9, row.shape)
    image[:, 40:] += 700
    image[rng.random(row.shape) < 0.1] = 0
    return (image % (np.iinfo(dtype).max + 1)).astype(dtype)


def filtered(image: Array, kinds: Array) -> bytes:
    """A PNG whose row i is stored by filter `kinds[i]`, written out from the specification, in chunks of 100 bytes."""
    pixel = image.dtype.itemsize
    rows = image.astype(image.dtype.newbyteorder(">")).view(np.uint8).reshape(len(image), -1).astype(np.int64)
    stored = bytearray()
    for i, kind in enumerate(kinds):
        above = rows[i - 1] if i else np.zeros(rows.shape[1], np.int64)
        left, corner = np.pad(rows[i], (pixel, 0))[:-pixel], np.pad(above, (pixel, 0))[:-pixel]
        guess = left + above - corner
        distance = np.abs(np.stack((left, above, corner)) - guess)
        paeth = np.take_along_axis(np.stack((left, above, corner)), distance.argmin(axis=0)[None], axis=0)[0]
        taken = (0 * left, left, above, (left + above) // 2, paeth)[kind]
        stored += bytes([kind]) + ((rows[i] - taken) % 256).astype(np.uint8).tobytes()
    data = zlib.compress(bytes(stored))
    header = struct.pack(">II5B", image.shape[1], image.shape[0], 8 * pixel, 0, 0, 0, 0)
    parts = [(b"IHDR", header), *((b"IDAT", data[k : k + 100]) for k in range(0, len(data), 100)), (b"IEND", b"")]
    return SIGNATURE + b"".join(struct.pack(">I", len(d)) + n + d + struct.pack(">I", zlib.crc32(n + d)) for n, d in parts)


@pytest.mark.parametrize("dtype", [np.uint8, np.uint16])
def test_every_filter_is_undone_exactly(dtype: type) -> None:
    image = depth_like(dtype)
    kinds = np.arange(len(image)) % 5
    content = filtered(image, kinds)
    decoded = decode_grey(content)
    assert decoded is not None
    assert decoded.dtype == image.dtype
    assert np.array_equal(decoded, image)
    assert np.array_equal(cv2.imdecode(np.frombuffer(content, np.uint8), cv2.IMREAD_UNCHANGED), image)  # the test's own writer is right


@pytest.mark.parametrize("dtype", [np.uint8, np.uint16])
def test_images_of_another_library_are_read_the_same(tmp_path: Path, dtype: type) -> None:
    image, path = depth_like(dtype, 2), tmp_path / "image.png"
    cv2.imwrite(str(path), image, [cv2.IMWRITE_PNG_COMPRESSION, 9])
    read = read_png(path)
    assert read is not None
    assert np.array_equal(read, image)


def test_what_is_cut_damaged_or_unusual_is_left_to_the_general_library(tmp_path: Path) -> None:
    content = filtered(depth_like(np.uint16), np.zeros(61, dtype=np.int64))
    damaged = bytearray(content)
    damaged[60] ^= 255
    colour = tmp_path / "colour.png"
    cv2.imwrite(str(colour), np.dstack([depth_like(np.uint8)] * 3))
    assert decode_grey(content[:200]) is None
    assert decode_grey(bytes(damaged)) is None
    assert decode_grey(b"no image") is None
    assert decode_grey(colour.read_bytes()) is None
    read = read_png(colour)
    assert read is not None
    assert read.shape == (61, 83, 3)
    assert read_png(tmp_path / "missing.png") is None
