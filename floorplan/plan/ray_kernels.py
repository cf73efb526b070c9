"""Numba kernels that count, for one plane, the rays that hit it, passed through it or ended before it."""

import numpy as np

from floorplan.compiled import compiled
from floorplan.model.checks import Array

MIN_INCIDENCE = 0.15  # sine of 9 degrees: below it a ray's crossing point slides by more than a cell for 1 cm of noise
CLEARLY_BEYOND = 2.0  # tolerances: a reading hardly behind a surface may be of it, seen at a grazing angle or from a frame a little off

BLOCKER_DEPTH_M = 0.8  # what stands this near before a surface hides it: the depth of a cabinet and the slit behind it
HIT, PASSED, BLOCKED, NOTHING = 1, 2, 3, 0


@compiled
def _kind(before: float, beyond: float, mine: bool, loose: bool, tolerance: float) -> int:
    """What a ray did to a plane: `before`, `beyond` are the distances of its start and end from it, positive on the room side."""
    if mine or (loose and before > 0 and abs(beyond) <= tolerance):
        return HIT
    clear = CLEARLY_BEYOND * tolerance
    if (beyond < -clear and before > 0) or (beyond > clear and before < -tolerance):
        return PASSED
    return BLOCKED if tolerance < beyond <= BLOCKER_DEPTH_M and before > beyond else NOTHING


@compiled
def count_rays(
    sensor: Array,
    point: Array,
    start: Array,
    near: Array,
    point_plane: Array,
    weight: Array,
    tolerance: Array,
    plane: int,
    axis: int,
    facing: int,
    offset: float,
    reach: Array,
    grid: Array,
    band: Array,
    counts: Array,
    fine: Array,
    seen: Array,
) -> None:
    """Fill `counts (3, U, Z)`, `fine (3, U * K)` (hits, passed, blocked; fine: heights in `band` alone) and
    `seen (U, F)`, whether a segment of a frame on this plane covers a column. `grid` is (along, up, step along, step up).

    Passes count where the ray crossed the plane, blockers where they stand before it.
    A point of no plane counts as a hit when it lies on this one within the box `reach` (along low, high, up low, high).
    The points of frame f are `start[f]` to `start[f + 1]`; only the frames `near (F,)` are looked at.
    """
    along = 1 - axis
    finer = fine.shape[1] // counts.shape[1]
    for f in np.flatnonzero(near):
        for i in range(start[f], start[f + 1]):
            before, beyond = (sensor[f, axis] - offset) * facing, (point[i, axis] - offset) * facing
            u, z = point[i, along], point[i, 2]
            mine = point_plane[i] == plane
            loose = point_plane[i] < 0 and reach[0] <= u <= reach[1] and reach[2] <= z <= reach[3]
            kind = _kind(before, beyond, mine, loose, tolerance[i])
            if kind == NOTHING:
                continue
            if kind == PASSED:
                run, du, dz = before - beyond, u - sensor[f, along], z - sensor[f, 2]
                if abs(run) < MIN_INCIDENCE * np.sqrt(run * run + du * du + dz * dz):
                    continue
                u, z = sensor[f, along] + before / run * du, sensor[f, 2] + before / run * dz
            a, b = int(np.floor((u - grid[0]) / grid[2])), int(np.floor((z - grid[1]) / grid[3]))
            if a < 0 or b < 0 or a >= counts.shape[1] or b >= counts.shape[2]:
                continue
            counts[kind - 1, a, b] += weight[i]
            if band[0] <= z <= band[1]:
                fine[kind - 1, min(int((u - grid[0]) / grid[2] * finer), fine.shape[1] - 1)] += weight[i]
            if mine:  # a stray reading is no witness: a skewed wall crosses many planes
                seen[a, f] = True


@compiled
def frame_boxes(sensor: Array, point: Array, start: Array) -> Array:
    """What each frame's rays span (F, 2, 2): lowest and highest x and y of the sensor and its points."""
    box = np.empty((len(sensor), 2, 2))
    for f in range(len(sensor)):
        for a in range(2):
            low = high = sensor[f, a]
            for i in range(start[f], start[f + 1]):
                low, high = min(low, point[i, a]), max(high, point[i, a])
            box[f, a, 0], box[f, a, 1] = low, high
    return box


@compiled
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
