"""Surfaces that gave no segments: piers' sides, and walls seen at a slant through a door, found as lines in the readings of many frames."""

from concurrent.futures import Executor
from dataclasses import dataclass, replace

import numpy as np

from floorplan.config import PlanConfig
from floorplan.model.checks import Array
from floorplan.model.plan import FreeLine
from floorplan.model.segment import AXIS_X, AXIS_Y, FreePatches
from floorplan.plan.free_lines import free_lines
from floorplan.plan.plan_frame import PlanWorld
from floorplan.plan.storeys import floor_heights_m, frames_of_storeys
from floorplan.plan.surface_evidence import MAX_LINE_GAP_M, tolerance_m

LINE_BIN_M = 0.01  # grain across the line ...
ALONG_BIN_M = 0.05  # ... and along it
HALF_WIDTH_BINS = 3  # of a line: what noise of 1.5 cm and frames a centimetre off leave
HALF_VICINITY_BINS = 12  # readings this near count against a line: furniture and scatter fill the vicinity, a wall does not
ON_LINE_SHARE = 0.6  # of a bin's vicinity that lies on the line
MIN_IN_BIN = 2  # readings
MAX_GAP_BINS = 2  # without any
MIN_INCIDENCE = 0.15  # sine of 9 degrees: trails of flying points behind edges lie along the rays
MIN_READINGS = 20  # of a line
MAX_SLOPE = 0.035  # 2 degrees: what stands farther off the axes is a free line
SLOPE_SIGMAS = 2.0  # the slope of a short line is known badly
MIN_SPREAD_M = 1e-3  # of readings along a line
SAME_PLANE_M = 0.02  # a line this near to a known plane continues it
EXPLAINED_BINS = 2  # beside a plane's own readings, along it, what lies on the plane is of it
REFINEMENTS = 3  # rounds of the offset on the readings near it: it moves by less than 1 mm then


def with_overlooked(world: PlanWorld, loose: Array, patches: FreePatches, config: PlanConfig, workers: Executor) -> PlanWorld:
    """The world with planes, after those of the solution, for lines of `loose (P,)` readings at wall height that lie on no plane.

    Their readings become the plane's, those of a line that continues a known plane that plane's. Their offsets are the
    readings' mean under the final poses: they are drawn where they stand, but take no part in the solution. Readings of
    which a line off the axes (of `patches`) explains more are left to it. Level sweeps stay as they are: they have a segment
    wherever three readings stand in line. `workers` look along several axes at a time.
    """
    if not world.heights:
        return world
    above = world.point_m[:, 2] - _floor_m(world)
    rows = np.flatnonzero(loose & (above > config.wall_band_low_m) & (above < config.wall_band_high_m))
    sides = [(axis, facing) for axis in (AXIS_X, AXIS_Y) for facing in (-1, 1)]
    found = workers.map(lambda side: _lines(world, rows, side[0], side[1], config), sides)
    lines = [line for of_side in found for line in of_side]
    candidates: list[_Line | _Skewed] = [*lines, *(_readings_on(world, rows, line) for line in free_lines(patches, world, (), config))]
    taken = np.zeros(len(world.point_m), dtype=bool)
    for line in sorted(candidates, key=lambda one: -len(one.rows)):
        free = line.rows[~taken[line.rows]]
        if len(free) < max(MIN_READINGS, len(line.rows) // 2):
            continue
        taken[free] = True
        if isinstance(line, _Line):
            world = _with_line(world, replace(line, rows=free))
    return world


@dataclass(frozen=True)
class _Line:
    """Readings `rows` on a line normal to `axis`, looked at from `facing`."""

    axis: int
    facing: int
    offset_m: float
    sigma_m: float
    rows: Array


@dataclass(frozen=True)
class _Skewed:
    """Readings `rows` on a line off the axes."""

    rows: Array


def _readings_on(world: PlanWorld, rows: Array, line: FreeLine) -> _Skewed:
    """The readings of `rows` that lie on a line off the axes."""
    start, end = np.array(line.start), np.array(line.end)
    length = float(np.linalg.norm(end - start))
    along = (end - start) / length
    offset = world.point_m[rows, :2] - start
    on = np.abs(offset @ np.array([-along[1], along[0]])) <= (HALF_WIDTH_BINS + 0.5) * LINE_BIN_M
    place = offset @ along
    return _Skewed(rows[on & (place >= 0) & (place <= length)])


def _floor_m(world: PlanWorld) -> Array:
    """Height (P,) of the floor that each reading was taken on: of its frame's storey."""
    floors = floor_heights_m(world)
    if len(floors) < 2:
        return np.zeros(len(world.point_m))
    of_frame = np.zeros(len(world.trajectory.position_m))
    for floor, frames in zip(floors, frames_of_storeys(world, floors), strict=True):
        of_frame[frames] = floor
    return of_frame[world.point_frame]


def _lines(world: PlanWorld, rows: Array, axis: int, facing: int, config: PlanConfig) -> list[_Line]:
    """Lines normal to one axis in the readings `rows` that look at it from `facing`."""
    ray = world.trajectory.position_m[world.point_frame[rows]] - world.point_m[rows]
    met = ray[:, axis] * facing >= MIN_INCIDENCE * np.linalg.norm(ray, axis=1)
    rows = rows[met]
    rows = rows[~_explained(world, rows, axis, facing)]
    if len(rows) < MIN_READINGS:
        return []
    grid = _Grid.of(world.point_m[rows, axis], world.point_m[rows, 1 - axis])
    found: list[_Line] = []
    free = np.ones(len(rows), dtype=bool)
    for bins in grid.runs():
        inside = np.flatnonzero(free & grid.within(bins))
        if len(inside) < MIN_READINGS:
            continue
        line = _fitted(world, rows[inside], axis, facing, config)
        if line is not None:
            free[np.isin(rows, line.rows)] = False
            found.append(line)
    return found


def _explained(world: PlanWorld, rows: Array, axis: int, facing: int) -> Array:
    """Which readings (N,) lie on a known plane beside readings of its own."""
    of_axis = np.zeros(len(world.plane_axis) + 1, dtype=bool)  # the last: NO_PLANE
    of_axis[:-1] = (world.plane_axis == axis) & (world.plane_facing == facing)
    along = np.floor(world.point_m[:, 1 - axis] / ALONG_BIN_M).astype(np.int64)
    reach, explained = tolerance_m(world)[rows], np.zeros(len(rows), dtype=bool)
    owned = np.flatnonzero(of_axis[world.point_plane])
    if not len(owned):
        return explained
    owned = owned[np.argsort(world.point_plane[owned], kind="stable")]
    planes, first = np.unique(world.point_plane[owned], return_index=True)
    order = np.argsort(world.point_m[rows, axis], kind="stable")
    across = world.point_m[rows[order], axis]
    for plane, mine in zip(planes, np.split(owned, first[1:]), strict=True):
        offset, widest = float(world.plane_offset_m[plane]), float(reach.max(initial=0.0))
        near = order[slice(*np.searchsorted(across, (offset - widest, offset + widest)))]
        near = near[np.abs(world.point_m[rows[near], axis] - offset) <= reach[near]]
        columns = np.unique(along[mine])
        behind = np.searchsorted(columns, along[rows[near]] - EXPLAINED_BINS)
        beside = columns[np.minimum(behind, len(columns) - 1)] - along[rows[near]]
        explained[near] |= np.abs(beside) <= EXPLAINED_BINS
    return explained


@dataclass(frozen=True)
class _Bins:
    """A run of bins: the middle one across, `first` to `last` (exclusive) along."""

    across: int
    first: int
    last: int


@dataclass(frozen=True)
class _Grid:
    """Readings' bins across and along a direction (N,), and how many lie on each line: `on_line`, `vicinity` (A, U)."""

    across: Array
    along: Array
    on_line: Array
    vicinity: Array

    @classmethod
    def of(cls, across_m: Array, along_m: Array) -> "_Grid":
        from floorplan.plan.line_kernels import counted_within

        across, along = (np.floor(x / step).astype(np.int64) for x, step in ((across_m, LINE_BIN_M), (along_m, ALONG_BIN_M)))
        across, along = across - across.min() + HALF_VICINITY_BINS, along - along.min()
        lines, columns = int(across.max()) + 1 + HALF_VICINITY_BINS, int(along.max()) + 1
        counted = counted_within(across, along, lines, columns, np.array([HALF_WIDTH_BINS, HALF_VICINITY_BINS]))
        return cls(across, along, counted[0], counted[1])

    def runs(self) -> list[_Bins]:
        """Stretches of bins on one line, those with the most readings first."""
        filled = (self.on_line >= MIN_IN_BIN) & (self.on_line >= ON_LINE_SHARE * self.vicinity)
        across, along = np.nonzero(filled)
        if not len(across):
            return []
        ends = np.flatnonzero((np.diff(across) != 0) | (np.diff(along) > MAX_GAP_BINS + 1))
        first, last = np.concatenate(([0], ends + 1)), np.concatenate((ends, [len(across) - 1]))
        readings = np.add.reduceat(self.on_line[across, along], first)
        order = np.lexsort((across[first], along[first], -readings))
        return [_Bins(int(across[first[k]]), int(along[first[k]]), int(along[last[k]]) + 1) for k in order if readings[k] >= MIN_READINGS]

    def within(self, bins: _Bins) -> Array:
        """Which readings (N,) lie in a run of bins, as wide as a line."""
        near = np.abs(self.across - bins.across) <= HALF_WIDTH_BINS
        return np.asarray(near & (self.along >= bins.first) & (self.along < bins.last))


def _fitted(world: PlanWorld, rows: Array, axis: int, facing: int, config: PlanConfig) -> _Line | None:
    """The line through readings, or None where too few frames saw it or it is skewed."""
    across, along = world.point_m[rows, axis], world.point_m[rows, 1 - axis]
    weight = world.point_sigma_m[rows] ** -2
    offset = float(np.median(across))
    half = (HALF_WIDTH_BINS + 0.5) * LINE_BIN_M
    near = np.abs(across - offset) <= half
    for _ in range(REFINEMENTS):
        offset = float(np.average(across[near], weights=weight[near]))
        near = np.abs(across - offset) <= half
    rows, across, along, weight = rows[near], across[near], along[near], weight[near]
    frames = np.unique(world.point_frame[rows])
    if len(rows) < MIN_READINGS or len(frames) < config.min_frames:
        return None
    slope, slope_sigma = _slope(across - offset, along, weight)
    if abs(slope) > MAX_SLOPE + SLOPE_SIGMAS * slope_sigma:
        return None
    scatter = float(np.sqrt(np.average((across - offset) ** 2, weights=weight)))
    known = world.plane_sigma_m[(world.plane_axis == axis) & (world.plane_frames > 0)]
    pose_sigma = float(np.median(known)) if len(known) else 0.0
    return _Line(axis, facing, offset, float(np.hypot(scatter / np.sqrt(len(frames)), pose_sigma)), rows)


def _slope(across: Array, along: Array, weight: Array) -> tuple[float, float]:
    """Slope of a line through readings and its standard deviation."""
    middle = np.average(along, weights=weight)
    spread = max(float(np.average((along - middle) ** 2, weights=weight)), MIN_SPREAD_M**2)
    slope = float(np.average(across * (along - middle), weights=weight)) / spread
    scatter = float(np.average((across - slope * (along - middle)) ** 2, weights=weight))
    return slope, float(np.sqrt(scatter / spread / len(across)))


def _with_line(world: PlanWorld, line: _Line) -> PlanWorld:
    """The world with one line's readings given to the plane that it continues, else to a new one."""
    points = world.point_m[line.rows]
    extent = np.stack((points.min(axis=0), points.max(axis=0)), axis=1)
    plane = _continued(world, line, extent)
    owner = np.array(world.point_plane)
    frames = len(np.unique(world.point_frame[line.rows]))
    if plane is not None:
        owner[line.rows] = plane
        extents = np.array(world.plane_extent_m)
        extents[plane, :, 0] = np.fmin(extents[plane, :, 0], extent[:, 0])
        extents[plane, :, 1] = np.fmax(extents[plane, :, 1], extent[:, 1])
        return replace(world, point_plane=owner, plane_extent_m=extents)
    owner[line.rows] = len(world.plane_axis)
    return replace(
        world,
        point_plane=owner,
        plane_axis=np.append(world.plane_axis, line.axis),
        plane_facing=np.append(world.plane_facing, line.facing),
        plane_offset_m=np.append(world.plane_offset_m, line.offset_m),
        plane_sigma_m=np.append(world.plane_sigma_m, line.sigma_m),
        plane_extent_m=np.concatenate((world.plane_extent_m, extent[None])),
        plane_frames=np.append(world.plane_frames, frames),
    )


def _continued(world: PlanWorld, line: _Line, extent: Array) -> int | None:
    """The nearest plane of the same facing, in line with a line and not far from it along."""
    along = 1 - line.axis
    apart = np.maximum(world.plane_extent_m[:, along, 0] - extent[along, 1], extent[along, 0] - world.plane_extent_m[:, along, 1])
    off = np.abs(world.plane_offset_m - line.offset_m)
    same = (world.plane_axis == line.axis) & (world.plane_facing == line.facing) & (off <= SAME_PLANE_M) & ~(apart > MAX_LINE_GAP_M)
    return int(np.argmin(np.where(same, off, np.inf))) if same.any() else None
