"""Compiled parts of sweep matching: the local map's cells, nearest surfaces, one Gauss-Newton step.

A map point is a row (x, y, normal x, normal y, sightings, path): where something was seen, how it faces, how often, and
after what path it was seen last. Clutter has the normal (0, 0): it is matched point to point. Poses are (x, y, yaw).
"""

import math

import numpy as np

from floorplan.compiled import compiled
from floorplan.model.checks import Array

CELL_M = 0.25  # grain of the look-up, near the closing gate
SAME_SURFACE_COS = 0.8  # normals further apart belong to two surfaces that meet
MEMORY = 20.0  # sightings a map point averages over
GATE_SHRINK = 0.7  # per round: coarse first, then only what fits
CLUTTER_SIGMA_M = 0.05  # neighbouring beams hit clutter this far apart
CONVERGED = 1e-4  # metres and radians


@compiled
def build_cells(points: Array) -> tuple[Array, Array, Array]:
    """Look-up table of `points (n, 6)`: origin and shape (4,), start of each cell, rows in the order of the cells."""
    x0, y0 = math.floor(points[:, 0].min() / CELL_M) - 1, math.floor(points[:, 1].min() / CELL_M) - 1
    wide = math.floor(points[:, 0].max() / CELL_M) - x0 + 2
    high = math.floor(points[:, 1].max() / CELL_M) - y0 + 2
    start = np.zeros(wide * high + 1, np.int64)
    cell = np.empty(len(points), np.int64)
    for k in range(len(points)):
        cell[k] = (math.floor(points[k, 0] / CELL_M) - x0) * high + (math.floor(points[k, 1] / CELL_M) - y0)
        start[cell[k] + 1] += 1
    for c in range(wide * high):
        start[c + 1] += start[c]
    place = start[:-1].copy()
    order = np.empty(len(points), np.int64)
    for k in range(len(points)):
        order[place[cell[k]]] = k
        place[cell[k]] += 1
    return np.array([x0, y0, wide, high]).astype(np.int64), start, order


@compiled
def nearest(points: Array, frame: Array, start: Array, order: Array, x: float, y: float, nx: float, ny: float, gate: float) -> int:
    """Row of the nearest map point that faces the same way within `gate` metres, -1 where there is none."""
    reach = math.ceil(gate / CELL_M)
    cx, cy = math.floor(x / CELL_M) - frame[0], math.floor(y / CELL_M) - frame[1]
    best, found = gate * gate, -1
    for i in range(max(cx - reach, 0), min(cx + reach + 1, frame[2])):
        for j in range(max(cy - reach, 0), min(cy + reach + 1, frame[3])):
            c = i * frame[3] + j
            for s in range(start[c], start[c + 1]):
                k = order[s]
                both_flat = (nx != 0.0 or ny != 0.0) and (points[k, 2] != 0.0 or points[k, 3] != 0.0)
                if both_flat and nx * points[k, 2] + ny * points[k, 3] < SAME_SURFACE_COS:
                    continue
                dx, dy = x - points[k, 0], y - points[k, 1]
                d = dx * dx + dy * dy
                if d < best:
                    best, found = d, k
    return found


@compiled
def normal_equations(
    sweep: Array, sigma: Array, pose: Array, points: Array, frame: Array, start: Array, order: Array, gate: float, cauchy: float
) -> tuple[Array, Array, Array, int]:
    """Point-to-line normal equations about `pose`: information (3, 3), right side (3,), residuals (n,) NaN where unmatched, matches.

    `sweep (n, 4)` points and normals in the sensor's axes with `sigma (n,)`; Cauchy weights of `cauchy` standard deviations.
    """
    c, s = math.cos(pose[2]), math.sin(pose[2])
    information, right = np.zeros((3, 3)), np.zeros(3)
    residual = np.full(len(sweep), np.nan)
    row = np.empty(3)
    count = 0
    for k in range(len(sweep)):
        rx, ry = c * sweep[k, 0] - s * sweep[k, 1], s * sweep[k, 0] + c * sweep[k, 1]
        nx, ny = c * sweep[k, 2] - s * sweep[k, 3], s * sweep[k, 2] + c * sweep[k, 3]
        x, y = pose[0] + rx, pose[1] + ry
        m = nearest(points, frame, start, order, x, y, nx, ny, gate)
        if m < 0:
            continue
        count += 1
        mx, my = points[m, 2], points[m, 3]
        line = (mx != 0.0 or my != 0.0) and (nx != 0.0 or ny != 0.0)
        spread = sigma[k] if line else math.hypot(sigma[k], CLUTTER_SIGMA_M)
        dx, dy = x - points[m, 0], y - points[m, 1]
        off = abs(mx * dx + my * dy) if line else math.hypot(dx, dy)
        residual[k] = off
        weight = 1.0 / (spread * spread * (1.0 + (off / (cauchy * spread)) ** 2))
        for side in range(1 if line else 2):
            if not line:
                mx, my = 1.0 - side, float(side)
            row[0], row[1], row[2] = mx, my, my * rx - mx * ry
            for a in range(3):
                right[a] -= weight * row[a] * (mx * dx + my * dy)
                for b in range(3):
                    information[a, b] += weight * row[a] * row[b]
    return information, right, residual, count


@compiled
def add_sweep(
    points: Array, count: int, frame: Array, start: Array, order: Array, sweep: Array, pose: Array, path: float, spacing: float
) -> int:
    """Join a placed sweep to the map rows `points[:count]` (room for more behind them); gives the new count.

    A point within `spacing` of one that faces the same way is averaged into it.
    """
    c, s = math.cos(pose[2]), math.sin(pose[2])
    for k in range(len(sweep)):
        x = pose[0] + c * sweep[k, 0] - s * sweep[k, 1]
        y = pose[1] + s * sweep[k, 0] + c * sweep[k, 1]
        nx, ny = c * sweep[k, 2] - s * sweep[k, 3], s * sweep[k, 2] + c * sweep[k, 3]
        m = nearest(points, frame, start, order, x, y, nx, ny, spacing) if len(order) else -1
        if m < 0:
            points[count, 0], points[count, 1], points[count, 2], points[count, 3] = x, y, nx, ny
            points[count, 4], points[count, 5] = 1.0, path
            count += 1
            continue
        seen = min(points[m, 4] + 1.0, MEMORY)
        share = 1.0 / seen
        points[m, 0] += share * (x - points[m, 0])
        points[m, 1] += share * (y - points[m, 1])
        fx, fy = points[m, 2] + share * (nx - points[m, 2]), points[m, 3] + share * (ny - points[m, 3])
        size = math.hypot(fx, fy)
        if size > 0.0:
            points[m, 2], points[m, 3] = fx / size, fy / size
        points[m, 4], points[m, 5] = seen, path
    return count


@compiled
def match(
    sweep: Array, sigma: Array, predicted: Array, prior: Array, points: Array, frame: Array, start: Array, order: Array, options: Array
) -> tuple[Array, Array, float]:
    """Pose (3,) of `sweep` in the map, its surfaces' information about it (3, 3), share of points matched.

    `prior (3, 3)` information of the odometry about `predicted (3,)`, heavy-tailed; `options`: first gate, last gate, Cauchy
    sigmas, information of one beam, rounds, Student degrees of freedom of the odometry.
    """
    pose, gate = predicted.copy(), options[0]
    information, matched = np.zeros((3, 3)), 0
    for _ in range(int(options[4])):
        information, right, _, matched = normal_equations(sweep, sigma, pose, points, frame, start, order, gate, options[2])
        information *= options[3]
        away = predicted - pose
        pull = prior @ away
        slip = 1.0 / (1.0 + (away @ pull) / options[5])
        step = np.linalg.solve(information + slip * prior, options[3] * right + slip * pull)
        pose = pose + step
        closed = gate <= options[1]
        gate = max(GATE_SHRINK * gate, options[1])
        if closed and np.abs(step).max() < CONVERGED:
            break
    return pose, information, matched / max(len(sweep), 1)
