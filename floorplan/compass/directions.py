"""How the upright surfaces of one frame are directed: a histogram modulo 90 degrees and its refinement."""

import math
from dataclasses import dataclass

import numpy as np

from floorplan.compiled import compiled
from floorplan.grid.normals import SurfaceNormals
from floorplan.model.checks import Array

QUARTER_RAD = math.pi / 2
BINS = 180  # half a degree each
BIN_RAD = QUARTER_RAD / BINS
_MAX_TILT_SIN = math.sin(math.radians(12.0))  # a wall's normal is level within noise and gravity's error
_SMOOTHING_BINS = 3.0  # 1.5 degrees: the spread of normals of one wall
_MAX_RESIDUAL_SIGMAS = 2.5  # a window that fits worse holds an edge
_CORRELATION_M = 0.5  # normals closer than this share windows and surface ripple
_VIEW_RAD = 1.5  # the angle a view takes in, roughly: only for counting patches
_SURFACE_SIGMA_RAD = math.radians(0.3)  # one wall piece of that size is no more planar or upright than this
_LEAST_SHARE = 0.02  # of the upright surface: less is chance
_CLOSEST_RAD = math.radians(1.0)  # the window about a peak never closes further
_WINDOW_SPREADS = 2.5
_ROUNDS = 4


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


@dataclass(frozen=True)
class UprightSurfaces:
    """Upright normals of one frame whose windows may yet turn out too rough: `azimuth_rad (K,)`, `weight (K,)` and `misfit (K,)`, the
    windows' rms in what the noise model expects, all float32; `piece` how many independent pieces of surface a pixel stands for."""

    azimuth_rad: Array
    weight: Array
    misfit: Array
    piece: float

    def directions(self, noise_scale: float = 1.0) -> Directions:
        """The ones whose windows fit, where readings are `noise_scale` as noisy as the model says."""
        fits = self.misfit < _MAX_RESIDUAL_SIGMAS * noise_scale
        count = np.count_nonzero(fits)
        return Directions(self.azimuth_rad[fits], self.weight[fits], max(count * self.piece, 1.0) if count else 0.0)


NOTHING_UPRIGHT = UprightSurfaces(*(np.zeros(0, np.float32),) * 3, 0.0)


def upright_surfaces(normals: SurfaceNormals, level_from_sensor: Array, step: int = 1, max_noise_scale: float = 1.0) -> UprightSurfaces:
    """The upright surfaces of a frame, weighted by how well their normals are known; every `step`-th pixel."""
    most = _MAX_RESIDUAL_SIGMAS * max_noise_scale
    fields, mean_range = _upright(
        *(normals.normal, normals.sigma_rad, normals.residual_m, normals.noise_m, normals.weight, normals.range_m),
        *(level_from_sensor, step, most),
    )
    shape = normals.weight.shape
    pixel_m = mean_range * _VIEW_RAD / max(shape) * step
    piece = pixel_m / _CORRELATION_M if min(shape) == 1 else (pixel_m / _CORRELATION_M) ** 2
    return UprightSurfaces(fields[0], fields[1], fields[2], piece)


@compiled
def _upright(
    normal: Array, sigma: Array, residual: Array, noise: Array, weight: Array, range_m: Array, level: Array, step: int, most: float
) -> tuple[Array, float]:
    """Azimuth, weight and misfit (3, K) float32 of the upright normals whose misfit is less than `most`; their mean range."""
    height, width, _ = normal.shape
    found = np.empty((3, height * width), np.float32)
    count, range_sum = 0, 0.0
    for i in range(0, height, step if height > 1 else 1):
        for j in range(0, width, step):
            if not residual[i, j] < most * noise[i, j]:
                continue
            n0, n1, n2 = normal[i, j, 0], normal[i, j, 1], normal[i, j, 2]
            if abs(level[2, 0] * n0 + level[2, 1] * n1 + level[2, 2] * n2) >= _MAX_TILT_SIN:
                continue
            x = level[0, 0] * n0 + level[0, 1] * n1 + level[0, 2] * n2
            y = level[1, 0] * n0 + level[1, 1] * n1 + level[1, 2] * n2
            found[0, count] = math.atan2(y, x)
            found[1, count] = weight[i, j] / (sigma[i, j] ** 2 + _SURFACE_SIGMA_RAD**2)
            found[2, count] = residual[i, j] / noise[i, j]
            range_sum += range_m[i, j]
            count += 1
    return found[:, :count].copy(), range_sum / max(count, 1)


def quarter_histogram(directions: Directions) -> Array:
    """Share of the upright surface per half degree of yaw modulo 90 degrees (BINS,), smoothed, summing to one at most."""
    position = np.mod(directions.azimuth_rad, QUARTER_RAD) / BIN_RAD
    low = np.floor(position).astype(np.int64)
    upper = position - low  # split linearly between bins, so that no direction is preferred
    total = np.bincount(low % BINS, directions.weight * (1 - upper), BINS) + np.bincount((low + 1) % BINS, directions.weight * upper, BINS)
    spectrum = np.fft.rfft(total) * np.fft.rfft(_SMOOTHING_KERNEL)
    return np.asarray(np.fft.irfft(spectrum, BINS) / max(float(total.sum()), 1e-12))


def _smoothing_kernel() -> Array:
    """Gaussian about bin 0, round the circle; its peak is one, so that a wall without noise scores its full share."""
    bins = np.arange(BINS)
    offset = np.minimum(bins, BINS - bins)
    return np.asarray(np.exp(-0.5 * (offset / _SMOOTHING_BINS) ** 2))


_SMOOTHING_KERNEL = _smoothing_kernel()


def refine_yaw(directions: Directions, near_rad: float, half_width_rad: float) -> YawEstimate | None:
    """Truncated circular mean about `near_rad`, the window closing in on the peak; None where hardly any surface agrees."""
    if directions.patches == 0:
        return None
    yaw, spread, share = _truncated_mean(directions.azimuth_rad, directions.weight, near_rad, half_width_rad)
    if share <= _LEAST_SHARE:
        return None
    pieces = max(directions.patches * share, 0.25)
    return YawEstimate(yaw, math.hypot(spread, _SURFACE_SIGMA_RAD) / math.sqrt(pieces), share)


@compiled
def _truncated_mean(azimuth: Array, weight: Array, near: float, half_width: float) -> tuple[float, float, float]:
    """Mean, spread and share of the weight inside a window that closes in, modulo a quarter turn."""
    yaw, width, spread, share, total = near, half_width, 0.0, 0.0, weight.sum()
    for _ in range(_ROUNDS):
        inside, first, second = 0.0, 0.0, 0.0
        for k in range(len(azimuth)):
            off = azimuth[k] - yaw
            off -= QUARTER_RAD * math.floor(off / QUARTER_RAD + 0.5)
            if abs(off) < width:
                inside += weight[k]
                first += weight[k] * off
                second += weight[k] * off * off
        share = inside / total
        if share <= _LEAST_SHARE:
            break
        mean = first / inside
        spread = math.sqrt(max(second / inside - mean * mean, 0.0))
        yaw += mean
        width = min(half_width, max(_WINDOW_SPREADS * spread, _CLOSEST_RAD))
    return yaw, spread, share
