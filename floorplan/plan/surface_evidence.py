"""What the rays say about every upright plane: per cell of it, hits, rays that passed through, rays that ended right before it."""

from concurrent.futures import Executor
from dataclasses import dataclass

import numpy as np

from floorplan.config import PlanConfig
from floorplan.model.checks import Array
from floorplan.model.segment import AXIS_X, AXIS_Y
from floorplan.plan.plan_frame import PlanWorld

FINE_CELLS = 10  # fine counts per cell along: edges of walls are placed to 5 mm
MARGIN_ALONG_M = 1.8  # beyond a plane's extent: wide enough for a door beside its end
LOWEST_M, HIGHEST_M = -0.3, 6.0  # heights above the floor that are looked at
NOISE_SIGMAS = 2.5  # readings farther off a surface than this are not on it
UNBOUNDED_M = 1e6  # higher than anything
LOOSE_MARGIN_M = 0.15  # a surface goes on this far beyond its segments, whose ends are trimmed; a skewed wall soon leaves it
SAME_SURFACE_M = 0.06  # faces of equal facing less than this apart continue each other across an opening
MAX_LINE_GAP_M = 8.0  # a longer stretch between two planes in line is no gap of one wall
NEAR_M = 1.0  # readings this far before a plane, or assigned to it, still concern it: past a cabinet's depth
MIN_TOLERANCE_M = 0.04  # what the poses alone may be off between frames


@dataclass(frozen=True)
class PlaneEvidence:
    """Ray counts on one upright plane, weighted in pixels; U columns along it, Z rows up.

    Column c begins at `along_start_m + c * along_step_m`, row r at `up_start_m + r * up_step_m` above the floor.
    `hits`, `passes`, `blocked (U, Z)`; `fine_hits`, `fine_passes (U * FINE_CELLS,)` within the wall band;
    `hit_from (K, 2)` the pairs of a column and a keyframe that hit it, ordered.
    """

    plane: int
    along_start_m: float
    along_step_m: float
    up_start_m: float
    up_step_m: float
    hits: Array
    passes: Array
    blocked: Array
    fine_hits: Array
    fine_passes: Array
    hit_from: Array

    def row(self, height_m: float) -> int:
        """Row of a height, clipped to the grid."""
        return int(np.clip(np.floor((height_m - self.up_start_m) / self.up_step_m + 1e-6), 0, self.hits.shape[1]))

    def frames(self, first: int, last: int) -> int:
        """How many keyframes hit the columns `first` to `last` (exclusive)."""
        begin, end = np.searchsorted(self.hit_from[:, 0], (first, last))
        return len(np.unique(self.hit_from[begin:end, 1]))

    def along_m(self, column: int) -> float:
        """Coordinate at which a column begins."""
        return self.along_start_m + column * self.along_step_m


def tolerance_m(world: PlanWorld) -> Array:
    """How far (P,) from a surface each reading may lie and still be of it."""
    return np.maximum(MIN_TOLERANCE_M, NOISE_SIGMAS * world.point_sigma_m)


def surface_evidence(world: PlanWorld, config: PlanConfig, workers: Executor) -> tuple[PlaneEvidence, ...]:
    """Counts for every plane along x or y; `workers` count the rays of several planes at a time."""
    from floorplan.plan.ray_kernels import frame_boxes

    upright = np.flatnonzero((world.plane_axis == AXIS_X) | (world.plane_axis == AXIS_Y))
    start = np.searchsorted(world.point_frame, np.arange(len(world.trajectory.position_m) + 1))
    tolerance, box = tolerance_m(world), frame_boxes(world.trajectory.position_m, world.point_m, start)
    rays = _Rays(tolerance, start, box, max(NEAR_M, float(tolerance.max(initial=0.0))))
    return tuple(workers.map(lambda plane: _count(world, plane, rays, config), upright.tolist()))


@dataclass(frozen=True)
class _Rays:
    """All rays: `tolerance_m (P,)`; those of keyframe f are rows `start[f]` to `start[f + 1]` and stay within `box_m[f]` (F, 2, 2).

    Those that end within `reach_m` of a plane concern it.
    """

    tolerance_m: Array
    start: Array
    box_m: Array
    reach_m: float

    def near(self, axis: int, offset_m: float, low_m: float, high_m: float) -> Array:
        """Which keyframes (F,) have rays that come near the stretch `low_m` to `high_m` of a plane."""
        across, along = self.box_m[:, axis], self.box_m[:, 1 - axis]
        beside = (along[:, 0] <= high_m) & (along[:, 1] >= low_m)
        return np.asarray(beside & (across[:, 0] - self.reach_m <= offset_m) & (across[:, 1] + self.reach_m >= offset_m))


def _count(world: PlanWorld, plane: int, rays: _Rays, config: PlanConfig) -> PlaneEvidence:
    from floorplan.plan.ray_kernels import count_rays

    low, high = world.plane_extent_m[plane, 1 - int(world.plane_axis[plane])]
    step = config.cell_along_m
    start = float(np.floor((low - MARGIN_ALONG_M) / step) * step)
    columns = int(np.ceil((high + MARGIN_ALONG_M - start) / step))
    up_start, up_step, rows = LOWEST_M, config.cell_up_m, round((HIGHEST_M - LOWEST_M) / config.cell_up_m)
    band = np.array([config.wall_band_low_m, config.wall_band_high_m])
    if not world.heights:  # one row that holds everything: a level sweep knows no heights
        up_start, up_step, rows, band = -UNBOUNDED_M, 2 * UNBOUNDED_M, 1, np.array([-np.inf, np.inf])
    counts, fine = np.zeros((3, columns, rows)), np.zeros((3, columns * FINE_CELLS))
    seen = np.zeros((columns, len(world.trajectory.position_m)), dtype=np.bool_)
    axis, offset_m = int(world.plane_axis[plane]), float(world.plane_offset_m[plane])
    count_rays(
        world.trajectory.position_m,
        world.point_m,
        rays.start,
        rays.near(axis, offset_m, start, start + columns * step),
        world.point_plane,
        world.point_weight,
        rays.tolerance_m,
        plane,
        axis,
        int(world.plane_facing[plane]),
        offset_m,
        _reach(world, plane),
        np.array([start, up_start, step, up_step]),
        band,
        counts,
        fine,
        seen,
    )
    pairs = np.argwhere(seen).astype(np.int32)
    return PlaneEvidence(plane, start, step, up_start, up_step, counts[0], counts[1], counts[2], fine[0], fine[1], pairs)


def _reach(world: PlanWorld, plane: int) -> Array:
    """Where points of no plane may belong to this one: its extent, gaps to planes in line, a margin (along low, high, up low, high)."""
    along, up = _in_line(world, plane), world.plane_extent_m[plane, 2]
    box = np.array([along[0] - LOOSE_MARGIN_M, along[1] + LOOSE_MARGIN_M, up[0] - LOOSE_MARGIN_M, up[1] + LOOSE_MARGIN_M])
    return np.where(np.isnan(box), [-np.inf, np.inf, -np.inf, np.inf], box)


def _in_line(world: PlanWorld, plane: int) -> Array:
    """Extent along it (low, high) of a plane and of the gaps to those that continue it: posts too slender for segments stand there."""
    axis = int(world.plane_axis[plane])
    extent = world.plane_extent_m[:, 1 - axis]
    same = (world.plane_axis == axis) & (world.plane_facing == world.plane_facing[plane])
    same &= np.abs(world.plane_offset_m - world.plane_offset_m[plane]) <= SAME_SURFACE_M
    low, high = extent[plane]
    before, after = extent[same & (extent[:, 1] < low), 1], extent[same & (extent[:, 0] > high), 0]
    if len(before) and low - before.max() <= MAX_LINE_GAP_M:
        low = before.max()
    if len(after) and after.min() - high <= MAX_LINE_GAP_M:
        high = after.min()
    return np.array([low, high])
