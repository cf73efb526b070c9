"""points.csv: points of the plan with their site coordinates."""

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

from floorplan.csv_cells import SHOWN, CellError, csv_lines, length_m
from floorplan.errors import InputError
from floorplan.model.plan import Point

COLUMNS = ("x", "y", "east", "north")
NAME, SNAP = "name", "snap"
NO = ("no", "n", "0", "false")
HOW = "a header row 'name,x,y,east,north', then one point a row, metres in the plan and on the site grid; see templates/points.csv"


@dataclass(frozen=True)
class ControlRow:
    """One control point as it was written; `snap`: to the nearest corner of a wall."""

    name: str
    plan: Point
    site: Point
    snap: bool


def read_control(path: Path) -> tuple[ControlRow, ...]:
    """The points of the file. Raises InputError with every row that cannot be read: a plan is not placed by half of them."""
    try:
        content = path.read_bytes()
    except OSError as error:
        raise InputError(f"{path}: cannot be read ({error.strerror}); give the CSV file with the control points") from error
    return parse_control(content, str(path))


def parse_control(content: bytes, name: str = "points.csv") -> tuple[ControlRow, ...]:
    """The points in the bytes of a file called `name`; errors as in `read_control`."""
    lines = csv_lines(content, name, HOW)
    if not set(COLUMNS) <= set(lines.columns):
        raise InputError(f"{name}: the first row is '{lines.header[:SHOWN]}'; it needs {HOW}")
    rows, bad = [], []
    for line, values in lines.rows:
        try:
            rows.append(_row(line, {column: value.strip() for column, value in zip(lines.columns, values, strict=False)}))
        except CellError as reason:
            bad.append(f"{name}, line {line}: {reason}")
    if bad:
        raise InputError("\n".join(bad))
    if not rows:
        raise InputError(f"{name}: no control point in it; it needs {HOW}")
    return tuple(rows)


def _row(line: int, cells: Mapping[str, str]) -> ControlRow:
    missing = [column for column in COLUMNS if not cells.get(column)]
    if missing:
        raise CellError(f"{', '.join(missing)} is missing")
    x, y, east, north = (length_m(column, cells[column]) for column in COLUMNS)
    return ControlRow(cells.get(NAME) or f"line {line}", (x, y), (east, north), cells.get(SNAP, "").lower() not in NO)
