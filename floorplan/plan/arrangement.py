"""The floor cut by all wall lines: cells that rays crossed, the barriers between them, and the regions they flood to."""

from dataclasses import dataclass

import numpy as np

from floorplan.model.checks import Array
from floorplan.plan.free_space import CELL_M, FreeSpace

INSIDE_SHARE = 0.5  # a cell is inside when rays crossed more than this share of it
THIN_M = 3 * CELL_M  # a cell thinner than this is judged by its neighbours: the grid cannot resolve it
SAME_LINE_M = 1e-6
THIN_ROUNDS = 3  # thin cells side by side are taken in one after the other
NO_REGION = -1


@dataclass(frozen=True)
class Barrier:
    """A line that separates rooms, normal to `axis` at `offset_m`, from `start_m` to `end_m`.

    `solid` False where an opening is closed, `weak` where nothing but the walls beside it speaks for it.
    """

    axis: int
    offset_m: float
    start_m: float
    end_m: float
    solid: bool = True
    weak: bool = False


@dataclass(frozen=True)
class Arrangement:
    """Cells of the lines `x_m (I + 1,)`, `y_m (J + 1,)`: `region (I, J)` or NO_REGION; barriers `wall_x (I + 1, J)`,
    `wall_y (I, J + 1)`."""

    x_m: Array
    y_m: Array
    region: Array
    wall_x: Array
    wall_y: Array

    def boxes_of(self, region: int) -> Array:
        """Boxes (K, 4) x0, y0, x1, y1 of one region."""
        i, j = np.nonzero(self.region == region)
        return np.stack((self.x_m[i], self.y_m[j], self.x_m[i + 1], self.y_m[j + 1]), axis=1)


def arrange(barriers: tuple[Barrier, ...], space: FreeSpace, matter_share: "MatterShare") -> Arrangement:
    """Cut the floor at every barrier and its ends, decide which cells are inside, and flood between barriers."""
    x, y = _lines(barriers, 0, space), _lines(barriers, 1, space)
    wall_x, wall_y = np.zeros((len(x), len(y) - 1), dtype=bool), np.zeros((len(x) - 1, len(y)), dtype=bool)
    for barrier in barriers:
        own, other, walls = (x, y, wall_x) if barrier.axis == 0 else (y, x, wall_y.T)
        line = int(np.argmin(np.abs(own - barrier.offset_m)))
        first, last = np.searchsorted(other, [barrier.start_m - SAME_LINE_M, barrier.end_m - SAME_LINE_M])
        walls[line, first:last] = True
    matter = matter_share.share(x, y) > INSIDE_SHARE
    inside = (space.share(x, y) > INSIDE_SHARE) & ~matter
    inside = _with_thin_cells(inside, matter, x, y, wall_x, wall_y)
    return Arrangement(x, y, _flood(inside, wall_x, wall_y), wall_x, wall_y)


@dataclass(frozen=True)
class MatterShare:
    """Rectangles (K, 4) x0, y0, x1, y1 of wall matter, none of which is free space whatever the rays say."""

    boxes: Array

    def share(self, x_m: Array, y_m: Array) -> Array:
        """1 where the middle of a cell lies in a rectangle, else 0."""
        cx, cy = (x_m[1:] + x_m[:-1]) / 2, (y_m[1:] + y_m[:-1]) / 2
        covered = np.zeros((len(cx), len(cy)))
        for x0, y0, x1, y1 in self.boxes:
            covered[np.ix_((cx > x0) & (cx < x1), (cy > y0) & (cy < y1))] = 1.0
        return covered


def _lines(barriers: tuple[Barrier, ...], axis: int, space: FreeSpace) -> Array:
    low = float(space.corner_m[axis])
    high = low + (space.integral.shape[axis] - 1) * CELL_M
    values = [low, high] + [b.offset_m for b in barriers if b.axis == axis]
    values += [end for b in barriers if b.axis != axis for end in (b.start_m, b.end_m)]
    ordered = np.sort(np.array(values, dtype=np.float64))
    return np.asarray(ordered[np.concatenate(([True], np.diff(ordered) > SAME_LINE_M))])


def _with_thin_cells(inside: Array, matter: Array, x: Array, y: Array, wall_x: Array, wall_y: Array) -> Array:
    """Thin cells between an inside cell and a wall, or two inside cells, are inside too, whatever few grid cells say."""
    result = inside.copy()
    for _ in range(THIN_ROUNDS):
        across_x = _between(result, wall_x) & (np.diff(x) < THIN_M)[:, None]
        across_y = _between(result.T, wall_y.T).T & (np.diff(y) < THIN_M)[None, :]
        result = result | ((across_x | across_y) & ~matter)
    return result


def _between(inside: Array, walls: Array) -> Array:
    """Cells with an inside neighbour on one side (first direction) and an inside neighbour or a wall on the other."""
    outside = np.zeros((1, inside.shape[1]), dtype=bool)
    before = np.concatenate((outside, inside[:-1])) & ~walls[:-1]
    after = np.concatenate((inside[1:], outside)) & ~walls[1:]
    return (before & (after | walls[1:])) | (after & walls[:-1])


def _flood(inside: Array, wall_x: Array, wall_y: Array) -> Array:
    """Connected regions (I, J) of inside cells, numbered from 0; NO_REGION elsewhere."""
    from scipy.sparse import coo_array
    from scipy.sparse.csgraph import connected_components

    number = np.arange(inside.size).reshape(inside.shape)
    right = inside[:-1] & inside[1:] & ~wall_x[1:-1]
    up = inside[:, :-1] & inside[:, 1:] & ~wall_y[:, 1:-1]
    a = np.concatenate((number[:-1][right], number[:, :-1][up]))
    b = np.concatenate((number[1:][right], number[:, 1:][up]))
    graph = coo_array((np.ones(len(a)), (a, b)), shape=(inside.size, inside.size))
    label = connected_components(graph, directed=False)[1].reshape(inside.shape)
    region = np.full(inside.shape, NO_REGION)
    region[inside] = np.unique(label[inside], return_inverse=True)[1]
    return region
