"""Where rays went: a grid of the floor whose crossed cells are free space."""

from dataclasses import dataclass

import numpy as np
import shapely
from shapely import Polygon

from floorplan.model.checks import Array
from floorplan.plan.plan_frame import PlanWorld
from floorplan.plan.surface_evidence import tolerance_m

CELL_M = 0.05  # grain of the grid
MIN_RAYS = 2  # one ray may be a stray reading


@dataclass(frozen=True)
class FreeSpace:
    """`integral (X + 1, Y + 1)`: crossed cells below and left of each grid corner; the grid begins at `corner_m (2,)`."""

    corner_m: Array
    integral: Array

    def share(self, x_m: Array, y_m: Array) -> Array:
        """Share (I-1, J-1) of every box of the arrangement of `x_m (I,)` and `y_m (J,)` that rays crossed, exact for thin boxes too."""
        sums = self._integral_at(np.asarray(x_m), np.asarray(y_m))
        inside = np.diff(np.diff(sums, axis=0), axis=1)
        return np.asarray(inside / (np.diff(x_m)[:, None] * np.diff(y_m)[None, :] / CELL_M**2))

    def share_of(self, area: Polygon) -> float:
        """Share of an area of any form that rays crossed, by the cells whose middles lie in it; 0 where it holds none."""
        low, high = np.reshape(area.bounds, (2, 2))
        first = np.clip(np.floor((low - self.corner_m) / CELL_M).astype(int), 0, np.array(self.integral.shape) - 2)
        last = np.clip(np.ceil((high - self.corner_m) / CELL_M).astype(int), first + 1, np.array(self.integral.shape) - 1)
        corners = self.integral[first[0] : last[0] + 1, first[1] : last[1] + 1]
        crossed = np.diff(np.diff(corners, axis=0), axis=1) > 0
        x, y = (self.corner_m[k] + (np.arange(first[k], last[k]) + 0.5) * CELL_M for k in (0, 1))
        inside = shapely.contains_xy(area, *np.meshgrid(x, y, indexing="ij"))
        return float(crossed[inside].mean()) if inside.any() else 0.0

    def _integral_at(self, x_m: Array, y_m: Array) -> Array:
        """Bilinear reading (I, J) of the integral: exact, for it is bilinear within cells."""
        u, a, s = _cell_and_rest((x_m - self.corner_m[0]) / CELL_M, self.integral.shape[0])
        v, b, t = _cell_and_rest((y_m - self.corner_m[1]) / CELL_M, self.integral.shape[1])
        low = self.integral[np.ix_(u, v)] * (1 - t) + self.integral[np.ix_(u, b)] * t
        high = self.integral[np.ix_(a, v)] * (1 - t) + self.integral[np.ix_(a, b)] * t
        return np.asarray(low * (1 - s[:, None]) + high * s[:, None])


def _cell_and_rest(index: Array, size: int) -> tuple[Array, Array, Array]:
    index = np.clip(index, 0, size - 1)
    low = np.minimum(np.floor(index).astype(np.int64), size - 2)
    return low, low + 1, index - low


def free_space(world: PlanWorld) -> FreeSpace:
    """The grid of all rays, from the sensor to just before what they hit."""
    corner, crossed = _crossed_cells(world)
    integral = np.zeros((crossed.shape[0] + 1, crossed.shape[1] + 1))
    integral[1:, 1:] = crossed.cumsum(axis=0).cumsum(axis=1)
    return FreeSpace(corner, integral)


def free_cells_xy_m(world: PlanWorld) -> Array:
    """Centres (C, 2) of the cells that rays crossed."""
    corner, crossed = _crossed_cells(world)
    return np.asarray((np.argwhere(crossed) + 0.5) * CELL_M + corner)


def _crossed_cells(world: PlanWorld) -> tuple[Array, Array]:
    """Lower left corner (2,) of the grid, and which of its cells were crossed by MIN_RAYS."""
    from floorplan.plan.ray_kernels import mark_free

    parts = [part[:, axis] for part in (world.point_m, world.trajectory.position_m) for axis in (0, 1) if len(part)]
    if not parts:
        return np.zeros(2), np.zeros((1, 1), dtype=bool)
    low, high = (np.reshape([extreme(part) for part in parts], (-1, 2)) for extreme in (np.min, np.max))
    low, high = low.min(axis=0), high.max(axis=0)
    corner = np.floor(low / CELL_M) * CELL_M - CELL_M
    size = np.ceil((high - corner) / CELL_M).astype(int) + 2
    crossed = np.zeros(tuple(size), dtype=np.int32)
    mark_free(world.trajectory.position_m, world.point_m, world.point_frame, tolerance_m(world), corner, CELL_M, crossed)
    return corner, crossed >= MIN_RAYS
