"""Panes in wide gaps of a wall: most rays went through, a few came back from one line within the wall's depth."""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from floorplan.config import PlanConfig
from floorplan.model.checks import Array
from floorplan.plan.corners import FaceRun
from floorplan.plan.gaps import Gap
from floorplan.plan.glazing import STEP_M, GlazedLine
from floorplan.plan.plan_frame import PlanWorld
from floorplan.plan.surface_evidence import MAX_LINE_GAP_M

BIN_M = 0.10  # grain along the gap
LINE_BIN_M = 0.02  # grain across it
LINE_HALF_WIDTH_M = 0.03  # returns of one pane scatter by the sensor's noise only
JAMB_M = 0.10  # beside the ends of the wall its own jambs and the trails of their edges return rays
COVERED_SHARE = 0.6  # of the bins along the gap must return something from the pane and let something through
ON_LINE_SHARE = 0.5  # of what a bin returns from within the wall's depth: flying points of edges lie anywhere in it
THROUGH_SHARE = 0.1  # of a bin's returns must have gone on at least: glass is not met head-on from everywhere
MIN_RETURNS = 20  # of a pane altogether
MIN_RAYS = 2  # that went through the median bin


@dataclass(frozen=True)
class _Stretch:
    """A gap of a wall's line: between two runs, looked at from `facing`."""

    axis: int
    facing: int
    offset_m: float
    start_m: float
    end_m: float


def paned_gaps(
    world: PlanWorld, faces: tuple[FaceRun, ...], gaps: tuple[Gap, ...], known: tuple[GlazedLine, ...], config: PlanConfig
) -> tuple[GlazedLine, ...]:
    """Glazing from jamb to jamb for gaps that hold a pane; none over sills (those are windows), in `known` glazing or for level sweeps."""
    if not world.heights:
        return ()
    z = world.point_m[:, 2]
    rows = np.flatnonzero((z > config.wall_band_low_m) & (z < config.wall_band_high_m))
    rays = _Rays(world.trajectory.position_m, world.point_frame[rows], world.point_m[rows])
    windows = [(faces[gap.face].axis, faces[gap.face].offset_m, gap.start_m, gap.end_m) for gap in gaps if gap.is_window]
    found: list[GlazedLine] = []
    for stretch in _stretches(faces, config):
        taken = [*windows, *((line.axis, line.offset_m, line.start_m, line.end_m) for line in (*known, *found))]
        if any(_overlaps(stretch, *one, config.max_thickness_m) for one in taken):
            continue
        pane = _pane(rays, stretch, config)
        if pane is not None:
            found.append(pane)
    return tuple(found)


def _stretches(faces: tuple[FaceRun, ...], config: PlanConfig) -> Iterator[_Stretch]:
    """Gaps wider than a door, glazed or not, from an end of a wall to the next one in line (give or take a thickness) or across it."""
    for face in faces:
        for direction in (-1, +1):
            end = face.end_m if direction > 0 else face.start_m
            width = min((distance for other in faces if (distance := _ahead_m(face, other, end, direction)) > 0), default=np.inf)
            if config.max_door_width_m < width <= MAX_LINE_GAP_M and not face.inner[direction > 0]:
                low, high = sorted((end, end + direction * width))
                yield _Stretch(face.axis, face.facing, face.offset_m, low, high)


def _ahead_m(face: FaceRun, other: FaceRun, end_m: float, direction: int) -> float:
    """How far ahead of a face's end another one begins that goes on beside its line or stands across it; 0 where it does neither."""
    if other.axis == face.axis:
        beside = other.facing == face.facing and abs(other.offset_m - face.offset_m) <= STEP_M
        at = other.start_m if direction > 0 else other.end_m
    else:
        beside = other.facing == -direction and other.start_m - STEP_M <= face.offset_m <= other.end_m + STEP_M
        at = other.offset_m
    return max((at - end_m) * direction, 0.0) if beside else 0.0


def _overlaps(stretch: _Stretch, axis: int, offset_m: float, start_m: float, end_m: float, reach_m: float) -> bool:
    near = axis == stretch.axis and abs(offset_m - stretch.offset_m) <= reach_m
    return near and min(end_m, stretch.end_m) > max(start_m, stretch.start_m)


@dataclass(frozen=True)
class _Rays:
    """The rays that end at wall height: they begin at `sensor_m (F, 3)` of their `frame (R,)` and end at `point_m (R, 3)`."""

    sensor_m: Array
    frame: Array
    point_m: Array


def _pane(rays: _Rays, stretch: _Stretch, config: PlanConfig) -> GlazedLine | None:
    """The line within the wall's depth that returns rays from nearly the whole gap while more rays pass it."""
    low, high = stretch.start_m + JAMB_M, stretch.end_m - JAMB_M
    edges = np.linspace(low, high, max(int((high - low) / BIN_M), 2) + 1)
    depth = (stretch.offset_m - rays.point_m[:, stretch.axis]) * stretch.facing
    rows = np.flatnonzero((depth > -LINE_HALF_WIDTH_M) & (depth < config.max_thickness_m))
    along, depth = rays.point_m[rows, 1 - stretch.axis], depth[rows]
    beside = (along > low) & (along < high)
    along, depth = along[beside], depth[beside]
    if not len(depth):
        return None
    line = _densest(depth)
    on_line = np.abs(depth - line) <= LINE_HALF_WIDTH_M
    if on_line.sum() < MIN_RETURNS:
        return None
    anywhere, returned = (np.histogram(part, bins=edges)[0] for part in (along, along[on_line]))
    offset = stretch.offset_m - stretch.facing * line
    through = _through(rays, stretch.axis, offset, edges)
    glassy = (returned > 0) & (returned >= ON_LINE_SHARE * anywhere) & (through >= np.maximum(THROUGH_SHARE * returned, 1))
    if glassy.mean() < COVERED_SHARE or np.median(through) < MIN_RAYS:
        return None
    return GlazedLine(stretch.axis, float(offset), stretch.start_m, stretch.end_m)


def _densest(depth: Array) -> float:
    """Middle of the fullest window of a line's width."""
    low = float(depth.min())
    counts = np.bincount(((depth - low) / LINE_BIN_M).astype(np.int64))
    width = round(2 * LINE_HALF_WIDTH_M / LINE_BIN_M)
    sums = np.convolve(counts, np.ones(width))[width - 1 :]
    first = low + int(np.argmax(sums)) * LINE_BIN_M
    return float(np.median(depth[(depth >= first) & (depth < first + width * LINE_BIN_M)]))


def _through(rays: _Rays, axis: int, offset: float, edges: Array) -> Array:
    """How many rays crossed the line in each bin, ending clearly beyond it."""
    before, beyond = rays.sensor_m[rays.frame, axis] - offset, rays.point_m[:, axis] - offset
    crossed = np.flatnonzero((before * beyond < 0) & (np.abs(beyond) > 2 * LINE_HALF_WIDTH_M))
    share = before[crossed] / (before - beyond)[crossed]
    start = rays.sensor_m[rays.frame[crossed], 1 - axis]
    along = start + share * (rays.point_m[crossed, 1 - axis] - start)
    return np.histogram(along, bins=edges)[0]
