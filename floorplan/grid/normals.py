"""Surface normals of an organised grid from local plane fits in inverse range.

On a plane `n . p = d` a ray of unit direction `r` has the inverse range `1 / rho = (n / d) . r`: linear in `r`, whatever
the sensor. So a window of pixels gives `g = n / d` from sums of `r r^T` and `r / rho`, which summed-area tables provide
for any window at the cost of four look-ups; a sweep (1 x N) is the same fit without its vertical part.
"""

import math
from dataclasses import dataclass

import numpy as np

from floorplan.compiled import compiled
from floorplan.model.checks import Array
from floorplan.model.scan import Sensor

_CHANNELS = 11  # weight, six of r r^T, three of r / rho, 1 / rho^2
_MAX_WINDOW_M = 0.8  # beyond this a window bridges corners
_MAX_HALF_WINDOW_PX = 24  # ... and a close surface needs no more pixels than this
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
    one reading's standard deviation should be, `weight (H, W)` of the pixel."""

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
    fields = _fit_windows(np.ascontiguousarray(points), weight, model, ray_step, window_m, normal_sigma_rad, noise.normal)
    return SurfaceNormals(*fields, weight)


@compiled
def _ray_tables(points: Array, weight: Array) -> Array:
    """Summed-area tables (H + 1, W + 1, channels) of the fit's sums. Row sums are kept in scalars: registers, not memory."""
    height, width, _ = points.shape
    table = np.zeros((height + 1, width + 1, _CHANNELS))
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


@compiled
def _half_window_px(range_m: float, sigma_m: float, ray_step: float, window_m: float, normal_sigma: float, flat: bool) -> int:
    """Half window: `window_m` across, and more until the fitted normal is as sure as asked."""
    pixel_m = range_m * ray_step
    metric = int(0.5 * window_m / pixel_m + 0.5)
    # sigma / (spread sqrt(count)) = normal_sigma with spread = pixel half / sqrt(3): count 2 half + 1 or its square.
    need = math.sqrt(3.0) * sigma_m / (normal_sigma * pixel_m)
    sure = (0.5 * need * need) ** (1.0 / 3.0) if flat else 0.25 * (math.sqrt(1.0 + 8.0 * need) - 1.0)
    largest = min(int(0.5 * _MAX_WINDOW_M / pixel_m + 0.5), _MAX_HALF_WINDOW_PX)
    return max(min(max(metric, math.ceil(sure)), largest), 2 if flat else 1)


@compiled
def _plane(low: Array, right: Array, below: Array, high: Array, least: float) -> tuple[float, float, float, float, float]:
    """The plane `g` that a window's sums give, by L D L^T, and the window's weight and sum of squares; weight 0 where it gives none.

    The four corners of the window in the tables; `least` weight it must hold.
    """
    s0 = high[0] - right[0] - below[0] + low[0]
    if s0 < least:
        return 0.0, 0.0, 0.0, 0.0, 0.0
    ridge = _RIDGE * s0
    s2, s3 = high[2] - right[2] - below[2] + low[2], high[3] - right[3] - below[3] + low[3]
    i0 = 1.0 / (high[1] - right[1] - below[1] + low[1] + ridge)
    l10, l20 = s2 * i0, s3 * i0
    d1 = high[4] - right[4] - below[4] + low[4] + ridge - l10 * s2
    m21 = high[5] - right[5] - below[5] + low[5] - l20 * s2
    i1 = 1.0 / d1
    l21 = m21 * i1
    d2 = high[6] - right[6] - below[6] + low[6] + ridge - l20 * s3 - l21 * m21
    if d1 <= 0 or d2 <= 0:
        return 0.0, 0.0, 0.0, 0.0, 0.0
    s7, s8 = high[7] - right[7] - below[7] + low[7], high[8] - right[8] - below[8] + low[8]
    s9 = high[9] - right[9] - below[9] + low[9]
    y1 = s8 - l10 * s7
    g2 = (s9 - l20 * s7 - l21 * y1) / d2
    g1 = y1 * i1 - l21 * g2
    g0 = s7 * i0 - l10 * g1 - l20 * g2
    return g0, g1, g2, s0, high[10] - right[10] - below[10] + low[10] - g0 * s7 - g1 * s8 - g2 * s9


@compiled
def _fit_windows(
    points: Array, weight: Array, noise: Array, ray_step: float, window_m: float, normal_sigma: float, normal_scale: float
) -> tuple[Array, Array, Array, Array, Array]:
    height, width, _ = points.shape
    table = _ray_tables(points, weight)
    normal = np.full((height, width, 3), np.nan, np.float32)
    fitted = np.full((height, width), np.nan, np.float32)
    sigma = np.full((height, width), np.nan, np.float32)
    residual = np.full((height, width), np.nan, np.float32)
    expected = np.full((height, width), np.nan, np.float32)
    flat = height == 1
    for i in range(height):
        for j in range(width):
            if weight[i, j] <= 0:
                continue
            x, y, z = points[i, j, 0], points[i, j, 1], points[i, j, 2]
            rho = math.sqrt(x * x + y * y + z * z)
            sigma_m = noise[0] + noise[1] * rho + noise[2] * rho * rho
            expected[i, j] = sigma_m
            half = _half_window_px(rho, sigma_m * normal_scale, ray_step, window_m, normal_sigma, flat)
            top, bottom = max(i - half, 0), min(i + half + 1, height)
            left, right = max(j - half, 0), min(j + half + 1, width)
            least = _MIN_FILL * weight[i, j] * (bottom - top) * (right - left)
            upper, lower = table[top], table[bottom]
            g0, g1, g2, total, square = _plane(upper[left], upper[right], lower[left], lower[right], least)
            if total == 0:
                continue
            size = math.sqrt(g0 * g0 + g1 * g1 + g2 * g2)
            along = (g0 * x + g1 * y + g2 * z) / rho
            if along <= _MIN_COS_INCIDENCE * size:
                continue
            fitted[i, j] = 1.0 / along
            residual[i, j] = math.sqrt(max(square, 0.0) / total) * rho * rho
            spread_m = rho * ray_step * math.sqrt((half * half + half) / 3.0)
            sigma[i, j] = normal_scale * sigma_m / (spread_m * math.sqrt(total))
            normal[i, j, 0], normal[i, j, 1], normal[i, j, 2] = -g0 / size, -g1 / size, -g2 / size
    return normal, fitted, sigma, residual, expected
