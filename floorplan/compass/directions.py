"""How the upright surfaces of one frame are directed: a histogram modulo 90 degrees and its refinement."""

import math
from dataclasses import dataclass

import numpy as np

from floorplan.geometry import wrap_to
from floorplan.grid.normals import SurfaceNormals
from floorplan.model.checks import Array

QUARTER_RAD = math.pi / 2
BINS = 180  # half a degree each
BIN_RAD = QUARTER_RAD / BINS
_MAX_TILT_SIN = math.sin(math.radians(12.0))  # a wall's normal is level within noise and gravity's error
_SMOOTHING_BINS = 3.0  # 1.5 degrees: the spread of normals of one wall
_MAX_RESIDUAL_SIGMAS = 2.5  # a window that fits worse holds an edge
_CORRELATION_M = 0.5  # normals closer than this share windows and surface ripple
_SURFACE_SIGMA_RAD = math.radians(0.3)  # one wall piece of that size is no more planar or upright than this


@dataclass(frozen=True)
class Directions:
    """Azimuths of upright surface normals in a level frame: `azimuth_rad (K,)`, `weight (K,)`; `patches` how many
    independent pieces of surface they stand for."""

    azimuth_rad: Array
    weight: Array
    patches: float


@dataclass(frozen=True)
class YawEstimate:
    """A Manhattan yaw modulo 90 degrees: `share` of the upright surfaces that agree with it."""

    yaw_rad: float
    sigma_rad: float
    share: float


def upright_directions(normals: SurfaceNormals, level_from_sensor: Array, noise_sigma_m: Array) -> Directions:
    """The upright surfaces of a frame, weighted by how well their normals are known."""
    good = normals.residual_m < _MAX_RESIDUAL_SIGMAS * noise_sigma_m
    level = normals.normal[good].astype(np.float64) @ level_from_sensor.T
    upright = np.abs(level[:, 2]) < _MAX_TILT_SIN
    sigma = normals.sigma_rad[good][upright].astype(np.float64)
    range_m = normals.range_m[good][upright]
    weight = normals.weight[good][upright] / (sigma**2 + _SURFACE_SIGMA_RAD**2)
    azimuth = np.arctan2(level[upright, 1], level[upright, 0])
    patches = _patches(azimuth, range_m, normals.weight.shape)
    return Directions(azimuth, weight, patches)


def _patches(azimuth_rad: Array, range_m: Array, shape: tuple[int, ...]) -> float:
    """Number of pieces of `_CORRELATION_M` the pixels cover, counting a pixel as a fixed part of the view."""
    if len(azimuth_rad) == 0:
        return 0.0
    pixel_m = np.median(range_m) * 1.5 / max(shape)  # a view of roughly 1.5 rad
    area = len(azimuth_rad) * (pixel_m if min(shape) == 1 else pixel_m**2)
    return float(max(area / (_CORRELATION_M if min(shape) == 1 else _CORRELATION_M**2), 1.0))


def quarter_histogram(directions: Directions) -> Array:
    """Share of the upright surface per half degree of yaw modulo 90 degrees (BINS,), smoothed, summing to one at most."""
    position = np.mod(directions.azimuth_rad, QUARTER_RAD) / BIN_RAD
    low = np.floor(position).astype(np.int64)
    upper = position - low  # split linearly between bins, so that no direction is preferred
    total = np.bincount(low % BINS, directions.weight * (1 - upper), BINS) + np.bincount((low + 1) % BINS, directions.weight * upper, BINS)
    offsets = np.arange(-10, 11)
    kernel = np.exp(-0.5 * (offsets / _SMOOTHING_BINS) ** 2)
    smooth = sum(k * np.roll(total, o) for k, o in zip(kernel, offsets, strict=True))
    return np.asarray(smooth / max(float(total.sum()), 1e-12))


def refine_yaw(directions: Directions, near_rad: float, half_width_rad: float) -> YawEstimate | None:
    """Truncated circular mean about `near_rad`, the window closing in on the peak; None where hardly any surface agrees."""
    if directions.patches == 0:
        return None
    yaw, total = near_rad, float(directions.weight.sum())
    width = half_width_rad
    for _ in range(4):
        off = wrap_to(directions.azimuth_rad - yaw, QUARTER_RAD)
        inside = np.abs(off) < width
        weight = directions.weight[inside]
        if weight.sum() <= 0.02 * total:
            return None
        yaw += float(np.average(off[inside], weights=weight))
        spread = math.sqrt(float(np.average((off[inside] - np.average(off[inside], weights=weight)) ** 2, weights=weight)))
        width = min(half_width_rad, max(2.5 * spread, math.radians(1.0)))
    share = float(weight.sum()) / total
    pieces = max(directions.patches * share, 0.25)
    return YawEstimate(yaw, math.hypot(spread, _SURFACE_SIGMA_RAD) / math.sqrt(pieces), share)
