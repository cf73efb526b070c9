"""What the readers of cut bags share: a bag without its index is a row of blocks, each with topics and messages in it.

A block is the smallest piece that can be read on its own: a chunk, a record outside chunks, a page of a database.
"""

import bz2
import io
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import BinaryIO, Protocol


@dataclass(frozen=True)
class RawTopic:
    """A topic as a bag file declares it: its type's name, or the number of the `schema` that has it."""

    id: int
    name: str
    type: str = ""
    schema: int = 0


@dataclass(frozen=True)
class RawDefinition:
    """The text of a message type; `encoding` "ros1msg", "ros2msg" or "ros2idl"; `schema` its number where it has one."""

    type: str
    definition: str
    encoding: str
    schema: int = 0


@dataclass(frozen=True)
class RawMessage:
    """One whole message, not decoded; `topic` is the id of its topic in the same file."""

    topic: int
    log_ns: int
    raw: bytes


RawRecord = RawTopic | RawDefinition | RawMessage


class CutFormat(Protocol):
    """One kind of bag file, read without its index."""

    def is_cut(self, path: Path) -> bool:
        """True when the file ends before it should, or was never closed."""
        ...

    def full_size(self, path: Path) -> int:
        """Bytes that the file should have at least, as it says itself; 0 when it does not say."""
        ...

    def blocks(self, file: BinaryIO) -> Iterator[int]:
        """Where each block begins, in file order, as far as the file goes."""
        ...

    def records(self, file: BinaryIO, offset: int) -> Iterator[RawRecord]:
        """What is whole in the block at `offset`."""
        ...


def file_size(file: BinaryIO) -> int:
    """Bytes of an open file."""
    return file.seek(0, io.SEEK_END)


def unpacked(data: bytes, compression: str) -> bytes:
    """As much of a compressed chunk as its bytes give: a chunk that is cut off gives its beginning, an unknown packing nothing."""
    if compression in ("", "none"):
        return data
    try:
        return _decompressor(compression, data)
    except (OSError, RuntimeError, ValueError, EOFError):
        return b""  # nothing can be had of a damaged chunk; its messages are missing in the count


def _decompressor(compression: str, data: bytes) -> bytes:
    if compression == "bz2":
        return bz2.BZ2Decompressor().decompress(data)
    if compression == "lz4":
        import lz4.frame  # type: ignore[import-untyped]

        return bytes(lz4.frame.LZ4FrameDecompressor().decompress(data))
    if compression == "zstd":
        from backports import zstd

        try:
            return bytes(zstd.ZstdDecompressor().decompress(data))
        except zstd.ZstdError as error:
            raise ValueError("damaged zstd data") from error
    return b""
