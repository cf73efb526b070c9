"""Doubled faces: one wall drawn twice because frames disagree about where it stands; the better supported one stays."""

from dataclasses import replace

import numpy as np

from floorplan.config import PlanConfig
from floorplan.model.plan import Rejection
from floorplan.plan.corners import FaceRun, with_ends
from floorplan.plan.faces import Reason
from floorplan.plan.surface_evidence import PlaneEvidence

BOTH_HIT_SHARE = 0.3  # share of the common columns in which rays hit both surfaces at wall height


def without_doubles(
    faces: tuple[FaceRun, ...], evidence: tuple[PlaneEvidence, ...], config: PlanConfig, heights: bool
) -> tuple[tuple[FaceRun, ...], tuple[Rejection, ...]]:
    """Faces cut back where a better supported face of equal facing, less than a wall's thickness off, was hit in the same columns.

    A ray cannot reach a surface behind a wall: where rays hit both at the same height, one of the two is an error of
    the poses. A panel before a wall stays, for nothing behind it is hit.
    """
    by_plane = {item.plane: item for item in evidence}
    kept: list[FaceRun] = []
    lost: list[float] = []
    for face in sorted(faces, key=lambda f: (-f.run.hits, f.run.plane, f.start_m)):
        rest = [face]
        for better in kept:
            if _alike(face, better, config):
                rest = [part for piece in rest for part in _cut(piece, better, by_plane, config, heights)]
        lost.append(face.run.length_m - sum(part.run.length_m for part in rest))
        kept += rest
    lengths = [length for length in lost if length > 0]
    rejections = (Rejection(str(Reason.DOUBLED), len(lengths), float(sum(lengths))),) if lengths else ()
    return tuple(sorted(kept, key=lambda f: (f.run.plane, f.start_m))), rejections


def _alike(face: FaceRun, better: FaceRun, config: PlanConfig) -> bool:
    near = abs(face.offset_m - better.offset_m) <= config.max_thickness_m
    return face.axis == better.axis and face.facing == better.facing and near and face.run.plane != better.run.plane


def _cut(face: FaceRun, better: FaceRun, by_plane: dict[int, PlaneEvidence], config: PlanConfig, heights: bool) -> list[FaceRun]:
    low, high = max(face.start_m, better.start_m), min(face.end_m, better.end_m)
    if high <= low or not _both_hit(by_plane[face.run.plane], by_plane[better.run.plane], low, high, config, heights):
        return [face]
    parts = []
    for start, end in ((face.start_m, low), (high, face.end_m)):
        if end - start >= config.min_wall_length_m:
            part = with_ends(face, start, end)
            hits = face.run.hits * (end - start) / face.run.length_m
            opens = (face.run.open_start and start == face.start_m, face.run.open_end and end == face.end_m)
            parts.append(replace(part, run=replace(part.run, hits=hits, open_start=opens[0], open_end=opens[1])))
    return parts


def _both_hit(a: PlaneEvidence, b: PlaneEvidence, low_m: float, high_m: float, config: PlanConfig, heights: bool) -> bool:
    masks = []
    for item in (a, b):
        rows = slice(item.row(config.wall_band_low_m), item.row(config.wall_band_high_m)) if heights else slice(0, 1)
        first = round((low_m - item.along_start_m) / item.along_step_m)
        last = max(round((high_m - item.along_start_m) / item.along_step_m), first + 1)
        masks.append(item.hits[first:last, rows].sum(axis=1) > 0)
    size = min(len(masks[0]), len(masks[1]))
    return bool(size and np.mean(masks[0][:size] & masks[1][:size]) >= BOTH_HIT_SHARE)
