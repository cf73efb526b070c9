"""A thinned set of a frame's points, so that no later stage reads depth again."""

import math

import numpy as np

from floorplan.model.checks import Array
from floorplan.model.segment import EvidencePoints


def thin(points: Array, weight: Array, segment_of_pixel: Array, frame: int, wanted: int, pixels_per_point: float) -> EvidencePoints:
    """About `wanted` points on a regular sub-grid that shifts from frame to frame, each standing for the pixels around it.

    `pixels_per_point`: pixels of the full image per pixel of this grid. A sweep (one row) keeps all its beams.
    """
    height, width = weight.shape
    step = 1 if height == 1 else max(1, round(math.sqrt(height * width / wanted)))
    row, column = (frame * 7) % step, (frame * 3) % step  # another phase in each frame: the set covers what one grid would miss
    rows = slice(row, None, step) if height > 1 else slice(None)
    columns = slice(column, None, step)
    seen = weight[rows, columns] > 0
    kept = points[rows, columns][seen]
    return EvidencePoints(
        np.array([0, len(kept)]),
        kept,
        segment_of_pixel[rows, columns][seen],
        np.full(len(kept), step * step * pixels_per_point if height > 1 else pixels_per_point, np.float32),
    )
