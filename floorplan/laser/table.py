"""LASER.csv as people and spreadsheets write it, to rows; a row that cannot be used becomes a sentence, never a crash.

Encodings: UTF-8 with or without a byte order mark, UTF-16 with one, else Latin-1. Separators: comma, semicolon, tab; decimal
point or decimal comma.
"""

import csv
import io
import math
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

from floorplan.errors import InputError
from floorplan.model.plan import Point

MEASURED, SIGMA, ID, NOTE = "measured_m", "sigma_m", "id", "note"
COORDINATES = ("x1", "y1", "x2", "y2")
SEPARATORS = (";", "\t", ",")  # the first one in the header: a semicolon's table has decimal commas
UNITS_M = {"": 1.0, "m": 1.0, "cm": 0.01, "mm": 0.001, "ft": 0.3048, "in": 0.0254}
NUMBER = re.compile(r"([+-]?(?:\d+\.?\d*|\.\d+)(?:e[+-]?\d+)?)\s*([a-z]*)")
LONGEST_M = 1000.0  # no hand-held meter reaches further
SHOWN = 40  # characters of a bad cell that a message repeats
HOW = "a header row 'id,measured_m' or 'x1,y1,x2,y2,measured_m', then one distance a row, metres; see templates/laser.csv"


@dataclass(frozen=True)
class LaserRow:
    """One measured distance: by the `id` of a dimension, or between `start` and `end` in the plan; `line` in the file, from 1."""

    line: int
    measured_m: float
    id: str = ""
    start: Point | None = None
    end: Point | None = None
    sigma_m: float | None = None
    note: str = ""

    @property
    def name(self) -> str:
        """What to call the row in a table."""
        return self.id or f"line {self.line}"


@dataclass(frozen=True)
class BadRow:
    """A row that was left out, and why, in a sentence."""

    line: int
    text: str


@dataclass(frozen=True)
class LaserTable:
    """The rows that can be used, those that cannot, and how many have no measured value yet."""

    rows: tuple[LaserRow, ...]
    bad: tuple[BadRow, ...] = ()
    empty: int = 0


class _CellError(ValueError):
    """A cell that cannot be used; its text is the rest of a sentence."""


def read_laser(path: Path) -> LaserTable:
    """The table in the file. Raises InputError when it is missing, or no table at all."""
    try:
        content = path.read_bytes()
    except OSError as error:
        raise InputError(f"{path}: cannot be read ({error.strerror}); give the CSV file with the measured distances") from error
    return parse_laser(content, str(path))


def parse_laser(content: bytes, name: str = "LASER.csv") -> LaserTable:
    """The table in the bytes of a file called `name`. Raises InputError when no header or no column of distances is there."""
    text = _decoded(content).replace("\r\n", "\n").replace("\r", "\n")
    header_line = next((line for line in text.split("\n") if line.strip()), "")
    separator = next((mark for mark in SEPARATORS if mark in header_line), ",")
    try:
        reader = csv.reader(io.StringIO(text, newline=""), delimiter=separator)
        lines = [(reader.line_num, row) for row in reader if any(cell.strip() for cell in row)]
    except csv.Error as error:
        raise InputError(f"{name}: not a CSV table ({error}); it needs {HOW}") from error
    columns = [cell.strip().lower() for cell in lines[0][1]] if lines else []
    if MEASURED not in columns or not (ID in columns or set(COORDINATES) <= set(columns)):
        raise InputError(f"{name}: the first row is '{header_line.strip()[:SHOWN]}'; it needs {HOW}")
    return _table(columns, lines[1:], separator)


def _decoded(content: bytes) -> str:
    if content.startswith((b"\xff\xfe", b"\xfe\xff")):
        return content.decode("utf-16", "replace")
    try:
        return content.decode("utf-8-sig")
    except UnicodeDecodeError:
        return content.decode("latin-1")


def _table(columns: Sequence[str], lines: Sequence[tuple[int, list[str]]], separator: str) -> LaserTable:
    rows: list[LaserRow] = []
    bad: list[BadRow] = []
    empty, first_line = 0, dict[str, int]()
    for line, values in lines:
        cells = {column: value.strip() for column, value in zip(columns, values, strict=False)}
        if not cells.get(MEASURED) and len(values) <= len(columns):
            empty += 1
            continue
        try:
            row = _row(line, cells, _extra(values, columns, separator))
        except _CellError as reason:
            bad.append(BadRow(line, f"line {line}: {reason}"))
            continue
        if row.id and row.id in first_line:
            bad.append(BadRow(line, f"line {line}: {row.id} was measured on line {first_line[row.id]} already; keep one of the two"))
            continue
        first_line[row.id] = line
        rows.append(row)
    return LaserTable(tuple(rows), tuple(bad), empty)


def _extra(values: Sequence[str], columns: Sequence[str], separator: str) -> str:
    """What is wrong with the number of cells, empty when nothing is."""
    if not any(value.strip() for value in values[len(columns) :]):
        return ""
    advice = "; decimal commas need semicolons between the columns, or quotes" if separator == "," else ""
    return f"{len(values)} cells where the header has {len(columns)}{advice}"


def _row(line: int, cells: Mapping[str, str], extra: str) -> LaserRow:
    if extra:
        raise _CellError(extra)
    measured = _length(MEASURED, cells[MEASURED])
    if not 0 < measured <= LONGEST_M:
        raise _CellError(f"{MEASURED} is {measured:g} m, which no laser meter says; give metres")
    sigma = _length(SIGMA, cells[SIGMA]) if cells.get(SIGMA) else None
    if sigma is not None and not 0 < sigma <= LONGEST_M:
        raise _CellError(f"{SIGMA} is {sigma:g} m; give the standard deviation in metres, 0.002 for most laser meters")
    given = [name for name in COORDINATES if cells.get(name)]
    note = cells.get(NOTE, "")
    if cells.get(ID):
        return LaserRow(line, measured, cells[ID].upper(), sigma_m=sigma, note=note)
    if len(given) < len(COORDINATES):
        raise _CellError("neither the id of a dimension nor two whole points x1, y1, x2, y2")
    x1, y1, x2, y2 = (_length(name, cells[name]) for name in COORDINATES)
    return LaserRow(line, measured, "", (x1, y1), (x2, y2), sigma, note)


def _length(column: str, text: str) -> float:
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
        raise _CellError(f"{column} is '{text[:SHOWN]}', which is no length; write metres, like 5.432")
    value = float(found[1]) * UNITS_M[found[2]]
    if not math.isfinite(value):
        raise _CellError(f"{column} is '{text[:SHOWN]}', which is no length; write metres, like 5.432")
    return value
