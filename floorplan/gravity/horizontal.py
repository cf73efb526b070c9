"""The vertical in one frame, from the horizontal surfaces it shows."""

from dataclasses import dataclass

import numpy as np

from floorplan.gravity.normals import OrientedPoints
from floorplan.model.checks import Array
from floorplan.model.scan import NoiseModel

SEARCH_RAD = np.deg2rad(12.0)  # about the prediction: the odometry bends by less between two looks at a floor
NARROW_RAD = np.deg2rad(6.0)  # noise of one normal
MIN_POINTS = 20  # of the thinned grid: a degree each way
MIN_SPREAD_M = 0.25  # root mean square extent of a surface in its short direction; smaller ones tilt with their noise
BIN_M = 0.05
LEVELS = 3  # floor, ceiling, a table
BAND_SIGMAS = 3.0
MIN_BAND_M = 0.03
CORRELATED_POINTS = 6.0  # neighbouring depths err together: so many points of the thinned grid count as one
SYSTEMATIC_RAD = np.deg2rad(0.3)  # depth ripple tilts a surface however many points it has


@dataclass(frozen=True)
class UpInFrame:
    """`up_sensor (3,)` unit and its standard deviation per direction."""

    up_sensor: Array
    sigma_rad: float


def up_in_frame(oriented: OrientedPoints, predicted_up: Array, noise: NoiseModel) -> UpInFrame | None:
    """The vertical of one frame near `predicted_up (3,)`, sensor axes; None when no horizontal surface of any size is seen."""
    near = oriented.where(np.abs(oriented.normal @ predicted_up) > np.cos(SEARCH_RAD))
    if len(near) < MIN_POINTS:
        return None
    up = mean_axis(near.normal, predicted_up)
    near = near.where(np.abs(near.normal @ up) > np.cos(NARROW_RAD))
    if len(near) < MIN_POINTS:
        return None
    up = mean_axis(near.normal, up)
    return _fitted(near.point_m, up, noise)


def mean_axis(normals: Array, about: Array) -> Array:
    """Mean of unit normals (P, 3) without regard to their sign, on the side of `about (3,)`."""
    side = np.sign(normals @ about)
    mean = (normals * side[:, None]).sum(axis=0)
    return np.asarray(mean / np.linalg.norm(mean))


def _fitted(point_m: Array, up: Array, noise: NoiseModel) -> UpInFrame | None:
    """Common normal of the commonest levels: the smallest principal direction of their pooled scatter."""
    sigma = noise.sigma_m(np.linalg.norm(point_m, axis=1))
    height = point_m @ up
    free = np.ones(len(height), dtype=bool)
    scatter, count = np.zeros((3, 3)), 0.0
    for _ in range(LEVELS):
        if free.sum() < MIN_POINTS:
            break
        level = _commonest(height[free])
        on_level = free & (np.abs(height - level) < np.maximum(MIN_BAND_M, BAND_SIGMAS * sigma))
        free &= np.abs(height - level) > 2 * np.maximum(MIN_BAND_M, BAND_SIGMAS * sigma)
        if on_level.sum() < MIN_POINTS:
            continue
        weight = sigma[on_level] ** -2
        centred = point_m[on_level] - np.average(point_m[on_level], axis=0, weights=weight)
        scatter += (centred * weight[:, None]).T @ centred
        count += float(weight.sum())
    if count == 0.0:
        return None
    value, vector = np.linalg.eigh(scatter / count)
    if value[1] < MIN_SPREAD_M**2:
        return None
    normal = vector[:, 0] * np.sign(vector[:, 0] @ up)
    if normal @ up < np.cos(NARROW_RAD):
        return None
    sigma_rad = np.sqrt(CORRELATED_POINTS / (count * value[1]))
    return UpInFrame(normal, float(np.hypot(sigma_rad, SYSTEMATIC_RAD)))


def _commonest(height: Array) -> float:
    """Centre of the fullest bin."""
    low = float(height.min())
    counts = np.bincount(((height - low) / BIN_M).astype(int))
    return low + (float(np.argmax(counts)) + 0.5) * BIN_M
