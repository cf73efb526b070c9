"""The report's tables: accuracy per dimension, residuals per plane, merges with reasons, coverage."""

import math
from collections import Counter
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from floorplan.laser.compare import level_of
from floorplan.merge_table import MergeRow, merge_rows
from floorplan.model.normal import NORMAL_95
from floorplan.model.plan import Plan, Point
from floorplan.results import Results

MOST_MERGES = 300  # rows of the table: the accepted ones that are furthest apart and the rejected ones that are nearest come first
POOR_FRAMES = 5  # a plane seen in fewer keyframes is told as badly seen


@dataclass(frozen=True)
class AccuracyRow:
    """One dimension with the half width of its 95 % interval and the level that promises."""

    id: str
    room: str
    between: str
    distance_m: float
    interval_m: float
    level: str


@dataclass(frozen=True)
class PlaneRow:
    """One final plane: what it was made of, and how well its measurements fit (RMS, m)."""

    id: str
    normal: str
    offset_m: float
    sigma_m: float
    tracks: int
    frames: int
    rows: int
    residual_m: float
    poor: bool


@dataclass(frozen=True)
class Count:
    """How many of what."""

    name: str
    count: int


@dataclass(frozen=True)
class Coverage:
    """What was seen well, badly, not at all."""

    seen_m: float
    inferred_m: float
    unvisited: tuple[str, ...]
    partial: tuple[str, ...]
    poor_planes: int
    unmeasured_frames: int
    frames: int


def accuracy_rows(plan: Plan) -> tuple[AccuracyRow, ...]:
    """Every dimension, heights too."""
    return tuple(
        AccuracyRow(d.id, d.room, f"{d.from_plane} to {d.to_plane}", d.distance_m, NORMAL_95 * d.sigma_m, level_of(NORMAL_95 * d.sigma_m))
        for d in plan.dimensions
    )


def plane_rows(results: Results) -> tuple[PlaneRow, ...]:
    """Every plane of the plan: those of the solution in its order, then lines found in the readings, which have no rows."""
    graph, solution = results.layout.graph, results.solution
    scale = solution.calibration.scale if solution.calibration else 1.0
    plane = solution.plane_of_track[graph.track]
    predicted = solution.plane_offset_m[plane] - solution.position_m[graph.frame, graph.axis[graph.track]]
    planes = max(len(results.plan.planes), len(solution.plane_axis))
    square = np.bincount(plane, (predicted - scale * graph.distance_m) ** 2, planes)
    rows = np.bincount(plane, minlength=planes)
    residual = np.sqrt(square / np.maximum(rows, 1))
    return tuple(
        PlaneRow(
            p.id, f"{'+' if p.facing > 0 else '-'}{'xyz'[p.axis]}", p.offset_m, p.sigma_m, len(p.tracks), p.frames, int(rows[k]),
            float(residual[k]), p.frames < POOR_FRAMES,
        )
        for k, p in enumerate(results.plan.planes)
    )  # fmt: skip


def verdict_counts(results: Results) -> tuple[Count, ...]:
    """How many hypotheses ended in each way."""
    counted = Counter(verdict.value for verdict in results.merged.hypotheses.verdict)
    return tuple(Count(name, count) for name, count in counted.most_common())


def told_merges(results: Results) -> tuple[MergeRow, ...]:
    """The hypotheses most worth a look: far ones that were accepted, near ones that were not."""
    rows = merge_rows(results.scan, results.layout, results.merged)
    return tuple(sorted(rows, key=lambda row: -abs(row.distance_m) if row.accepted else abs(row.distance_m) - 1.0)[:MOST_MERGES])


def coverage(results: Results) -> Coverage:
    """Lengths of wall, rooms, planes and frames."""
    plan = results.plan
    measured = results.segmented.frames.measured
    return Coverage(
        seen_m=sum(_length_m(line) for wall in plan.walls for line in wall.seen),
        inferred_m=sum(_length_m(line) for wall in plan.walls for line in wall.inferred),
        unvisited=tuple(room.id for room in plan.rooms if not room.visited),
        partial=tuple(room.id for room in plan.rooms if room.partial),
        poor_planes=sum(plane.frames < POOR_FRAMES for plane in plan.planes),
        unmeasured_frames=int((~measured).sum()),
        frames=len(measured),
    )


def _length_m(line: tuple[Point, ...]) -> float:
    return sum(math.dist(a, b) for a, b in pairwise(line))
