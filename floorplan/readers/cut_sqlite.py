"""ROS 2 databases page by page, without SQLite. Format: sqlite.org/fileformat2.html, sections 1.3, 1.6, 2.1.

Rows lie in leaf pages of tables; long ones go on in a chain of overflow pages. Leaves are found by looking at every page, so no
index and no inner page is needed: a row is lost only with its own bytes.
"""

from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import BinaryIO

from floorplan.readers.cut_records import RawDefinition, RawMessage, RawRecord, RawTopic, file_size

HEAD_BYTES = 100
TABLE_LEAF = 13
LEAF_HEAD_BYTES = 8
INTEGER_BYTES = (0, 1, 2, 3, 4, 6, 8)  # by serial type
FLOAT_TYPE, ZERO_TYPE, ONE_TYPE, FIRST_BLOB_TYPE = 7, 8, 9, 12

Value = None | int | float | str | bytes


@dataclass(frozen=True)
class _Pages:
    """Page size, bytes of it that are used, pages that the file should have."""

    size: int
    usable: int
    count: int


@dataclass(frozen=True)
class CutSqlite:
    """See `CutFormat`."""

    def is_cut(self, path: Path) -> bool:
        """True when the file has fewer pages than it says."""
        return path.stat().st_size < self.full_size(path)

    def full_size(self, path: Path) -> int:
        """Pages times page size."""
        with path.open("rb") as file:
            pages = _pages(file)
        return pages.size * pages.count

    def blocks(self, file: BinaryIO) -> Iterator[int]:
        """Leaf pages of tables."""
        pages = _pages(file)
        for at in range(0, file_size(file) - pages.size + 1, pages.size):
            file.seek(at or HEAD_BYTES)  # the first page begins with the file's head
            if file.read(1) == bytes([TABLE_LEAF]):
                yield at

    def records(self, file: BinaryIO, offset: int) -> Iterator[RawRecord]:
        """Rows of a page that are topics, message types or messages, by the shape of their columns."""
        pages = _pages(file)
        file.seek(offset)
        page = file.read(pages.size)
        head = (offset == 0 and HEAD_BYTES) or 0
        for cell in range(int.from_bytes(page[head + 3 : head + 5], "big")):
            at = head + LEAF_HEAD_BYTES + 2 * cell
            start = int.from_bytes(page[at : at + 2], "big")
            size, start = _varint(page, start)
            row, start = _varint(page, start)
            payload = _payload(file, pages, page[start:], size)
            if payload is not None:
                yield from _told(row, _columns(payload))


def _told(row: int, columns: list[Value]) -> Iterator[RawRecord]:
    """The first column of every table is the row number, kept apart from the record as SQLite does."""
    match columns:
        case [None, int(topic), int(log_ns), bytes(raw)]:
            yield RawMessage(topic, log_ns, raw)
        case [None, str(type), "ros2msg" | "ros2idl" as encoding, str(definition), *_]:
            yield RawDefinition(type, definition, encoding)
        case [None, str(name), str(type), "cdr", *_]:
            yield RawTopic(row, name, type)


def _pages(file: BinaryIO) -> _Pages:
    file.seek(0)
    head = file.read(HEAD_BYTES).ljust(HEAD_BYTES, b"\0")
    size = int.from_bytes(head[16:18], "big")
    size = 65536 if size == 1 else max(size, 512)  # 1 stands for 64 KiB; 512 is the least there is
    return _Pages(size, size - head[20], int.from_bytes(head[28:32], "big"))


def _payload(file: BinaryIO, pages: _Pages, local: bytes, size: int) -> bytes | None:
    """A row's bytes, its overflow pages followed; None where one of them is not there."""
    if size > file_size(file):
        return None
    if size <= pages.usable - 35:
        return local[:size] if size <= len(local) else None
    least = (pages.usable - 12) * 32 // 255 - 23
    held = least + (size - least) % (pages.usable - 4)
    held = held if held <= pages.usable - 35 else least
    parts, left = [local[:held]], size - held
    following = int.from_bytes(local[held : held + 4], "big")
    while left > 0:
        file.seek((following - 1) * pages.size if following else 0)
        page = file.read(pages.usable)
        if not following or len(page) < pages.usable:
            return None
        parts.append(page[4 : 4 + left])
        left -= pages.usable - 4
        following = int.from_bytes(page[:4], "big")
    return b"".join(parts)


def _columns(payload: bytes) -> list[Value]:
    """The values of a record: its head holds the length of the head and one serial type per column."""
    end, at = _varint(payload, 0)
    types = []
    while at < min(end, len(payload)):
        type, at = _varint(payload, at)
        types.append(type)
    values: list[Value] = []
    for type in types:
        size = _bytes_of(type)
        values.append(_value(type, payload[at : at + size]))
        at += size
    return values


def _bytes_of(type: int) -> int:
    if type >= FIRST_BLOB_TYPE:
        return (type - FIRST_BLOB_TYPE) // 2
    return 8 if type == FLOAT_TYPE else INTEGER_BYTES[type] if type < FLOAT_TYPE else 0


def _value(type: int, data: bytes) -> Value:
    if type >= FIRST_BLOB_TYPE:
        return data.decode(errors="replace") if type % 2 else data
    if type in (ZERO_TYPE, ONE_TYPE):
        return type - ZERO_TYPE
    return None if type == 0 else 0.0 if type == FLOAT_TYPE else int.from_bytes(data, "big", signed=True)


def _varint(data: bytes, at: int) -> tuple[int, int]:
    """A number of seven bits a byte (eight in the ninth), and where it ends."""
    number = 0
    for count in range(9):
        byte = data[at + count] if at + count < len(data) else 0
        if count == 8:
            return number << 8 | byte, at + 9
        number = number << 7 | byte & 0x7F
        if byte < 0x80:
            return number, at + count + 1
    return number, at + 9
