"""Tables as people and spreadsheets write them: lines and cells of a CSV file, whatever its encoding, separator and decimal mark.

Encodings: UTF-8 with or without a byte order mark, UTF-16 with one, else Latin-1. Separators: comma, semicolon, tab; decimal
point or decimal comma.
"""

import csv
import io
import math
import re
from dataclasses import dataclass

from floorplan.errors import InputError

SEPARATORS = (";", "\t", ",")  # the first one in the header: a semicolon's table has decimal commas
UNITS_M = {"": 1.0, "m": 1.0, "cm": 0.01, "mm": 0.001, "ft": 0.3048, "in": 0.0254}
NUMBER = re.compile(r"([+-]?(?:\d+\.?\d*|\.\d+)(?:e[+-]?\d+)?)\s*([a-z]*)")
SHOWN = 40  # characters of a bad cell that a message repeats


class CellError(ValueError):
    """A cell that cannot be used; its text is the rest of a sentence."""


@dataclass(frozen=True)
class CsvLines:
    """The header as it stands and as lower-case `columns`; `rows` with their line in the file, from 1, blank ones left out."""

    header: str
    columns: list[str]
    rows: list[tuple[int, list[str]]]
    separator: str


def csv_lines(content: bytes, name: str, how: str) -> CsvLines:
    """The lines of a file called `name`. Raises InputError when it is no table at all; `how` says what it should be."""
    text = _decoded(content).replace("\r\n", "\n").replace("\r", "\n")
    header_line = next((line for line in text.split("\n") if line.strip()), "")
    separator = next((mark for mark in SEPARATORS if mark in header_line), ",")
    try:
        reader = csv.reader(io.StringIO(text, newline=""), delimiter=separator)
        lines = [(reader.line_num, row) for row in reader if any(cell.strip() for cell in row)]
    except csv.Error as error:
        raise InputError(f"{name}: not a CSV table ({error}); it needs {how}") from error
    columns = [cell.strip().lower() for cell in lines[0][1]] if lines else []
    return CsvLines(header_line.strip(), columns, lines[1:], separator)


def _decoded(content: bytes) -> str:
    if content.startswith((b"\xff\xfe", b"\xfe\xff")):
        return content.decode("utf-16", "replace")
    try:
        return content.decode("utf-8-sig")
    except UnicodeDecodeError:
        return content.decode("latin-1")


def length_m(column: str, text: str) -> float:
    """Metres from '5.432', '5,432', '5.432 m', '5432 mm', '1 234,5'."""
    compact = re.sub(r"[\s\u00a0\u202f']", "", text).lower()
    point = compact.rfind(".")
    comma = compact.rfind(",")
    if comma > point:
        compact = compact.replace(".", "").replace(",", ".")
    elif point > comma >= 0:
        compact = compact.replace(",", "")
    found = NUMBER.fullmatch(compact)
    if found is None or found[2] not in UNITS_M:
        raise CellError(f"{column} is '{text[:SHOWN]}', which is no length; write metres, like 5.432")
    value = float(found[1]) * UNITS_M[found[2]]
    if not math.isfinite(value):
        raise CellError(f"{column} is '{text[:SHOWN]}', which is no length; write metres, like 5.432")
    return value
