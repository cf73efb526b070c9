"""A depth image to an organised grid of points, in one pass."""

import numpy as np

from floorplan.compiled import compiled
from floorplan.model.checks import Array


@compiled
def back_project(raw: Array, stride: int, metres_per_unit: float, max_range_m: float, ray_x: Array, ray_y: Array) -> Array:
    """Points (H, W, 3) float32 of every `stride`-th pixel of `raw`: z = depth, x = z ray_x, y = z ray_y; NaN where there is no depth."""
    height, width = len(ray_y), len(ray_x)
    points = np.empty((height, width, 3), np.float32)
    scale, farthest = np.float32(metres_per_unit), np.float32(max_range_m)
    for i in range(height):
        for j in range(width):
            units = raw[i * stride, j * stride]
            depth = np.float32(units) * scale
            if units == 0 or depth > farthest:
                depth = np.float32(np.nan)
            points[i, j, 0] = depth * ray_x[j]
            points[i, j, 1] = depth * ray_y[i]
            points[i, j, 2] = depth
    return points
