"""Greyscale PNGs: what their first and last bytes say, and their pixels, in two thirds of a general image library's time."""

import struct
import zlib
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from floorplan.model.checks import Array

SIGNATURE = b"\x89PNG\r\n\x1a\n"
END = b"IEND\xaeB`\x82"
GREY = 0  # PNG colour type
HEAD_BYTES = 26  # signature, chunk length, "IHDR", width, height, bit depth, colour type
_HEADER = struct.Struct(">II5B")  # width, height, bit depth, colour type, compression, filter method, interlace
_CHUNK_FRAME_BYTES = 12  # length, name and checksum of a chunk
_WINDOW_BITS = 15  # zlib's largest, what PNG writers use
_LARGEST_BYTES = 1 << 28  # no depth image is this large; the size in a damaged head may be anything


@dataclass(frozen=True)
class PngHead:
    """What the first and last bytes of a PNG say, without decoding it."""

    width: int
    height: int
    bits: int
    whole: bool  # it ends as a PNG must: not cut off


def png_head(path: Path) -> PngHead | None:
    """Size and depth of a greyscale PNG from its first bytes; None when the file is no greyscale PNG or cannot be read."""
    try:
        with path.open("rb", buffering=0) as file:
            head = file.read(HEAD_BYTES)
            file.seek(-min(len(END), len(head)), 2)
            tail = file.read()
    except OSError:
        return None  # "cannot be read" is exactly what None says here
    if len(head) < HEAD_BYTES or not head.startswith(SIGNATURE) or head[25] != GREY:
        return None
    return PngHead(int.from_bytes(head[16:20], "big"), int.from_bytes(head[20:24], "big"), head[24], tail == END)


def read_png(path: Path) -> Array | None:
    """The image as it is stored; None where it cannot be read. Unusual PNGs take a general library's longer way."""
    try:
        image = decode_grey(path.read_bytes())
    except OSError:
        return None  # "cannot be read" is exactly what None says here
    if image is not None:
        return image
    import cv2

    return cv2.imread(str(path), cv2.IMREAD_UNCHANGED)


@dataclass(frozen=True)
class _Chunks:
    """Of one image: size, bytes per pixel, compressed rows."""

    width: int
    height: int
    pixel_bytes: int
    data: bytes


def decode_grey(content: bytes) -> Array | None:
    """The image (H, W), uint8 or uint16, of a PNG file's `content`; None unless whole, grey of 8 or 16 bit, not interlaced."""
    chunks = _chunks(content)
    if chunks is None:
        return None
    stride = chunks.width * chunks.pixel_bytes
    size = chunks.height * (stride + 1)  # each row begins with the number of its filter
    try:
        rows = zlib.decompress(chunks.data, _WINDOW_BITS, max(size, 1)) if size <= _LARGEST_BYTES else b""
    except zlib.error:
        return None  # damaged: exactly what None says here
    if len(rows) != size:
        return None
    raw = np.frombuffer(rows, np.uint8).reshape(chunks.height, stride + 1)
    from floorplan.readers.png_rows import unfiltered_8, unfiltered_16

    return unfiltered_8(raw) if chunks.pixel_bytes == 1 else unfiltered_16(raw)


def _chunks(content: bytes) -> _Chunks | None:
    if not content.startswith(SIGNATURE) or content[12:16] != b"IHDR" or len(content) < 33:
        return None
    width, height, bits, colour, _, _, interlace = _HEADER.unpack_from(content, 16)
    if colour != GREY or bits not in (8, 16) or interlace:
        return None
    at, parts = len(SIGNATURE), []
    while at + _CHUNK_FRAME_BYTES <= len(content):
        length = int.from_bytes(content[at : at + 4], "big")
        if content[at + 4 : at + 8] == b"IDAT":
            parts.append(content[at + 8 : at + 8 + length])
        at += length + _CHUNK_FRAME_BYTES
    return _Chunks(width, height, bits // 8, parts[0] if len(parts) == 1 else b"".join(parts))
