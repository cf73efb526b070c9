"""Walls that were seen only through glass: drawn as inferred, for a pane shows what is behind it and what is before it alike."""

from dataclasses import dataclass

import numpy as np

from floorplan.config import PlanConfig
from floorplan.model.checks import Array
from floorplan.model.plan import Rejection
from floorplan.plan.corners import FaceRun
from floorplan.plan.faces import MIN_GLIMPSED_M, Reason, Run, dense_spans
from floorplan.plan.glazing import GlazedLine
from floorplan.plan.plan_frame import PlanWorld
from floorplan.plan.surface_evidence import PlaneEvidence

MIN_BEHIND_M = 0.5  # nearer to the glass it is part of the partition
CLEARLY = 3.0  # times as many rays stopped as passed: through glass every reading may be a reflection
MIN_HEIGHT_M = 0.5  # of what was hit above the height of tables
MIRRORED_M = 0.15  # a surface this near to the mirror image of another one is that image
MIN_BESIDE_SHARE = 0.5  # of the surface's length that lies straight behind the glass


@dataclass(frozen=True)
class SeenThrough:
    """Surfaces behind glass without any part that counts as seen, and what was taken for a reflection."""

    faces: tuple[FaceRun, ...]
    rejections: tuple[Rejection, ...]


def walls_behind_glass(
    world: PlanWorld, evidence: tuple[PlaneEvidence, ...], faces: tuple[FaceRun, ...], glazed: tuple[GlazedLine, ...], config: PlanConfig
) -> SeenThrough:
    """Surfaces that look at a pane from behind and stopped most of the rays that came through it above table height."""
    drawn = {face.run.plane for face in faces}
    found: list[FaceRun] = []
    mirrored: list[float] = []
    for item in evidence if world.heights else ():
        for glass in glazed:
            if item.plane in drawn or not _faces_glass(world, item.plane, glass):
                continue
            for face in _stopping_runs(world, item, glass, config):
                if _is_reflection(world, face, glass, config):
                    mirrored.append(face.run.length_m)
                else:
                    found.append(face)
            break
    rejections = (Rejection(str(Reason.REFLECTION), len(mirrored), float(sum(mirrored))),) if mirrored else ()
    return SeenThrough(tuple(found), rejections)


def _faces_glass(world: PlanWorld, plane: int, glass: GlazedLine) -> bool:
    before = (glass.offset_m - float(world.plane_offset_m[plane])) * int(world.plane_facing[plane])
    return int(world.plane_axis[plane]) == glass.axis and before >= MIN_BEHIND_M


def _stopping_runs(world: PlanWorld, item: PlaneEvidence, glass: GlazedLine, config: PlanConfig) -> list[FaceRun]:
    """Long stretches of a plane that stopped rays, all of them from frames on the other side of the glass."""
    first_row = item.row(config.wall_band_low_m)
    hits, passes = item.hits[:, first_row:], item.passes[:, first_row:].sum(axis=1)
    stopped = hits.sum(axis=1)
    runs = []
    for first, last in dense_spans((stopped > CLEARLY * passes) & (stopped > 0)):
        start, end = item.along_m(first), item.along_m(last)
        rows = np.flatnonzero(hits[first:last].sum(axis=0) > 0)
        high_enough = len(rows) and (rows[-1] + 1 - rows[0]) * item.up_step_m >= MIN_HEIGHT_M
        beside = min(end, glass.end_m) - max(start, glass.start_m)
        frames = _frames(item, first, last)
        if end - start < MIN_GLIMPSED_M or not high_enough or beside < MIN_BESIDE_SHARE * (end - start) or len(frames) < config.min_frames:
            continue
        axis, facing = glass.axis, int(world.plane_facing[item.plane])
        if (((world.trajectory.position_m[frames, axis] - glass.offset_m) * facing) <= 0).any():
            continue  # seen from behind the glass too: judged like any other surface
        low = item.up_start_m + (first_row + rows[0]) * item.up_step_m
        high = item.up_start_m + (first_row + rows[-1] + 1) * item.up_step_m
        run = Run(item.plane, start, end, (), float(low), float(high), float(stopped[first:last].sum()))
        runs.append(FaceRun(run, axis, facing, float(world.plane_offset_m[item.plane]), float(world.plane_sigma_m[item.plane])))
    return runs


def _frames(item: PlaneEvidence, first: int, last: int) -> Array:
    """The keyframes whose segments lie on the columns `first` to `last` (exclusive)."""
    begin, end = np.searchsorted(item.hit_from[:, 0], (first, last))
    return np.unique(item.hit_from[begin:end, 1])


def _is_reflection(world: PlanWorld, face: FaceRun, glass: GlazedLine, config: PlanConfig) -> bool:
    """Whether a surface of the room stands where the glass would mirror it from."""
    image = 2 * glass.offset_m - face.offset_m
    extent = world.plane_extent_m[:, 1 - face.axis]
    same = (world.plane_axis == face.axis) & (world.plane_facing == -face.facing) & (world.plane_frames >= config.min_frames)
    overlap = np.minimum(extent[:, 1], face.end_m) - np.maximum(extent[:, 0], face.start_m)
    return bool((same & (np.abs(world.plane_offset_m - image) <= MIRRORED_M) & (overlap > 0)).any())
