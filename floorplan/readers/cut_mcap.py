"""MCAP files without their summary, record after record. Format: mcap.dev/spec."""

import struct
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import BinaryIO

from floorplan.readers.cut_records import RawDefinition, RawMessage, RawRecord, RawTopic, file_size, unpacked

MAGIC = b"\x89MCAP0\r\n"
OP_SCHEMA, OP_CHANNEL, OP_MESSAGE, OP_CHUNK, OP_DATA_END = 3, 4, 5, 6, 15
HEAD_BYTES = 9  # opcode and length
CHUNK_HEAD_BYTES = 28  # two times, uncompressed size, checksum; the compression's name follows


@dataclass(frozen=True)
class CutMcap:
    """See `CutFormat`. Topics name their type by the number of a schema."""

    def is_cut(self, path: Path) -> bool:
        """True without the magic bytes at the end."""
        with path.open("rb") as file:
            file.seek(max(0, file_size(file) - len(MAGIC)))
            return file.read() != MAGIC

    def full_size(self, path: Path) -> int:
        """The file does not say."""
        del path
        return 0

    def blocks(self, file: BinaryIO) -> Iterator[int]:
        """Chunks, and schemas, channels and messages outside chunks."""
        at, size = len(MAGIC), file_size(file)
        while at + HEAD_BYTES <= size:
            file.seek(at)
            op, length = struct.unpack("<BQ", file.read(HEAD_BYTES))
            if op in (0, OP_DATA_END):
                return
            if op in (OP_SCHEMA, OP_CHANNEL, OP_MESSAGE, OP_CHUNK):
                yield at
            at += HEAD_BYTES + length

    def records(self, file: BinaryIO, offset: int) -> Iterator[RawRecord]:
        """Schemas, channels and messages of a chunk, or the one record there."""
        file.seek(offset)
        op, length = struct.unpack("<BQ", file.read(HEAD_BYTES))
        body = file.read(length)
        if op != OP_CHUNK:
            yield from _told(op, body, len(body) == length)
            return
        name_end = CHUNK_HEAD_BYTES + 4 + int.from_bytes(body[CHUNK_HEAD_BYTES : CHUNK_HEAD_BYTES + 4], "little")
        data, at = unpacked(body[name_end + 8 :], body[CHUNK_HEAD_BYTES + 4 : name_end].decode(errors="replace")), 0
        while at + HEAD_BYTES <= len(data):
            op, length = struct.unpack_from("<BQ", data, at)
            at += HEAD_BYTES
            yield from _told(op, data[at : at + length], at + length <= len(data))
            at += length


def _told(op: int, body: bytes, whole: bool) -> Iterator[RawRecord]:
    if not whole:
        return
    if op == OP_MESSAGE:
        channel, _sequence, log_ns = struct.unpack_from("<HIQ", body)
        yield RawMessage(channel, log_ns, body[22:])  # channel, sequence, log time, publish time
    elif op == OP_SCHEMA:
        name, encoding, data = _texts(body, 2, 3)
        yield RawDefinition(name, data, encoding, schema=int.from_bytes(body[:2], "little"))
    elif op == OP_CHANNEL:
        channel, schema = struct.unpack_from("<HH", body)
        yield RawTopic(channel, _texts(body, 4, 1)[0], schema=schema)


def _texts(body: bytes, at: int, count: int) -> list[str]:
    """Texts behind 32-bit lengths."""
    found = []
    for _ in range(count):
        end = at + 4 + int.from_bytes(body[at : at + 4], "little")
        found.append(body[at + 4 : end].decode(errors="replace"))
        at = end
    return found
