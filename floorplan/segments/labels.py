"""Which axis each pixel's surface belongs to.

A label is a small number: axis * 2 + (1 where the surface faces along the axis, 0 where against it); OFF_AXIS
for upright surfaces that follow no axis; UNLABELLED for the rest.
"""

import math

import numpy as np

from floorplan.compiled import compiled
from floorplan.grid.normals import SurfaceNormals
from floorplan.model.checks import Array

UNLABELLED = -1
OFF_AXIS = 6
_MAX_RESIDUAL_SIGMAS = 2.5  # a window that fits worse holds an edge
_MAX_TILT_RAD = math.radians(10.0)  # an upright surface's normal is this close to level
_MAX_SIGMA_RAD = math.radians(6.0)  # normals worse than this say nothing
_SIGMAS = 1.5  # of the normal's own noise, added to the tolerance


def label_by_normals(normals: SurfaceNormals, noise_sigma_m: Array, world_from_sensor: Array, tolerance_rad: float) -> Array:
    """Labels (H, W) int8: the axis within `tolerance_rad` of the pixel's normal."""
    return _label(
        normals.normal, normals.sigma_rad, normals.residual_m, noise_sigma_m.astype(np.float32), world_from_sensor, tolerance_rad
    )


@compiled
def _label(normal: Array, sigma_rad: Array, residual_m: Array, noise_m: Array, rotation: Array, tolerance_rad: float) -> Array:
    height, width, _ = normal.shape
    labels = np.full((height, width), UNLABELLED, np.int8)
    for i in range(height):
        for j in range(width):
            sigma = sigma_rad[i, j]
            if not sigma < _MAX_SIGMA_RAD or not residual_m[i, j] < _MAX_RESIDUAL_SIGMAS * noise_m[i, j]:
                continue
            n0, n1, n2 = normal[i, j, 0], normal[i, j, 1], normal[i, j, 2]
            least = math.cos(tolerance_rad + _SIGMAS * sigma)
            level = 0.0
            for axis in range(3):
                along = rotation[axis, 0] * n0 + rotation[axis, 1] * n1 + rotation[axis, 2] * n2
                if abs(along) > least:
                    labels[i, j] = axis * 2 + (1 if along > 0 else 0)
                level = along
            if labels[i, j] == UNLABELLED and abs(level) < _MAX_TILT_RAD + sigma:
                labels[i, j] = OFF_AXIS
    return labels
