"""LZFSE streams, as iPhones compress: stored blocks here, compressed ones by the optional library `pyliblzfse`.

Format: github.com/lzfse/lzfse, `lzfse_internal.h`: blocks begin with a magic word; `bvx-` holds its bytes as they are, `bvx$` ends
the stream.
"""

import struct
import zlib

from floorplan.errors import InputError
from floorplan.readers.optional import optional_library

STORED, END, ZLIB = b"bvx-", b"bvx$", b"\x78"


def unpacked(data: bytes, size: int, where: str) -> bytes:
    """The `size` bytes that `data` holds, compressed with LZFSE or zlib or not at all. Raises `InputError` otherwise."""
    if len(data) == size and not data.startswith(b"bvx"):
        return data
    found = _zlib(data, where) if data[:1] == ZLIB else _stored(data)
    if found is None:
        found = _by_library(data, where)
    if len(found) != size:
        raise InputError(f"{where}: {len(found)} bytes where {size} belong; copy the recording again")
    return found


def _stored(data: bytes) -> bytes | None:
    """What a stream of stored blocks holds; None where a block is compressed."""
    at, parts = 0, []
    while data[at : at + 4] == STORED and len(data) >= at + 8:
        (length,) = struct.unpack_from("<I", data, at + 4)
        parts.append(data[at + 8 : at + 8 + length])
        at += 8 + length
    return b"".join(parts) if data[at : at + 4] == END else None


def _zlib(data: bytes, where: str) -> bytes:
    try:
        return zlib.decompress(data)
    except zlib.error as error:
        raise InputError(f"{where}: damaged ({error}); copy the recording again") from error


def _by_library(data: bytes, where: str) -> bytes:
    library = optional_library("liblzfse", "pyliblzfse", f"{where}: compressed with LZFSE")
    try:
        return bytes(library.decompress(data))
    except library.error as error:
        raise InputError(f"{where}: damaged ({error}); copy the recording again") from error


def stored(data: bytes) -> bytes:
    """`data` as a valid LZFSE stream of one stored block."""
    return STORED + struct.pack("<I", len(data)) + data + END
