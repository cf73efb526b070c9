"""A plan against measured distances: per row, and in one verdict."""

import math
from dataclasses import dataclass, replace

import numpy as np

from floorplan.laser.spans import Span, find_span
from floorplan.laser.table import BadRow, LaserTable
from floorplan.model.normal import NORMAL_95
from floorplan.model.plan import Plan
from floorplan.model.ties import Calibration

LEVELS_M = ((0.001, "LOA50"), (0.005, "LOA40"), (0.015, "LOA30"), (0.050, "LOA20"), (0.150, "LOA10"))  # USIBD, at 95 %
NO_LEVEL = "none"
SHARE = 0.95
SAME_M = 1e-6  # two readings of one number


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
    calibrated: bool = False  # the plan was calibrated with this very distance: it proves nothing


@dataclass(frozen=True)
class Check:
    """All rows and their summary; the means are over absolute errors, None without a row. `bad` rows are in no number.

    Rows that the plan was `calibrated` with are in no number either, as long as there are others.
    """

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

    @property
    def calibrated(self) -> int:
        """How many rows the plan was calibrated with."""
        return sum(row.calibrated for row in self.rows)


def check_plan(plan: Plan, table: LaserTable, calibration: Calibration | None = None) -> Check:
    """Every row of the table against the plan; `calibration` is what the plan was made with."""
    found = [find_span(plan, row) for row in table.rows]
    rows = tuple(_marked(compare(span), calibration) for span in found if isinstance(span, Span))
    lost = tuple(BadRow(row.line, text) for row, text in zip(table.rows, found, strict=True) if isinstance(text, str))
    bad = tuple(sorted((*table.bad, *lost), key=lambda one: one.line))
    if not rows:
        return Check(rows, bad, table.empty, None, None, None, None, None, None, None)
    proving = tuple(row for row in rows if not row.calibrated) or rows
    error = np.abs([row.difference_m for row in proving])
    percent = np.array([row.percent for row in proving])
    return Check(
        rows,
        bad,
        table.empty,
        mean_m=float(error.mean()),
        worst_m=float(error.max()),
        mean_percent=float(np.abs(percent).mean()),
        worst_percent=float(np.abs(percent).max()),
        bias_percent=float(percent.mean()),
        share_within=float(np.mean([row.within for row in proving])),
        level=level_of(float(np.sort(error)[math.ceil(SHARE * len(error)) - 1])),
    )


def _marked(row: Comparison, calibration: Calibration | None) -> Comparison:
    """The row, marked where the calibration used the same distance: equal in its measured value and in what the plan made of it."""
    used = (tied for tied in calibration.rows if tied.used) if calibration else ()
    same = any(abs(tied.measured_m - row.measured_m) < SAME_M and abs(tied.after_m - row.plan_m) < SAME_M for tied in used)
    return replace(row, calibrated=same)


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
