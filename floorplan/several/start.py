"""Where to look for the laying of one scan on another: anywhere, where both began, or by points measured in both plans."""

import codecs
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from floorplan.csv_cells import csv_lines, length_m
from floorplan.errors import InputError
from floorplan.model.checks import Array
from floorplan.several.correlate import Near
from floorplan.several.survey import Survey, quarter_turn

MATCH, COMMON = "match", "common"
COMMON_WITHIN_M = 1.5  # nobody starts twice on the very spot
POINTS_WITHIN_M = 0.7  # points are picked by eye on two drawings, and the drawings drift
LARGEST_MISS_M = 0.6  # of one picked pair against all of them
HEADER = ("x1", "y1", "x2", "y2")
SECOND = 2  # the scan of a row that names none
HOW = f"a header row {','.join(HEADER)}, then one pair of points a row, metres in both plans"


@dataclass(frozen=True)
class PointPairs:
    """Points in the first scan's plan `first_xy_m (P, 2)` and the same ones in the plan of the scan `other`, numbered from 1, (P, 2)."""

    scan: Array
    first_xy_m: Array
    other_xy_m: Array
    line: Array


def read_point_pairs(path: Path) -> PointPairs:
    """The file's pairs: header `x1,y1,x2,y2` and maybe `scan` (2 where it is missing). Raises `InputError` naming line and remedy."""
    if not path.is_file():
        raise InputError(f"{path}: no such file; --start takes match, common, or a file of point pairs ({','.join(HEADER)})")
    lines = csv_lines(_without_comments(path.read_bytes()), str(path), HOW)
    if not set(HEADER) <= set(lines.columns):
        raise InputError(f"{path}: the header must name {', '.join(HEADER)} (and scan, where there are more than two)")
    rows = [(line, dict(zip(lines.columns, cells, strict=False))) for line, cells in lines.rows]
    try:
        values = np.array([[length_m(name, row.get(name, "")) for name in HEADER] for _, row in rows]).reshape(-1, 4)
        scans = np.array([int(row.get("scan") or SECOND) for _, row in rows], dtype=np.int64)
    except ValueError as error:
        raise InputError(f"{path}: a row holds no four numbers ({error})") from error
    return PointPairs(scans, values[:, :2], values[:, 2:], np.array([number for number, _ in rows], dtype=np.int64))


def _without_comments(content: bytes) -> bytes:
    """Lines that begin with # made empty, so that the others keep their numbers."""
    return b"\n".join(b"" if line.startswith(b"#") else line for line in content.removeprefix(codecs.BOM_UTF8).split(b"\n"))


def near_common_start(base: Survey, other: Survey) -> Near:
    """Both scans began at about the same place, in whatever direction."""
    return Near(other.first_xy_m, base.first_xy_m, COMMON_WITHIN_M)


def near_points(pairs: PointPairs, scan: int, path: Path) -> Near:
    """By the pairs of scan number `scan`. Raises `InputError` where there are fewer than two or they do not fit each other."""
    mine = np.flatnonzero(pairs.scan == scan)
    if len(mine) < 2:
        raise InputError(f"{path}: {len(mine)} point pairs for scan {scan}; two at least are needed, four are good")
    fits = [_fitted(pairs.first_xy_m[mine], pairs.other_xy_m[mine], quarters) for quarters in range(4)]
    quarters = int(np.argmin([np.mean(miss**2) for miss in fits]))
    worst = int(np.argmax(fits[quarters]))
    if fits[quarters][worst] > LARGEST_MISS_M:
        raise InputError(
            f"{path}: line {pairs.line[mine[worst]]} misses the other pairs of scan {scan} by {fits[quarters][worst]:.2f} m; "
            "the points are metres in each scan's own plan (floorplan export WORK/scan-1 --png plan.png draws it)"
        )
    centre = pairs.other_xy_m[mine].mean(axis=0)
    return Near(centre, pairs.first_xy_m[mine].mean(axis=0), POINTS_WITHIN_M, quarters)


def _fitted(first: Array, other: Array, quarters: int) -> Array:
    """How far each pair (P,) is off the best shift under a quarter turn."""
    difference = first - other @ quarter_turn(quarters)[:2, :2].T
    return np.asarray(np.linalg.norm(difference - difference.mean(axis=0), axis=1))
