"""Distances as a laser meter would give them, from a simulated scan's truth: `python -m tests.bench.laser_rows SCAN WORK OUT.csv`."""

import argparse
import csv
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from tests.bench.score_input import Case, load_case
from tests.bench.score_walls import _ends_seen, _nearest, _span, true_lines

METER_SIGMA_M = 0.002
EYE_SIGMA_M = 0.01  # a point is put down in a drawing this well
SHORTEST_M = 0.10  # nearer true faces are one face: the plan's dimension has no truth
MOST_TRIES = 4000


@dataclass(frozen=True)
class MeasuredRow:
    """One distance as the meter says it: the `id` of a dimension, or two points of the plan (x1, y1, x2, y2)."""

    measured_m: float
    id: str = ""
    points_m: tuple[float, ...] = ()


def measured_rows(case: Case, count: int = 40, seed: int = 0, sigma_m: float = METER_SIGMA_M) -> list[MeasuredRow]:
    """Up to half of them horizontal dimensions of the plan, the rest between two points seen from the path; true length plus noise."""
    rng = np.random.default_rng(seed)
    found = [(d["id"], length) for d in case.plan["dimensions"] if (length := _true_length(case, d)) is not None]
    chosen = [found[k] for k in rng.permutation(len(found))[: count // 2]]
    noise = sigma_m * rng.standard_normal(count)
    rows = [MeasuredRow(length + float(noise[k]), id=name) for k, (name, length) in enumerate(chosen)]
    for _ in range(MOST_TRIES):
        if len(rows) == count:
            break
        row = _between_points(case, rng, float(noise[len(rows)]))
        rows += [row] if row is not None else []
    return rows


def _between_points(case: Case, rng: np.random.Generator, noise_m: float) -> MeasuredRow | None:
    """The free distance along an axis through a place on the path, its ends put down by eye in the plan."""
    true, seen = (true_lines(case, ("wall", "column", "jamb"), seen=only) for only in (False, True))
    row, axis = int(rng.integers(len(case.path_true_m))), int(rng.integers(2))
    span = _span(true, case.path_true_m[row], axis)
    if span is None or not _ends_seen(seen, span, case.path_true_m[row], axis):
        return None
    ends = []
    for end in span:
        point = case.path_true_m[row, :2].copy()
        point[axis] = end
        placed = (point - case.placement.shift_m[:2]) @ case.placement.rotation
        ends += [float(v) for v in placed + EYE_SIGMA_M * rng.standard_normal(2)]
    return MeasuredRow(span[1] - span[0] + noise_m, points_m=tuple(ends))


def _true_length(case: Case, dimension: dict[str, Any]) -> float | None:
    """Between the true faces that its two ends lie on; None where there are none, and for heights."""
    if dimension["axis"] == 2:
        return None
    true = true_lines(case, ("wall", "column", "jamb", "sill"))
    planes = {plane["id"]: plane for plane in case.plan["planes"]}
    ends = []
    for plane_id, point in ((dimension["from_plane"], dimension["start"]), (dimension["to_plane"], dimension["end"])):
        plane = planes[plane_id]
        normal = case.placement.vector(plane["axis"], plane["facing"])
        axis, xy = int(np.argmax(np.abs(normal))), case.placement.xy(point)
        ends.append(_nearest(true, axis, int(np.sign(normal[axis])), float(xy[axis]), float(xy[1 - axis])))
    apart = 0.0 if ends[0] is None or ends[1] is None else abs(ends[1] - ends[0])
    return apart if apart > SHORTEST_M else None


def write_rows(rows: list[MeasuredRow], path: Path) -> None:
    """The rows as LASER.csv."""
    with path.open("w", encoding="utf-8", newline="") as stream:
        writer = csv.writer(stream, lineterminator="\n")
        writer.writerow(("id", "x1", "y1", "x2", "y2", "measured_m"))
        for row in rows:
            points = [f"{value:.3f}" for value in row.points_m] or [""] * 4
            writer.writerow((row.id, *points, f"{row.measured_m:.4f}"))


def main() -> None:
    """The command."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("scan", type=Path)
    parser.add_argument("work", type=Path)
    parser.add_argument("out", type=Path)
    parser.add_argument("--count", type=int, default=40)
    parser.add_argument("--seed", type=int, default=0)
    arguments = parser.parse_args()
    write_rows(measured_rows(load_case(arguments.scan, arguments.work), arguments.count, arguments.seed), arguments.out)


if __name__ == "__main__":
    main()
