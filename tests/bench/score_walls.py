"""Drawn wall lines against true faces, wall-to-wall distances, wall thickness, dimensions."""

from dataclasses import dataclass
from itertools import pairwise
from typing import Any

import numpy as np
from shapely import LineString, Polygon

from floorplan.model.checks import Array
from tests.bench.score_input import Case

SAMPLE_M = 0.01
TOLERANCES_M = (0.03, 0.05, 0.10)
STRAIGHT = 1e-4  # a drawn line deviates less from its axis, in metres per metre
EYE_M = 1.5  # height at which wall-to-wall distances are taken
MIN_SILL_M = 0.5  # a lower one is the frame of a glass wall
SPANS = 300
MISSED_M = 0.5
BESIDE_M = 0.001  # a span inside a room may touch its outline
LONG_SPAN_M = 5.0
SNAP_M = 0.30  # a dimension's or wall's face belongs to a true one this near
Z95 = 1.96


@dataclass(frozen=True)
class Lines:
    """L axis-aligned lines in plan: `axis (L,)` of their normal, `offset`, `low`, `high (L,)`, `facing (L,)` 0 where unknown."""

    axis: Array
    offset: Array
    low: Array
    high: Array
    facing: Array

    def samples(self) -> tuple[Array, Array, Array]:
        """Points every SAMPLE_M: axis, offset, place along, (S,) each."""
        places = [np.arange(a + SAMPLE_M / 2, b, SAMPLE_M) for a, b in zip(self.low, self.high, strict=True)]
        count = [len(p) for p in places]
        return np.repeat(self.axis, count), np.repeat(self.offset, count), np.concatenate([*places, []])

    def near(self, axis: Array, offset: Array, along: Array, tolerance_m: float) -> Array:
        """Whether each point (S,) lies on some line of the same axis, within the tolerance across and along."""
        found = np.zeros(len(axis), dtype=bool)
        for a, o, low, high in zip(self.axis, self.offset, self.low, self.high, strict=True):
            beside = (axis == a) & (np.abs(offset - o) <= tolerance_m)
            found |= beside & (along >= low - tolerance_m) & (along <= high + tolerance_m)
        return found


def _lines(rows: list[tuple[int, float, float, float, int]]) -> Lines:
    table = np.array(rows, dtype=float).reshape(-1, 5)
    return Lines(table[:, 0].astype(int), table[:, 1], table[:, 2], table[:, 3], table[:, 4].astype(int))


def drawn_lines(case: Case) -> tuple[Lines, float]:
    """The lines on `A-WALL` (seen parts), and the length in metres of those that lie on no axis."""
    rows: list[tuple[int, float, float, float, int]] = []
    skewed = 0.0
    for wall in case.plan["walls"]:
        for line in wall["seen"]:
            for start, end in pairwise(case.placement.xy(line)):
                run = np.abs(end - start)
                if run.max() < STRAIGHT:
                    continue
                along = int(np.argmax(run))
                if run[1 - along] > STRAIGHT * max(run[along], 1.0):
                    skewed += float(np.hypot(*run))
                    continue
                ends = sorted((start[along], end[along]))
                rows.append((1 - along, float(start[1 - along]), ends[0], ends[1], 0))
    return _lines(rows), skewed


def true_lines(case: Case, kinds: tuple[str, ...], *, seen: bool = False) -> Lines:
    """True faces of those kinds, whole or only where they were seen."""
    rows = []
    for face in case.truth["faces"]:
        if face["kind"] in kinds and not (face["kind"] == "sill" and face["z"][1] < MIN_SILL_M):
            for low, high in face["seen"] if seen else [[face["start"], face["end"]]]:
                rows.append((face["axis"], face["offset"], low, high, face["facing"]))
    return _lines(rows)


def wall_scores(case: Case) -> dict[str, Any]:
    """Precision against all true faces (windows' sills and jambs too), recall against seen walls and columns."""
    drawn, skewed = drawn_lines(case)
    true = true_lines(case, ("wall", "column", "jamb", "sill"))
    seen = true_lines(case, ("wall", "column"), seen=True)
    points, wanted = drawn.samples(), seen.samples()
    total = len(points[0]) + skewed / SAMPLE_M
    return {
        "drawn_m": total * SAMPLE_M,
        "seen_m": len(wanted[0]) * SAMPLE_M,
        "precision": {_cm(t): _share(true.near(*points, t).sum(), total) for t in TOLERANCES_M},
        "recall": {_cm(t): _share(drawn.near(*wanted, t).sum(), len(wanted[0])) for t in TOLERANCES_M},
    }


@dataclass(frozen=True)
class Spans:
    """Wall-to-wall distances (N,): true, in the plan (NaN where it has none), and whether both ends are walls of one room."""

    length_m: Array
    plan_m: Array
    in_room: Array


def wall_to_wall(case: Case, seed: int = 0) -> Spans:
    """300 wall-to-wall distances along the axes through points on the path, plan against truth."""
    rng = np.random.default_rng(seed)
    true, drawn = true_lines(case, ("wall", "column", "jamb")), drawn_lines(case)[0]
    seen = true_lines(case, ("wall", "column", "jamb"), seen=True)
    rooms = [Polygon(space["outline"], space["holes"]).buffer(BESIDE_M) for space in case.truth["spaces"]]
    spans: list[tuple[float, float, bool]] = []
    for _ in range(SPANS * 20):
        row, axis = int(rng.integers(len(case.path_true_m))), int(rng.integers(2))
        span = _span(true, case.path_true_m[row], axis)
        if span is None or not _ends_seen(seen, span, case.path_true_m[row], axis):
            continue
        found = _span(drawn, case.path_plan_m[row], axis)
        ends = np.tile(case.path_true_m[row, :2], (2, 1))
        ends[:, axis] = span
        spans.append((span[1] - span[0], np.nan if found is None else found[1] - found[0], any(r.covers(LineString(ends)) for r in rooms)))
        if len(spans) == SPANS:
            break
    length, plan, in_room = np.array(spans, dtype=float).reshape(-1, 3).T
    return Spans(length, plan, in_room > 0)


def span_scores(case: Case, seed: int = 0) -> dict[str, Any]:
    """How far `wall_to_wall` distances of the plan are off."""
    spans = wall_to_wall(case, seed)
    length, error = spans.length_m, np.abs(spans.plan_m - spans.length_m)
    good = error <= MISSED_M
    long = good & (length > LONG_SPAN_M)
    return {
        "count": len(length),
        "missed": _share((~good).sum(), len(length)),
        "mean_relative": _mean(error[good] / length[good]),
        "p95_m": float(np.percentile(error[good], 95)) if good.any() else None,
        "long_mean_relative": _mean(error[long] / length[long]),
    }


def _span(lines: Lines, point: Array, axis: int) -> tuple[float, float] | None:
    """Nearest lines below and above the point along `axis`; None where one side is open."""
    across = (lines.axis == axis) & (lines.low <= point[1 - axis]) & (lines.high >= point[1 - axis])
    offsets = lines.offset[across]
    below, above = offsets[offsets < point[axis]], offsets[offsets >= point[axis]]
    return (float(below.max()), float(above.min())) if len(below) and len(above) else None


def _ends_seen(seen: Lines, span: tuple[float, float], point: Array, axis: int) -> bool:
    place = np.full(2, point[1 - axis])
    return bool(seen.near(np.full(2, axis), np.array(span), place, 1e-3).all())


def thickness_scores(case: Case) -> dict[str, Any]:
    """Measured thickness of walls with two faces against the true faces they lie on."""
    true = true_lines(case, ("wall",))
    faces = {face["id"]: face for face in case.plan["faces"]}
    errors = []
    for wall in case.plan["walls"]:
        pair = [case.placement.xy([faces[f]["start"], faces[f]["end"]]) for f in wall["faces"] if f in faces]
        if wall["thickness_m"] is None or len(pair) < 2:
            continue
        axis = int(np.argmin(np.abs(pair[0][1] - pair[0][0])))
        offsets = [float(ends[0, axis]) for ends in pair]
        low, high = min(offsets), max(offsets)
        along = max(min(e[:, 1 - axis]) for e in pair), min(max(e[:, 1 - axis]) for e in pair)
        place = sum(along) / 2
        # The two faces of a wall look away from each other: the lower one faces down its axis.
        ends = [_nearest(true, axis, sign, value, place) for sign, value in ((-1, low), (1, high))]
        if ends[0] is not None and ends[1] is not None:
            errors.append(abs(wall["thickness_m"] - (ends[1] - ends[0])))
    return {"count": len(errors), "mean_error_m": _mean(np.array(errors))}


def dimension_scores(case: Case) -> dict[str, Any]:
    """How often the true distance lies within a dimension's 95 % interval (along x and y)."""
    true = true_lines(case, ("wall", "column", "jamb", "sill"))
    planes = {plane["id"]: plane for plane in case.plan["planes"]}
    inside, ratios = [], []
    for dimension in case.plan["dimensions"]:
        if dimension["axis"] == 2:
            continue
        ends = []
        for plane_id, point in ((dimension["from_plane"], dimension["start"]), (dimension["to_plane"], dimension["end"])):
            plane = planes[plane_id]
            normal = case.placement.vector(plane["axis"], plane["facing"])
            axis = int(np.argmax(np.abs(normal)))
            xy = case.placement.xy(point)
            ends.append(_nearest(true, axis, int(np.sign(normal[axis])), float(xy[axis]), float(xy[1 - axis])))
        if ends[0] is not None and ends[1] is not None:
            error = abs(dimension["distance_m"] - abs(ends[1] - ends[0]))
            inside.append(error <= Z95 * dimension["sigma_m"])
            ratios.append(error / max(dimension["sigma_m"], 1e-9))
    return {"count": len(inside), "within_95": _mean(np.array(inside)), "median_error_over_sigma": _median(ratios)}


def _nearest(lines: Lines, axis: int, facing: int, offset: float, along: float) -> float | None:
    """Offset of the nearest true face of that axis and facing beside the place; None where there is none."""
    beside = (lines.axis == axis) & (lines.facing == facing) & (lines.low - SNAP_M <= along) & (along <= lines.high + SNAP_M)
    offsets = lines.offset[beside & (np.abs(lines.offset - offset) < SNAP_M)]
    return float(offsets[np.argmin(np.abs(offsets - offset))]) if len(offsets) else None


def _cm(tolerance_m: float) -> str:
    return f"{round(tolerance_m * 100)}cm"


def _share(part: float, whole: float) -> float | None:
    return float(part / whole) if whole else None


def _mean(values: Array) -> float | None:
    return float(values.mean()) if len(values) else None


def _median(values: list[float]) -> float | None:
    return float(np.median(values)) if values else None
