"""Lines of a text file that may be packed by gzip or bzip2, whatever its name says."""

import bz2
import gzip
from collections.abc import Iterator
from pathlib import Path

GZIP_MAGIC, BZIP2_MAGIC = b"\x1f\x8b", b"BZh"
BYTE_ORDER_MARK = b"\xef\xbb\xbf"


def packed_by(file: Path) -> str:
    """ "gzip", "bzip2" or "" by the file's first bytes."""
    with file.open("rb") as opened:
        start = opened.read(len(BZIP2_MAGIC))
    return "gzip" if start.startswith(GZIP_MAGIC) else "bzip2" if start == BZIP2_MAGIC else ""


def packed_lines(file: Path) -> Iterator[bytes]:
    """The lines, unpacked on the way. Raises `OSError` or `EOFError` where the packed data ends early or is damaged."""
    packing = packed_by(file)
    with gzip.open(file, "rb") if packing == "gzip" else bz2.open(file, "rb") if packing == "bzip2" else file.open("rb") as lines:
        for number, line in enumerate(lines):
            yield line.removeprefix(BYTE_ORDER_MARK) if number == 0 else line
