"""Where a fitted plane is seen: its pixels grown up to the edges, their extents and area."""

import math

import numpy as np

from floorplan.compiled import compiled
from floorplan.model.checks import Array
from floorplan.segments.fit import FLOOR_M, INLIER_SIGMAS, LEAST_COS

_MIN_COS_GROWN = 0.8  # a pixel whose own surface points elsewhere (37 degrees) belongs to something else
_TRIM = 0.005  # of the pixels at each end of an extent
_BINS = 512


@compiled
def _on_plane(
    points: Array, normal: Array, weight: Array, noise: Array, rotation: Array, axis: int, offset: float, i: int, j: int
) -> bool:
    if weight[i, j] <= 0:
        return False
    p = points[i, j]
    coordinate = rotation[axis, 0] * p[0] + rotation[axis, 1] * p[1] + rotation[axis, 2] * p[2]
    rho = math.sqrt(p[0] * p[0] + p[1] * p[1] + p[2] * p[2])
    across = noise[i, j] * max(abs(coordinate) / rho, LEAST_COS)
    if abs(coordinate - offset) > INLIER_SIGMAS * math.sqrt(across * across + FLOOR_M * FLOOR_M):
        return False
    n = normal[i, j]
    along = abs(rotation[axis, 0] * n[0] + rotation[axis, 1] * n[1] + rotation[axis, 2] * n[2])
    return not along < _MIN_COS_GROWN  # NaN: no normal near an edge, the coordinate decides


@compiled
def grow(
    points: Array, normal: Array, weight: Array, noise: Array, rotation: Array, index: Array, axis: Array, offset: Array, rounds: int
) -> Array:
    """Segment of each pixel (H, W): `index` less its outliers, grown over neighbours on the same plane, `rounds` pixels far at most."""
    height, width = index.shape
    grown = np.full((height, width), -1, np.int32)
    for i in range(height):
        for j in range(width):
            s = index[i, j]
            if s >= 0 and _on_plane(points, normal, weight, noise, rotation, axis[s], offset[s], i, j):
                grown[i, j] = s
    for _ in range(rounds):
        before = grown.copy()
        for i in range(height):
            for j in range(width):
                if before[i, j] >= 0 or weight[i, j] <= 0:
                    continue
                for side in range(4):
                    u = i + (side == 0) - (side == 1)
                    v = j + (side == 2) - (side == 3)
                    if u < 0 or v < 0 or u >= height or v >= width or before[u, v] < 0:
                        continue
                    s = before[u, v]
                    if _on_plane(points, normal, weight, noise, rotation, axis[s], offset[s], i, j):
                        grown[i, j] = s
                        break
    return grown


@compiled
def extents_and_area(points: Array, rotation: Array, grown: Array, count: int, ray_step: float, camera: bool) -> tuple[Array, Array]:
    """Trimmed boxes (count, 3, 2) in world axes about the sensor, and areas (count,); a sweep's area is its length times one metre."""
    height, width = grown.shape
    low, high = np.full((count, 3), np.inf), np.full((count, 3), -np.inf)
    world = np.empty((height, width, 3), np.float32)
    for i in range(height):
        for j in range(width):
            s = grown[i, j]
            if s < 0:
                continue
            for a in range(3):
                q = rotation[a, 0] * points[i, j, 0] + rotation[a, 1] * points[i, j, 1] + rotation[a, 2] * points[i, j, 2]
                world[i, j, a] = q
                low[s, a] = min(low[s, a], world[i, j, a])
                high[s, a] = max(high[s, a], world[i, j, a])
    histogram = np.zeros((count, 3, _BINS), np.int32)
    pixels = np.zeros(count, np.int64)
    for i in range(height):
        for j in range(width):
            s = grown[i, j]
            if s < 0:
                continue
            pixels[s] += 1
            for a in range(3):
                span = high[s, a] - low[s, a]
                b = int((world[i, j, a] - low[s, a]) / span * _BINS) if span > 0 else 0
                histogram[s, a, min(b, _BINS - 1)] += 1
    extent = np.zeros((count, 3, 2))
    for s in range(count):
        for a in range(3):
            extent[s, a, 0], extent[s, a, 1] = _trimmed(histogram[s, a], pixels[s], low[s, a], high[s, a])
    return extent, _areas(points, world, grown, count, ray_step, camera)


@compiled
def _trimmed(histogram: Array, pixels: int, low: float, high: float) -> tuple[float, float]:
    cut = _TRIM * pixels
    total, first = 0, 0
    while first < _BINS - 1 and total + histogram[first] <= cut:
        total += histogram[first]
        first += 1
    total, last = 0, _BINS - 1
    while last > first and total + histogram[last] <= cut:
        total += histogram[last]
        last -= 1
    bin_m = (high - low) / _BINS
    return low + first * bin_m, low + (last + 1) * bin_m


@compiled
def _areas(points: Array, world: Array, grown: Array, count: int, ray_step: float, camera: bool) -> Array:
    height, width = grown.shape
    area = np.zeros((count, 3))
    for i in range(height):
        for j in range(width):
            s = grown[i, j]
            if s < 0:
                continue
            x, y, z = world[i, j, 0], world[i, j, 1], world[i, j, 2]
            rho = math.sqrt(x * x + y * y + z * z)
            solid = ray_step if height == 1 else ray_step * ray_step
            if camera:
                solid *= (points[i, j, 2] / rho) ** 3  # pixels far off the optical axis see a smaller angle
            for a in range(3):
                area[s, a] += solid * (rho if height == 1 else rho * rho) / max(abs(world[i, j, a]) / rho, 0.02)
    return area
