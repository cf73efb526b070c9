"""Doubled faces: one wall drawn twice because frames disagree about where it stands; the better supported one stays."""

from collections import defaultdict
from dataclasses import replace
from itertools import combinations

import numpy as np

from floorplan.config import PlanConfig
from floorplan.model.checks import Array
from floorplan.model.plan import Rejection
from floorplan.plan.corners import FaceRun, with_ends
from floorplan.plan.faces import Reason
from floorplan.plan.surface_evidence import PlaneEvidence

BOTH_HIT_SHARE = 0.3  # share of the common columns in which rays hit both surfaces at wall height
CLEARLY = 2.0  # times the rays of the other on the common stretch: there it is the real one, however long the other is elsewhere


def without_doubles(
    faces: tuple[FaceRun, ...], evidence: tuple[PlaneEvidence, ...], config: PlanConfig, heights: bool
) -> tuple[tuple[FaceRun, ...], tuple[Rejection, ...]]:
    """Faces cut back where a better supported face of equal facing, less than a wall's thickness off, was hit in the same columns.

    A ray cannot reach a surface behind a wall: where rays hit both at the same height, one of the two is an error of
    the poses, or of a few readings. A panel before a wall stays, for nothing behind it is hit.
    """
    by_plane = {item.plane: item for item in evidence}
    cuts: dict[int, list[tuple[float, float]]] = defaultdict(list)
    for a, b in combinations(range(len(faces)), 2):
        low, high = max(faces[a].start_m, faces[b].start_m), min(faces[a].end_m, faces[b].end_m)
        if high <= low or not _alike(faces[a], faces[b], config):
            continue
        hits = [_column_hits(by_plane[faces[k].run.plane], low, high, config, heights) for k in (a, b)]
        if _both_hit(*hits):
            cuts[_weaker((a, b), faces, hits)].append((low, high))
    kept = [part for k, face in enumerate(faces) for part in _without(face, cuts[k], config)]
    before, after = (sum(face.run.length_m for face in some) for some in (faces, kept))
    touched = sum(1 for stretches in cuts.values() if stretches)
    rejections = (Rejection(str(Reason.DOUBLED), touched, float(before - after)),) if touched else ()
    return tuple(sorted(kept, key=lambda f: (f.run.plane, f.start_m))), rejections


def _weaker(pair: tuple[int, int], faces: tuple[FaceRun, ...], hits: list[Array]) -> int:
    """The one of less support on the whole, unless the common stretch speaks clearly for it."""
    first, second = float(hits[0].sum()), float(hits[1].sum())
    if max(first, second) >= CLEARLY * min(first, second):
        return pair[0] if first < second else pair[1]
    return min(pair, key=lambda k: (faces[k].run.hits, -faces[k].run.plane, -faces[k].start_m))


def _alike(face: FaceRun, better: FaceRun, config: PlanConfig) -> bool:
    near = abs(face.offset_m - better.offset_m) <= config.max_thickness_m
    return face.axis == better.axis and face.facing == better.facing and near and face.run.plane != better.run.plane


def _without(face: FaceRun, stretches: list[tuple[float, float]], config: PlanConfig) -> list[FaceRun]:
    """What is left of a face outside some stretches of it."""
    parts = [face]
    for low, high in stretches:
        parts = [part for piece in parts for part in _cut(piece, low, high, config)]
    return parts


def _cut(face: FaceRun, low: float, high: float, config: PlanConfig) -> list[FaceRun]:
    if min(face.end_m, high) <= max(face.start_m, low):
        return [face]
    parts = []
    for start, end in ((face.start_m, low), (high, face.end_m)):
        if end - start >= config.min_wall_length_m:
            part = with_ends(face, start, end)
            hits = face.run.hits * (end - start) / face.run.length_m
            opens = (face.run.open_start and start == face.start_m, face.run.open_end and end == face.end_m)
            parts.append(replace(part, run=replace(part.run, hits=hits, open_start=opens[0], open_end=opens[1])))
    return parts


def _column_hits(item: PlaneEvidence, low_m: float, high_m: float, config: PlanConfig, heights: bool) -> Array:
    """Rays that hit each column between two coordinates at wall height."""
    rows = slice(item.row(config.wall_band_low_m), item.row(config.wall_band_high_m)) if heights else slice(0, 1)
    first = round((low_m - item.along_start_m) / item.along_step_m)
    last = max(round((high_m - item.along_start_m) / item.along_step_m), first + 1)
    return np.asarray(item.hits[first:last, rows].sum(axis=1))


def _both_hit(first: Array, second: Array) -> bool:
    size = min(len(first), len(second))
    return bool(size and np.mean((first[:size] > 0) & (second[:size] > 0)) >= BOTH_HIT_SHARE)
