"""Surface normals of an organised grid from local plane fits in inverse range.

On a plane `n . p = d` a ray of unit direction `r` has the inverse range `1 / rho = (n / d) . r`: linear in `r`, whatever
the sensor. So a window of pixels gives `g = n / d` from sums of `r r^T` and `r / rho`, which summed-area tables provide
for any window at the cost of four look-ups; a sweep (1 x N) is the same fit without its vertical part.
"""

import math
from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from floorplan.compiled import compiled, inlined
from floorplan.model.checks import Array
from floorplan.model.scan import NoiseModel, Sensor

_CHANNELS = 11  # weight, six of r r^T, three of r / rho, 1 / rho^2
_MAX_WINDOW_M = 0.8  # beyond this a window bridges corners
_MAX_HALF_WINDOW_PX = 24  # ... and a close surface needs no more pixels than this
_BINS_PER_M = 100.0  # windows are chosen by range to the centimetre
_RANGE_BIN_M = 1.0 / _BINS_PER_M
_FARTHEST_M = 100.0  # beyond, windows stay as they are there: nothing indoors
_RIDGE = 1e-9  # of the trace: decides the direction a level sweep cannot see
_MIN_FILL = 0.6  # share of a window that must have returned
_MIN_COS_INCIDENCE = 0.06  # 86.5 degrees: beyond, one pixel's footprint is longer than the window
_CONFIDENCE_WEIGHT = np.array([0.0, 0.3, 1.0], dtype=np.float32)  # phones: none / medium / high


@dataclass(frozen=True)
class NoiseScale:
    """By how much readings (`pixel`) and normals (`normal`) are noisier than the sensor's model with independent pixels says."""

    pixel: float = 1.0
    normal: float = 1.0


@dataclass(frozen=True)
class SurfaceNormals:
    """Per pixel: `normal (H, W, 3) float32` towards the sensor, NaN where there is none; `range_m (H, W)` of the fitted
    surface, `sigma_rad (H, W)` of the normal, `residual_m (H, W)` rms of the window along the rays; `noise_m (H, W)` what
    one reading's standard deviation should be there, `weight (H, W)` of the pixel."""

    normal: Array
    range_m: Array
    sigma_rad: Array
    residual_m: Array
    noise_m: Array
    weight: Array


def pixel_weights(points: Array, confidence: Array | None) -> Array:
    """Weight (H, W) float32 of each pixel: 0 where nothing came back or the sensor itself does not trust it."""
    seen = np.isfinite(points[..., 2])
    if confidence is None:
        return seen.astype(np.float32)
    return np.asarray(np.where(seen, _CONFIDENCE_WEIGHT[np.minimum(confidence, 2)], np.float32(0)))


def surface_normals(
    points: Array, weight: Array, sensor: Sensor, noise: NoiseScale, window_m: float, normal_sigma_rad: float
) -> SurfaceNormals:
    """Normals of `points (H, W, 3)`: windows of `window_m`, larger where noise would make the normal worse than `normal_sigma_rad`."""
    ray_step = sensor.ray_step_rad * (sensor.width / points.shape[1])
    model = np.array((sensor.noise.constant_m, sensor.noise.linear, sensor.noise.quadratic_per_m)) * noise.pixel
    scale, flat = noise.pixel * noise.normal, len(points) == 1
    farthest_m = min(sensor.max_range_m, _FARTHEST_M)
    half_px = _half_windows_px(sensor.noise, scale, ray_step, window_m, normal_sigma_rad, farthest_m, flat)
    fields = _fit_windows(np.ascontiguousarray(points), weight, model, half_px, ray_step, noise.normal)
    return SurfaceNormals(*fields, weight)


@compiled
def _ray_tables(points: Array, weight: Array) -> Array:
    """Summed-area tables (H + 1, W + 1, channels) of the fit's sums. Row sums are kept in scalars: registers, not memory."""
    height, width, _ = points.shape
    table = np.empty((height + 1, width + 1, _CHANNELS))
    table[0], table[:, 0] = 0.0, 0.0
    for i in range(height):
        s0, s1, s2, s3, s4, s5, s6, s7, s8, s9, s10 = 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
        above, row = table[i], table[i + 1]
        for j in range(width):
            m = weight[i, j]
            if m > 0:
                x, y, z = points[i, j, 0], points[i, j, 1], points[i, j, 2]
                w = 1.0 / math.sqrt(x * x + y * y + z * z)
                a, b, c = x * w, y * w, z * w
                s0 += m
                s1 += m * a * a
                s2 += m * a * b
                s3 += m * a * c
                s4 += m * b * b
                s5 += m * b * c
                s6 += m * c * c
                s7 += m * a * w
                s8 += m * b * w
                s9 += m * c * w
                s10 += m * w * w
            up, to = above[j + 1], row[j + 1]
            to[0], to[1], to[2], to[3] = up[0] + s0, up[1] + s1, up[2] + s2, up[3] + s3
            to[4], to[5], to[6], to[7] = up[4] + s4, up[5] + s5, up[6] + s6, up[7] + s7
            to[8], to[9], to[10] = up[8] + s8, up[9] + s9, up[10] + s10
    return table


@lru_cache(maxsize=32)
def _half_windows_px(
    noise: NoiseModel, scale: float, ray_step: float, window_m: float, normal_sigma: float, farthest_m: float, flat: bool
) -> Array:
    """Half window per `_RANGE_BIN_M` of range: `window_m` across, and more until the fitted normal is as sure as asked."""
    range_m = (np.arange(math.ceil(farthest_m / _RANGE_BIN_M) + 1) + 0.5) * _RANGE_BIN_M
    pixel_m = range_m * ray_step
    metric = np.floor(0.5 * window_m / pixel_m + 0.5)
    # sigma / (spread sqrt(count)) = normal_sigma with spread = pixel half / sqrt(3): count 2 half + 1 or its square.
    need = math.sqrt(3.0) * scale * noise.sigma_m(range_m) / (normal_sigma * pixel_m)
    sure = (0.5 * need * need) ** (1.0 / 3.0) if flat else 0.25 * (np.sqrt(1.0 + 8.0 * need) - 1.0)
    largest = np.minimum(np.floor(0.5 * _MAX_WINDOW_M / pixel_m + 0.5), _MAX_HALF_WINDOW_PX)
    half = np.maximum(np.minimum(np.maximum(metric, np.ceil(sure)), largest), 2 if flat else 1)
    return np.asarray(half.astype(np.int64))


@inlined
def _plane(table: Array, top: int, bottom: int, left: int, right: int, total: float) -> tuple[float, float, float, float, float]:
    """The plane that a window's sums give: `g` times the determinant, the determinant (0: no plane), the sum of squared residuals.

    `total` weight of the window. By cofactors: one division.
    """
    low, beside, below, high = table[top, left], table[top, right], table[bottom, left], table[bottom, right]
    ridge = _RIDGE * total
    xx = high[1] - beside[1] - below[1] + low[1] + ridge
    xy = high[2] - beside[2] - below[2] + low[2]
    xz = high[3] - beside[3] - below[3] + low[3]
    yy = high[4] - beside[4] - below[4] + low[4] + ridge
    yz = high[5] - beside[5] - below[5] + low[5]
    zz = high[6] - beside[6] - below[6] + low[6] + ridge
    c00, c01, c02 = yy * zz - yz * yz, xz * yz - xy * zz, xy * yz - xz * yy
    c11, c12, c22 = xx * zz - xz * xz, xy * xz - xx * yz, xx * yy - xy * xy
    determinant = max(xx * c00 + xy * c01 + xz * c02, 0.0)
    s7 = high[7] - beside[7] - below[7] + low[7]
    s8 = high[8] - beside[8] - below[8] + low[8]
    s9 = high[9] - beside[9] - below[9] + low[9]
    g0, g1, g2 = c00 * s7 + c01 * s8 + c02 * s9, c01 * s7 + c11 * s8 + c12 * s9, c02 * s7 + c12 * s8 + c22 * s9
    square = high[10] - beside[10] - below[10] + low[10] - (g0 * s7 + g1 * s8 + g2 * s9) / determinant
    return g0, g1, g2, determinant, square


@compiled
def _fit_windows(
    points: Array, weight: Array, noise: Array, half_px: Array, ray_step: float, normal_scale: float
) -> tuple[Array, Array, Array, Array, Array]:
    height, width, _ = points.shape
    table = _ray_tables(points, weight)
    normal = np.full((height, width, 3), np.nan, np.float32)
    fitted = np.full((height, width), np.nan, np.float32)
    sigma = np.full((height, width), np.nan, np.float32)
    residual = np.full((height, width), np.nan, np.float32)
    expected = np.full((height, width), np.nan, np.float32)
    for i in range(height):
        for j in range(width):
            if weight[i, j] <= 0:
                continue
            x, y, z = points[i, j, 0], points[i, j, 1], points[i, j, 2]
            square_range = x * x + y * y + z * z
            rho = math.sqrt(square_range)
            sigma_m = noise[0] + noise[1] * rho + noise[2] * square_range
            expected[i, j] = sigma_m
            half = half_px[min(int(rho * _BINS_PER_M), len(half_px) - 1)]
            top, bottom = max(i - half, 0), min(i + half + 1, height)
            left, right = max(j - half, 0), min(j + half + 1, width)
            least = _MIN_FILL * weight[i, j] * (bottom - top) * (right - left)
            total = table[bottom, right, 0] - table[top, right, 0] - table[bottom, left, 0] + table[top, left, 0]
            if total < least:
                continue
            g0, g1, g2, determinant, square = _plane(table, top, bottom, left, right, total)
            along = g0 * x + g1 * y + g2 * z
            square_size = g0 * g0 + g1 * g1 + g2 * g2
            if determinant <= 0 or along <= 0 or along * along <= _MIN_COS_INCIDENCE * _MIN_COS_INCIDENCE * square_size * square_range:
                continue
            surface_m = determinant * rho / along
            fitted[i, j] = surface_m
            # Judged by the surface's range: by its own, a reading that is too near by chance would weigh more, and draw planes nearer.
            sigma_m = noise[0] + noise[1] * surface_m + noise[2] * surface_m * surface_m
            expected[i, j] = sigma_m
            residual[i, j] = math.sqrt(max(square, 0.0) / total) * square_range
            sigma[i, j] = normal_scale * sigma_m / (rho * ray_step * math.sqrt((half * half + half) / 3.0 * total))
            size = 1.0 / math.sqrt(square_size)
            normal[i, j, 0], normal[i, j, 1], normal[i, j, 2] = -g0 * size, -g1 * size, -g2 * size
    return normal, fitted, sigma, residual, expected
