"""A thinned set of a frame's points, so that no later stage reads depth again."""

import math

import numpy as np

from floorplan.compiled import compiled
from floorplan.model.checks import Array
from floorplan.segments.values import ThinnedPoints


def thin(points: Array, weight: Array, segment_of_pixel: Array, frame: int, wanted: int, pixels_per_point: float) -> ThinnedPoints:
    """About `wanted` points on a regular sub-grid that shifts from frame to frame, each standing for the pixels around it.

    `pixels_per_point`: pixels of the full image per pixel of this grid. Of a sweep (one row) every beam is kept, or every n-th.
    """
    height, width = weight.shape
    step = math.ceil(width / wanted) if height == 1 else max(1, round(math.sqrt(height * width / wanted)))
    row, column = (frame * 7) % step, (frame * 3) % step  # another phase in each frame: the set covers what one grid would miss
    stands_for = step * pixels_per_point if height == 1 else step * step * pixels_per_point
    return ThinnedPoints(*_every(points, weight, segment_of_pixel, step, row if height > 1 else 0, column), stands_for)


@compiled
def _every(points: Array, weight: Array, segment_of_pixel: Array, step: int, row: int, column: int) -> tuple[Array, Array]:
    """Points (P, 3) and segments (P,) of every `step`-th pixel that was seen."""
    height, width = weight.shape
    most = ((height - 1) // step + 1) * ((width - 1) // step + 1)
    kept, segment = np.empty((most, 3), np.float32), np.empty(most, np.int32)
    count = 0
    for i in range(row, height, step):
        for j in range(column, width, step):
            if weight[i, j] > 0:
                for a in range(3):
                    kept[count, a] = points[i, j, a]
                segment[count] = segment_of_pixel[i, j]
                count += 1
    return kept[:count].copy(), segment[:count].copy()
