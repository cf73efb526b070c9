"""ROS 1 bags without their index, chunk by chunk. Format: ROS wiki, "Bags/Format/2.0"."""

import struct
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import BinaryIO

from floorplan.readers.cut_records import RawDefinition, RawMessage, RawRecord, RawTopic, file_size, unpacked

MAGIC = b"#ROSBAG V2.0\n"
OP_MESSAGE, OP_HEADER, OP_CHUNK, OP_CONNECTION = 2, 3, 5, 7
LENGTH_BYTES = 4


@dataclass(frozen=True)
class _Record:
    """A record's fields, its data (as much as there is), and where the next one begins."""

    fields: dict[bytes, bytes]
    data: bytes
    whole: bool
    end: int

    @property
    def op(self) -> int:
        return self.fields.get(b"op", b"\0")[0]

    def number(self, name: bytes) -> int:
        """A little-endian whole number; 0 where the field is missing."""
        return int.from_bytes(self.fields.get(name, b""), "little")


@dataclass(frozen=True)
class CutRosbag1:
    """See `CutFormat`."""

    def is_cut(self, path: Path) -> bool:
        """True when the index is missing or not whole."""
        with path.open("rb") as file:
            size, head = file_size(file), _record_at(file, len(MAGIC))
            if head is None or head.op != OP_HEADER:
                return True
            at, left = head.number(b"index_pos"), head.number(b"conn_count") + head.number(b"chunk_count")
            while at and left and at < size and (record := _record_at(file, at)) is not None and record.whole:
                at, left = record.end, left - 1
        return at == 0 or left > 0

    def full_size(self, path: Path) -> int:
        """Where the index should begin."""
        with path.open("rb") as file:
            head = _record_at(file, len(MAGIC))
        return head.number(b"index_pos") if head is not None and head.op == OP_HEADER else 0

    def blocks(self, file: BinaryIO) -> Iterator[int]:
        """Chunks, and records outside chunks."""
        at = len(MAGIC)
        while (record := _record_at(file, at, with_data=False)) is not None:
            if record.op in (OP_CHUNK, OP_CONNECTION, OP_MESSAGE):
                yield at
            at = record.end

    def records(self, file: BinaryIO, offset: int) -> Iterator[RawRecord]:
        """Connections and messages of a chunk, or the one record there."""
        block = _record_at(file, offset)
        if block is None:
            return
        if block.op != OP_CHUNK:
            yield from _told(block)
            return
        data, at = unpacked(block.data, block.fields.get(b"compression", b"none").decode()), 0
        while (record := _parsed(data, at)) is not None:
            yield from _told(record)
            at = record.end


def _told(record: _Record) -> Iterator[RawRecord]:
    if not record.whole:
        return
    if record.op == OP_MESSAGE:
        seconds, nanoseconds = struct.unpack("<II", record.fields[b"time"])
        yield RawMessage(record.number(b"conn"), seconds * 1_000_000_000 + nanoseconds, record.data)
    elif record.op == OP_CONNECTION:
        about = _fields(record.data)
        type = about.get(b"type", b"").decode()
        if "/msg/" not in type:
            type = type.replace("/", "/msg/")
        definition = about.get(b"message_definition", b"").decode(errors="replace")
        yield RawDefinition(type, definition, "ros1msg")
        yield RawTopic(record.number(b"conn"), record.fields[b"topic"].decode(), type)


def _record_at(file: BinaryIO, at: int, with_data: bool = True) -> _Record | None:
    """The record at a place of the file; None where not even its header is there."""
    file.seek(at)
    length = int.from_bytes(file.read(LENGTH_BYTES), "little")
    head = file.read(length + LENGTH_BYTES) if 0 < length < 1 << 20 else b""  # a header is some hundred bytes
    if len(head) < length + LENGTH_BYTES or not head:
        return None
    fields, size = _fields(head[:length]), int.from_bytes(head[length:], "little")
    data = file.read(size) if with_data else b""
    return _Record(fields, data, len(data) == size, at + LENGTH_BYTES + len(head) + size)


def _parsed(data: bytes, at: int) -> _Record | None:
    """The record at a place of an unpacked chunk; None behind the last one."""
    length = int.from_bytes(data[at : at + LENGTH_BYTES], "little")
    start = at + 2 * LENGTH_BYTES + length
    if length == 0 or start > len(data):
        return None
    size = int.from_bytes(data[start - LENGTH_BYTES : start], "little")
    fields = _fields(data[at + LENGTH_BYTES : start - LENGTH_BYTES])
    return _Record(fields, data[start : start + size], start + size <= len(data), start + size)


def _fields(data: bytes) -> dict[bytes, bytes]:
    """`name=value` fields, each behind its length."""
    fields, at = {}, 0
    while at + LENGTH_BYTES <= len(data):
        end = at + LENGTH_BYTES + int.from_bytes(data[at : at + LENGTH_BYTES], "little")
        name, _, value = data[at + LENGTH_BYTES : end].partition(b"=")
        fields[name] = value
        at = end
    return fields
