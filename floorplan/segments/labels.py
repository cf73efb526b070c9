"""Which axis each pixel's surface belongs to.

A label is a small number: axis * 2 + (1 where the surface faces along the axis, 0 where against it); OFF_AXIS
for upright surfaces that follow no axis; UNLABELLED for the rest.
"""

import math
from dataclasses import dataclass

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
_GATE_M, _GATE_SIGMAS = 0.015, 0.5  # step between neighbouring pixels of the FITTED surface; its noise is a fraction of a pixel's


@dataclass(frozen=True)
class Labels:
    """`label (H, W) int8`; `coordinate_m (H, W, 2) float32` where each labelled pixel's surface is, in world axes about the sensor:
    along the label's axis (the second is not set), or x and y of those off the axes; `gate_m (H, W)` how far neighbours on one
    surface may differ."""

    label: Array
    coordinate_m: Array
    gate_m: Array


def label_by_normals(points: Array, normals: SurfaceNormals, world_from_sensor: Array, tolerance_rad: float) -> Labels:
    """The axis within `tolerance_rad` of each pixel's normal."""
    n = normals
    return Labels(*_label(points, n.normal, n.range_m, n.sigma_rad, n.residual_m, n.noise_m, world_from_sensor, tolerance_rad))


@compiled
def _label(
    points: Array, normal: Array, range_m: Array, sigma_rad: Array, residual_m: Array, noise_m: Array, r: Array, tolerance_rad: float
) -> tuple[Array, Array, Array]:
    height, width, _ = normal.shape
    labels = np.full((height, width), UNLABELLED, np.int8)
    coordinate, gate = np.empty((height, width, 2), np.float32), np.empty((height, width), np.float32)
    for i in range(height):
        for j in range(width):
            sigma = sigma_rad[i, j]
            if not sigma < _MAX_SIGMA_RAD or not residual_m[i, j] < _MAX_RESIDUAL_SIGMAS * noise_m[i, j]:
                continue
            n0, n1, n2 = normal[i, j, 0], normal[i, j, 1], normal[i, j, 2]
            off = tolerance_rad + _SIGMAS * sigma
            least = 1.0 - 0.5 * off * off  # cosine of a small angle
            up = r[2, 0] * n0 + r[2, 1] * n1 + r[2, 2] * n2
            label = UNLABELLED
            for axis in range(3):
                along = r[axis, 0] * n0 + r[axis, 1] * n1 + r[axis, 2] * n2
                if abs(along) > least:
                    label = axis * 2 + (1 if along > 0 else 0)
            if label == UNLABELLED and abs(up) < _MAX_TILT_RAD + sigma:
                label = OFF_AXIS
            if label == UNLABELLED:
                continue
            labels[i, j] = label
            x, y, z = points[i, j, 0], points[i, j, 1], points[i, j, 2]
            fitted = range_m[i, j] / math.sqrt(x * x + y * y + z * z)
            first, last = (label // 2, label // 2) if label < OFF_AXIS else (0, 1)
            for a in range(first, last + 1):
                coordinate[i, j, a - first] = (r[a, 0] * x + r[a, 1] * y + r[a, 2] * z) * fitted
            gate[i, j] = np.float32(_GATE_M) + np.float32(_GATE_SIGMAS) * noise_m[i, j]
    return labels, coordinate, gate
