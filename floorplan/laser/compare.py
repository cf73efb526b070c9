"""A plan against measured distances: per row, and in one verdict."""

import math
from dataclasses import dataclass

import numpy as np

from floorplan.laser.spans import Span, find_span
from floorplan.laser.table import BadRow, LaserTable
from floorplan.model.plan import Plan

NORMAL_95 = 1.96
LEVELS_M = ((0.001, "LOA50"), (0.005, "LOA40"), (0.015, "LOA30"), (0.050, "LOA20"), (0.150, "LOA10"))  # USIBD, at 95 %
NO_LEVEL = "none"
SHARE = 0.95


@dataclass(frozen=True)
class Comparison:
    """One distance: `difference_m` = plan - measured; `interval_m` half the 95 % interval of plan and meter together."""

    line: int
    id: str
    measured_m: float
    plan_m: float
    sigma_m: float
    difference_m: float
    percent: float
    interval_m: float
    within: bool
    level: str
    room: str = ""
    note: str = ""


@dataclass(frozen=True)
class Check:
    """All rows and their summary; the means are over absolute errors, None without a row. `bad` rows are in no number."""

    rows: tuple[Comparison, ...]
    bad: tuple[BadRow, ...]
    empty: int
    mean_m: float | None
    worst_m: float | None
    mean_percent: float | None
    worst_percent: float | None
    bias_percent: float | None
    share_within: float | None
    level: str | None


def check_plan(plan: Plan, table: LaserTable) -> Check:
    """Every row of the table against the plan."""
    found = [find_span(plan, row) for row in table.rows]
    rows = tuple(compare(span) for span in found if isinstance(span, Span))
    lost = tuple(BadRow(row.line, text) for row, text in zip(table.rows, found, strict=True) if isinstance(text, str))
    bad = tuple(sorted((*table.bad, *lost), key=lambda one: one.line))
    if not rows:
        return Check(rows, bad, table.empty, None, None, None, None, None, None, None)
    error = np.abs([row.difference_m for row in rows])
    percent = np.array([row.percent for row in rows])
    return Check(
        rows,
        bad,
        table.empty,
        mean_m=float(error.mean()),
        worst_m=float(error.max()),
        mean_percent=float(np.abs(percent).mean()),
        worst_percent=float(np.abs(percent).max()),
        bias_percent=float(percent.mean()),
        share_within=float(np.mean([row.within for row in rows])),
        level=level_of(float(np.sort(error)[math.ceil(SHARE * len(error)) - 1])),
    )


def compare(span: Span) -> Comparison:
    """The plan's distance against the measured one."""
    row, difference = span.row, span.distance_m - span.row.measured_m
    interval = NORMAL_95 * math.hypot(span.sigma_m, span.laser_sigma_m)
    return Comparison(
        line=row.line,
        id=row.name,
        measured_m=row.measured_m,
        plan_m=span.distance_m,
        sigma_m=span.sigma_m,
        difference_m=difference,
        percent=100 * difference / row.measured_m,
        interval_m=interval,
        within=abs(difference) <= interval,
        level=level_of(abs(difference)),
        room=span.room,
        note=row.note,
    )


def level_of(error_m: float) -> str:
    """The USIBD level of accuracy of an error at 95 %, "none" beyond 150 mm."""
    return next((name for bound, name in LEVELS_M if error_m <= bound), NO_LEVEL)
