"""Compiled parts of the place search: a likelihood picture of one place and branch and bound over poses in it.

After E. Olson (2009), "Real-time correlative scan matching", and W. Hess et al. (2016), "Real-time loop closure in 2D LIDAR
SLAM": the picture's maxima over growing windows bound the score of all poses in a window from above.
"""

import math

import numpy as np

from floorplan.compiled import compiled
from floorplan.model.checks import Array

CELL_M = 0.10  # grain of the search; the pose found is refined by matching
BLUR_M = 0.15  # how far from a surface a point counts 0.6: walls are that rough, places drawn that wrongly
REACH = 4  # cells about a surface that are painted: beyond, the likelihood is below 3 %
LEVELS = 5  # windows of 1, 2, 4, 8, 16 cells


@compiled
def place_picture(points: Array) -> tuple[Array, Array]:
    """Likelihood pyramid (LEVELS, W, H) float32 of `points (n, 2)` and the place (2,) of its cell (0, 0), m.

    Level l holds, per cell, the largest likelihood in the window of 2^l cells that begins there.
    """
    margin = REACH + 2 ** (LEVELS - 1)
    x0 = math.floor(points[:, 0].min() / CELL_M) - margin
    y0 = math.floor(points[:, 1].min() / CELL_M) - margin
    wide = math.floor(points[:, 0].max() / CELL_M) - x0 + REACH + 2
    high = math.floor(points[:, 1].max() / CELL_M) - y0 + REACH + 2
    picture = np.zeros((LEVELS, wide, high), np.float32)
    for k in range(len(points)):
        cx, cy = math.floor(points[k, 0] / CELL_M) - x0, math.floor(points[k, 1] / CELL_M) - y0
        for i in range(cx - REACH, cx + REACH + 1):
            for j in range(cy - REACH, cy + REACH + 1):
                dx, dy = (i + x0 + 0.5) * CELL_M - points[k, 0], (j + y0 + 0.5) * CELL_M - points[k, 1]
                value = math.exp(-0.5 * (dx * dx + dy * dy) / (BLUR_M * BLUR_M))
                if value > picture[0, i, j]:
                    picture[0, i, j] = value
    for level in range(1, LEVELS):
        half = 2 ** (level - 1)
        for i in range(wide):
            for j in range(high):
                best = picture[level - 1, i, j]
                for a, b in ((half, 0), (0, half), (half, half)):
                    if i + a < wide and j + b < high and picture[level - 1, i + a, j + b] > best:
                        best = picture[level - 1, i + a, j + b]
                picture[level, i, j] = best
    return picture, np.array([x0, y0]) * CELL_M


@compiled
def _score(picture: Array, level: int, cells: Array, x: int, y: int) -> float:
    """Mean value of the picture at `cells (n, 2)` shifted by (x, y); outside it nothing is known: 0."""
    total = 0.0
    for k in range(len(cells)):
        i, j = cells[k, 0] + x, cells[k, 1] + y
        if 0 <= i < picture.shape[1] and 0 <= j < picture.shape[2]:
            total += picture[level, i, j]
    return total / len(cells)


@compiled
def _turned_cells(query: Array, yaws: Array, centre: Array, origin: Array) -> Array:
    """Cells (T, n, 2) that `query (n, 2)` falls on when it is turned by each of the `yaws (T,)` and moved to `centre`."""
    cells = np.empty((len(yaws), len(query), 2), np.int64)
    for t in range(len(yaws)):
        c, s = math.cos(yaws[t]), math.sin(yaws[t])
        for k in range(len(query)):
            cells[t, k, 0] = math.floor((c * query[k, 0] - s * query[k, 1] + centre[0] - origin[0]) / CELL_M)
            cells[t, k, 1] = math.floor((s * query[k, 0] + c * query[k, 1] + centre[1] - origin[1]) / CELL_M)
    return cells


@compiled
def _bounds(picture: Array, cells: Array, starts: int, reach: int) -> Array:
    """Highest possible scores (T * starts * starts,) of the widest windows, those of each turned query from -`reach` cells on."""
    coarse = 2 ** (LEVELS - 1)
    bound = np.empty(len(cells) * starts * starts)
    for t in range(len(cells)):
        for a in range(starts):
            for b in range(starts):
                bound[(t * starts + a) * starts + b] = _score(picture, LEVELS - 1, cells[t], a * coarse - reach, b * coarse - reach)
    return bound


@compiled
def best_pose(picture: Array, origin: Array, query: Array, centre: Array, window: Array, least: float, other: Array) -> Array:
    """Pose and score (4,) x, y, yaw, score of `query (n, 2)` in the picture: the best within `window` of `centre`.

    `window (3,)`: half width m, half yaw, step of yaw, rad. `least` score worth finding (else the score is 0). Poses within `other[3]`
    metres and `other[4]` radians of the pose `other[:3]` are passed over (0 metres: none is).
    """
    result = np.array([centre[0], centre[1], centre[2], 0.0])
    best = least
    steps = math.ceil(window[1] / window[2])
    yaws = centre[2] + np.arange(-steps, steps + 1) * window[2]
    cells = _turned_cells(query, yaws, centre, origin)
    coarse = 2 ** (LEVELS - 1)
    reach = math.ceil(window[0] / CELL_M)
    starts = 2 * reach // coarse + 1
    bound = _bounds(picture, cells, starts, reach)
    stack = np.empty((4 * LEVELS + 4, 3), np.int64)
    value = np.empty(4 * LEVELS + 4)
    for start in np.argsort(-bound):
        if bound[start] <= best:
            break
        t, a, b = start // (starts * starts), (start // starts) % starts, start % starts
        stack[0, 0], stack[0, 1], stack[0, 2], value[0] = LEVELS - 1, a * coarse - reach, b * coarse - reach, bound[start]
        top = 1
        while top > 0:
            top -= 1
            level, x, y = stack[top, 0], stack[top, 1], stack[top, 2]
            if value[top] <= best:
                continue
            if level == 0:
                px, py, yaw = centre[0] + x * CELL_M, centre[1] + y * CELL_M, yaws[t]
                near = math.hypot(px - other[0], py - other[1]) < other[3] and abs(yaw - other[2]) < other[4]
                if not near and math.hypot(x, y) <= reach:
                    best = value[top]
                    result[0], result[1], result[2], result[3] = px, py, yaw, best
                continue
            half = 2 ** (level - 1)
            for i in range(4):
                cx, cy = x + (i % 2) * half, y + (i // 2) * half
                bounded = _score(picture, level - 1, cells[t], cx, cy)
                if bounded > best:
                    stack[top, 0], stack[top, 1], stack[top, 2], value[top] = level - 1, cx, cy, bounded
                    top += 1
    return result
