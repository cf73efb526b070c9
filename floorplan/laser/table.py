"""LASER.csv as people and spreadsheets write it, to rows; a row that cannot be used becomes a sentence, never a crash.

Encodings: UTF-8 with or without a byte order mark, UTF-16 with one, else Latin-1. Separators: comma, semicolon, tab; decimal
point or decimal comma.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

from floorplan.csv_cells import SHOWN, CellError, csv_lines, length_m
from floorplan.errors import InputError
from floorplan.model.plan import Point

MEASURED, SIGMA, ID, NOTE = "measured_m", "sigma_m", "id", "note"
COORDINATES = ("x1", "y1", "x2", "y2")
LONGEST_M = 1000.0  # no hand-held meter reaches further
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


def read_laser(path: Path) -> LaserTable:
    """The table in the file. Raises InputError when it is missing, or no table at all."""
    try:
        content = path.read_bytes()
    except OSError as error:
        raise InputError(f"{path}: cannot be read ({error.strerror}); give the CSV file with the measured distances") from error
    return parse_laser(content, str(path))


def parse_laser(content: bytes, name: str = "LASER.csv") -> LaserTable:
    """The table in the bytes of a file called `name`. Raises InputError when no header or no column of distances is there."""
    lines = csv_lines(content, name, HOW)
    columns = lines.columns
    if MEASURED not in columns or not (ID in columns or set(COORDINATES) <= set(columns)):
        raise InputError(f"{name}: the first row is '{lines.header[:SHOWN]}'; it needs {HOW}")
    return _table(columns, lines.rows, lines.separator)


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
        except CellError as reason:
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
        raise CellError(extra)
    measured = length_m(MEASURED, cells[MEASURED])
    if measured > LONGEST_M:
        raise CellError(f"{MEASURED} is {measured:g}, which no laser meter says in metres: millimetres, 1000 times as much? Give metres")
    if measured <= 0:
        raise CellError(f"{MEASURED} is {measured:g} m, which no laser meter says; give metres")
    sigma = length_m(SIGMA, cells[SIGMA]) if cells.get(SIGMA) else None
    if sigma is not None and not 0 < sigma <= LONGEST_M:
        raise CellError(f"{SIGMA} is {sigma:g} m; give the standard deviation in metres, 0.002 for most laser meters")
    given = [name for name in COORDINATES if cells.get(name)]
    note = cells.get(NOTE, "")
    if cells.get(ID):
        return LaserRow(line, measured, cells[ID].upper(), sigma_m=sigma, note=note)
    if len(given) < len(COORDINATES):
        raise CellError("neither the id of a dimension nor two whole points x1, y1, x2, y2")
    x1, y1, x2, y2 = (length_m(name, cells[name]) for name in COORDINATES)
    return LaserRow(line, measured, "", (x1, y1), (x2, y2), sigma, note)
