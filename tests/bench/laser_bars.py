"""The bars of checking and calibrating by tape, on finished builds.

    python -m tests.bench.laser_bars SCAN WORK [SCAN WORK ...] [--seeds N]

Per build: 40 distances with 2 mm of noise against the plan (mean error, share inside the stated 95 %); then the same scan as if all
it says were 1 % too long (every true length divided by 1.01), without and with five of the distances as `--laser`, judged by the other 35.
"""

import argparse
import sys
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from floorplan.config_file import load_config
from floorplan.corrections import Corrections, Surveyed
from floorplan.export import read_results
from floorplan.laser.calibrate import calibrate
from floorplan.laser.compare import check_plan
from floorplan.laser.spans import Span, find_span
from floorplan.laser.table import LaserRow, LaserTable
from floorplan.model.plan import Plan
from floorplan.results import Results
from tests.bench.laser_rows import MeasuredRow, measured_rows
from tests.bench.score_input import load_case

COUNT, TIED = 40, 5
SCALE_ERROR = 1.01


@dataclass(frozen=True)
class Bars:
    """One build and one draw of distances: errors in per cent; `untied`, `tied` of the other 35 distances under a scale error."""

    rows: int
    mean_percent: float
    within: float
    untied_percent: float
    tied_percent: float


def bars(results: Results, scan: Path, work: Path, seed: int) -> Bars:
    """The numbers of one draw."""
    rows = [_row(k, one) for k, one in enumerate(measured_rows(load_case(scan, work), COUNT, seed))]
    plain = check_plan(results.plan, LaserTable(tuple(rows)))
    short = [replace(row, measured_m=row.measured_m / SCALE_ERROR) for row in rows]
    chosen = set(np.random.default_rng(seed).permutation(len(short))[:TIED].tolist())
    others = LaserTable(tuple(row for k, row in enumerate(short) if k not in chosen))
    tied = _calibrated(results, work, [row for k, row in enumerate(short) if k in chosen])
    before, after = check_plan(results.plan, others), check_plan(tied, others)
    return Bars(len(plain.rows), *(_number(v) for v in (plain.mean_percent, plain.share_within, before.mean_percent, after.mean_percent)))


def _row(number: int, row: MeasuredRow) -> LaserRow:
    if row.id:
        return LaserRow(number, row.measured_m, row.id)
    x1, y1, x2, y2 = row.points_m
    return LaserRow(number, row.measured_m, "", (x1, y1), (x2, y2))


def _calibrated(results: Results, work: Path, rows: list[LaserRow]) -> Plan:
    """The plan as `build --laser` makes it from the same stages."""
    spans = tuple(span for row in rows if isinstance(span := find_span(results.plan, row), Span))
    solution = calibrate(results.layout.graph, results.merged, results.solution, spans)
    if solution.calibration is not None:
        shift = float(results.plan.shift_m[0]), float(results.plan.shift_m[1])
        framed = replace(solution.calibration, plan_quarters=results.plan.rotation_quarters, plan_shift_m=shift)
        solution = replace(solution, calibration=framed)
    corrected = Corrections(load_config(work / "config.toml"), work)
    known = Surveyed(results.scan, results.segmented, results.layout, results.merged)
    return corrected.named(corrected.drawn(known, solution, results.layout.tracks))


def _number(value: float | None) -> float:
    return float("nan") if value is None else value


def main() -> None:
    """The command."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("folders", nargs="+", type=Path)
    parser.add_argument("--seeds", type=int, default=2)
    arguments = parser.parse_args()
    sys.stdout.write("build              rows  mean %  inside 95 %   1 % off: mean % of the others, with five tied\n")
    for scan, work in zip(arguments.folders[::2], arguments.folders[1::2], strict=True):
        results = read_results(work)
        for seed in range(arguments.seeds):
            one = bars(results, scan, work, seed)
            plain = f"{one.rows:4}  {one.mean_percent:6.3f}  {100 * one.within:11.0f}"
            sys.stdout.write(f"{scan.name:18} {plain}   {one.untied_percent:.3f}  {one.tied_percent:.3f}\n")


if __name__ == "__main__":
    main()
