"""What one sweep shows: points, and how the surface faces where their neighbourhood is a line."""

import math
from dataclasses import dataclass

import numpy as np

from floorplan.grid.normals import NoiseScale, pixel_weights, surface_normals
from floorplan.model.checks import Array
from floorplan.model.scan import Frame, Sensor

_WINDOW_M = 0.20  # as wide as the narrowest wall piece worth drawing
_NORMAL_SIGMA_RAD = math.radians(2.5)
_FLAT_SIGMAS = 3.0  # a window that fits worse holds an edge or clutter
_LONE_M = 0.25  # clutter points further from both neighbours graze something or hit an edge
_FARTHEST_M = 30.0  # beyond, beams lie half a metre apart and graze


@dataclass(frozen=True)
class SweepSurfaces:
    """Points and unit normals in the sensor's axes.

    `row (n, 4)`: x, y, normal x, normal y (0, 0 in clutter); `sigma_m (n,)` of each.
    """

    row: Array
    sigma_m: Array


def sweep_surfaces(frame: Frame, sensor: Sensor) -> SweepSurfaces:
    """All points of a sweep (1 x N) that came back, with the normals of those that lie on a surface."""
    points = np.ascontiguousarray(frame.points)
    fitted = surface_normals(points, pixel_weights(points, None), sensor, NoiseScale(), _WINDOW_M, _NORMAL_SIGMA_RAD)
    normal, sigma = fitted.normal[0, :, :2].astype(np.float64), fitted.noise_m[0].astype(np.float64)
    size = np.hypot(normal[:, 0], normal[:, 1])
    place = points[0, :, :2].astype(np.float64)
    with np.errstate(invalid="ignore"):  # NaN where nothing came back compares as False
        flat = (fitted.residual_m[0] < _FLAT_SIGMAS * sigma) & (size > 0)
        spacing = _spacing(place)
        seen = (np.hypot(place[:, 0], place[:, 1]) < _FARTHEST_M) & (flat | ~(spacing > _LONE_M))
    normal = np.where(flat[:, None], normal / size[:, None], 0.0)
    sigma = np.where(flat, sigma, np.hypot(sigma, spacing))
    return SweepSurfaces(np.column_stack((place[seen], normal[seen])), sigma[seen])


def _spacing(place: Array) -> Array:
    """Distance (n,) to the nearer of the two neighbouring beams' points: clutter is known no better than that."""
    gap = np.hypot(*np.diff(place, axis=0).T)
    gap = np.where(np.isfinite(gap), gap, np.inf)
    return np.asarray(np.minimum(np.concatenate(([np.inf], gap)), np.concatenate((gap, [np.inf]))))
