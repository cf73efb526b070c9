"""Numba kernels that count, for one plane, the rays that hit it, passed through it or ended before it."""

import numpy as np
from numba import njit

from floorplan.model.checks import Array

MIN_INCIDENCE = 0.15  # sine of 9 degrees: below it a ray's crossing point slides by more than a cell for 1 cm of noise


@njit(cache=True)  # type: ignore[untyped-decorator, unused-ignore]
def count_rays(
    sensor: Array,
    point: Array,
    point_frame: Array,
    point_plane: Array,
    weight: Array,
    tolerance: Array,
    plane: int,
    axis: int,
    facing: int,
    offset: float,
    reach: Array,
    corner: Array,
    cell: Array,
    band: Array,
    fine: int,
    hits: Array,
    passes: Array,
    blocked: Array,
    fine_hits: Array,
    fine_passes: Array,
    frames: Array,
) -> None:
    """Fill the count arrays of one plane; `corner` and `cell` give the grid (along, up), `band` the heights of the fine counts.

    A point of no plane counts as a hit when it lies on this one within the box `reach` (along low, high, up low, high).
    """
    along = 1 - axis
    last_frame = np.full(frames.shape[0], -1)
    for i in range(point.shape[0]):
        f = point_frame[i]
        before = (sensor[f, axis] - offset) * facing  # positive: the sensor is on the room side
        beyond = (point[i, axis] - offset) * facing
        mine = point_plane[i] == plane
        kind = 0
        loose = point_plane[i] < 0 and before > 0 and abs(beyond) <= tolerance[i]
        if loose:
            u, z = point[i, along], point[i, 2]
            loose = reach[0] <= u <= reach[1] and reach[2] <= z <= reach[3]
        if mine or loose:
            kind = 1
            u, z = point[i, along], point[i, 2]
        else:
            if before * beyond > 0 and beyond < 0:
                continue  # wholly behind
            if (beyond < -tolerance[i] and before > 0) or (beyond > tolerance[i] and before < -tolerance[i]):
                kind = 2
            elif before > 0 and beyond > tolerance[i] and before - beyond > 0:
                kind = 3
            else:
                continue
            run = before - beyond
            du, dz = point[i, along] - sensor[f, along], point[i, 2] - sensor[f, 2]
            if abs(run) < MIN_INCIDENCE * np.sqrt(run * run + du * du + dz * dz):
                continue
            u, z = sensor[f, along] + before / run * du, sensor[f, 2] + before / run * dz
        a, b = int(np.floor((u - corner[0]) / cell[0])), int(np.floor((z - corner[1]) / cell[1]))
        if a < 0 or b < 0 or a >= hits.shape[0] or b >= hits.shape[1]:
            continue
        in_band = band[0] <= z <= band[1]
        k = min(int((u - corner[0]) / cell[0] * fine), fine_hits.shape[0] - 1)
        if kind == 1:
            hits[a, b] += weight[i]
            if in_band:
                fine_hits[k] += weight[i]
            if mine and last_frame[a] != f:
                last_frame[a] = f
                frames[a] += 1
        elif kind == 2:
            passes[a, b] += weight[i]
            if in_band:
                fine_passes[k] += weight[i]
        else:
            blocked[a, b] += weight[i]


@njit(cache=True)  # type: ignore[untyped-decorator, unused-ignore]
def mark_free(sensor: Array, point: Array, point_frame: Array, margin: Array, corner: Array, cell: float, crossed: Array) -> None:
    """Count in `crossed (X, Y)` the rays that went through each grid cell (Amanatides and Woo), stopping `margin` before their ends."""
    for i in range(point.shape[0]):
        f = point_frame[i]
        x, y = sensor[f, 0], sensor[f, 1]
        dx, dy = point[i, 0] - x, point[i, 1] - y
        length = np.sqrt(dx * dx + dy * dy)
        if length <= margin[i]:
            continue
        step_x, step_y = (1 if dx > 0 else -1), (1 if dy > 0 else -1)
        a, b = int(np.floor((x - corner[0]) / cell)), int(np.floor((y - corner[1]) / cell))
        per_x = cell / abs(dx) if dx != 0 else np.inf  # share of the ray per column, per row
        per_y = cell / abs(dy) if dy != 0 else np.inf
        next_x = (corner[0] + (a + (dx > 0)) * cell - x) / dx if dx != 0 else np.inf
        next_y = (corner[1] + (b + (dy > 0)) * cell - y) / dy if dy != 0 else np.inf
        end = 1 - margin[i] / length
        while 0 <= a < crossed.shape[0] and 0 <= b < crossed.shape[1]:
            crossed[a, b] += 1
            if min(next_x, next_y) > end:
                break
            if next_x < next_y:
                a, next_x = a + step_x, next_x + per_x
            else:
                b, next_y = b + step_y, next_y + per_y
