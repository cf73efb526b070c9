"""Where a fitted plane is seen: its pixels grown up to the edges, their extents and area."""

import math

import numpy as np

from floorplan.compiled import compiled
from floorplan.model.checks import Array
from floorplan.segments.fit import FLOOR_M, INLIER_SIGMAS, LEAST_COS

_MIN_COS_GROWN = 0.8  # a pixel whose own surface points elsewhere (37 degrees) belongs to something else
_SURELY_OFF = 1.0001  # noise across a surface is no more than along the ray: further off, no root is needed to tell
_TRIM = 0.005  # of the pixels at each end of an extent
_BINS = 512
_LEAST_COS_AREA = 0.02  # grazing pixels count with 50 times their solid angle at most


@compiled
def _on_plane(
    points: Array, normal: Array, weight: Array, noise: Array, rotation: Array, axis: int, offset: float, i: int, j: int
) -> bool:
    if weight[i, j] <= 0:
        return False
    x, y, z = points[i, j, 0], points[i, j, 1], points[i, j, 2]
    coordinate = rotation[axis, 0] * x + rotation[axis, 1] * y + rotation[axis, 2] * z
    most = noise[i, j] * noise[i, j] + FLOOR_M * FLOOR_M
    if (coordinate - offset) ** 2 > _SURELY_OFF * INLIER_SIGMAS * INLIER_SIGMAS * most:
        return False
    rho = math.sqrt(x * x + y * y + z * z)
    across = noise[i, j] * max(abs(coordinate) / rho, LEAST_COS)
    if abs(coordinate - offset) > INLIER_SIGMAS * math.sqrt(across * across + FLOOR_M * FLOOR_M):
        return False
    along = abs(rotation[axis, 0] * normal[i, j, 0] + rotation[axis, 1] * normal[i, j, 1] + rotation[axis, 2] * normal[i, j, 2])
    return not along < _MIN_COS_GROWN  # NaN: no normal near an edge, the coordinate decides


@compiled
def renumbered(index: Array, number: Array) -> Array:
    """`number (C,)` of each pixel's `index (H, W)`; -1 stays."""
    found = np.empty(index.shape, np.int32)
    for i in range(index.shape[0]):
        for j in range(index.shape[1]):
            found[i, j] = number[index[i, j]] if index[i, j] >= 0 else -1
    return found


@compiled
def grow(
    points: Array, normal: Array, weight: Array, noise: Array, rotation: Array, index: Array, axis: Array, offset: Array, rounds: int
) -> Array:
    """Segment of each pixel (H, W): `index` grown over neighbours on the same plane, `rounds` pixels far at most."""
    height, width = index.shape
    grown = index.copy()
    front = np.empty(height * width, np.int64)
    count = 0
    for i in range(height):
        for j in range(width):
            if grown[i, j] >= 0 and _has_free_neighbour(grown, i, j):
                front[count] = i * width + j
                count += 1
    first = 0
    for _ in range(rounds):  # breadth first: each round takes the neighbours of the one before
        last = count
        for k in range(first, last):
            i, j = front[k] // width, front[k] % width
            s = grown[i, j]
            for side in range(4):
                u = i + (side == 0) - (side == 1)
                v = j + (side == 2) - (side == 3)
                if u < 0 or v < 0 or u >= height or v >= width or grown[u, v] >= 0:
                    continue
                if _on_plane(points, normal, weight, noise, rotation, axis[s], offset[s], u, v):
                    grown[u, v] = s
                    front[count] = u * width + v
                    count += 1
        first = last
    return grown


@compiled
def _has_free_neighbour(grown: Array, i: int, j: int) -> bool:
    height, width = grown.shape
    return bool(
        (i > 0 and grown[i - 1, j] < 0)
        or (j > 0 and grown[i, j - 1] < 0)
        or (i + 1 < height and grown[i + 1, j] < 0)
        or (j + 1 < width and grown[i, j + 1] < 0)
    )


@compiled
def extents_and_areas(points: Array, rotation: Array, grown: Array, axis: Array, ray_step: float, camera: bool) -> tuple[Array, Array]:
    """Trimmed boxes (S, 3, 2) in world axes about the sensor, and areas (S,), of segments normal to `axis (S,)`.

    A sweep's area is its length times one metre.
    """
    height, width = grown.shape
    count = len(axis)
    low, high = np.full((count, 3), np.inf), np.full((count, 3), -np.inf)
    world, segment = np.empty((height * width, 3), np.float32), np.empty(height * width, np.int32)
    area, pixels = np.zeros(count), np.zeros(count, np.int64)
    seen = 0
    for i in range(height):
        for j in range(width):
            s = grown[i, j]
            if s < 0:
                continue
            x, y, z = points[i, j, 0], points[i, j, 1], points[i, j, 2]
            rho = math.sqrt(x * x + y * y + z * z)
            # Pixels far off a camera's optical axis see a smaller angle.
            patch = rho * ray_step if height == 1 else (rho * ray_step) ** 2 * ((z / rho) ** 3 if camera else 1.0)
            pixels[s] += 1
            segment[seen] = s
            for a in range(3):
                q = np.float32(rotation[a, 0] * x + rotation[a, 1] * y + rotation[a, 2] * z)
                world[seen, a] = q
                low[s, a] = min(low[s, a], q)
                high[s, a] = max(high[s, a], q)
            area[s] += patch / max(float(abs(world[seen, axis[s]]) / rho), _LEAST_COS_AREA)
            seen += 1
    histogram = np.zeros((count, 3, _BINS), np.int32)
    for k in range(seen):
        s = segment[k]
        for a in range(3):
            span = high[s, a] - low[s, a]
            b = int((world[k, a] - low[s, a]) / span * _BINS) if span > 0 else 0
            histogram[s, a, min(b, _BINS - 1)] += 1
    extent = np.zeros((count, 3, 2))
    for s in range(count):
        for a in range(3):
            extent[s, a, 0], extent[s, a, 1] = _trimmed(histogram[s, a], pixels[s], low[s, a], high[s, a])
    return extent, area


@compiled
def _trimmed(histogram: Array, pixels: int, low: float, high: float) -> tuple[float, float]:
    """The ends of an extent after `_TRIM` of its pixels at each end."""
    if pixels == 0:
        return 0.0, 0.0
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
