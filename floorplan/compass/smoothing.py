"""A slowly wandering angle from noisy readings with gaps: robust fixed-interval smoothing, past and future."""

import math
from dataclasses import dataclass

import numpy as np

from floorplan.compass.slips import without_strays
from floorplan.compiled import compiled
from floorplan.model.checks import Array

_HUBER = 2.5  # standard deviations beyond which a reading counts less
_ROUNDS = 4
_VAGUE_RAD2 = 1.0  # variance before the first reading
_FEWEST_READINGS = 12  # fewer say nothing about their own noise
_DEFAULT_WALK_RAD = math.radians(0.1)
_READING_SCALE_RANGE = (0.2, 5.0)
SHARED_ERRORS = 1.0  # least factor on the readings' sigma where neighbouring ones err alike: their differences hide it
_MEAN_OF_MEDIAN_SQUARE = 2.198  # mean over median of a squared normal variable
_READING_SCALES = 0.25 * np.sqrt(2.0) ** np.arange(10)  # 0.25 to 5.7 by steps of 1.4: finer ones change nothing
_WALK_SIZES_RAD = np.radians(np.geomspace(0.005, 5.0, 19))  # per unit of `step_scale`: the best odometry and the worst
_FIRST_READINGS = 7
_STRAY_SHARE = 0.05  # of the readings, of furniture or another building wing ...
_STRAY_RANGE_RAD = math.pi / 2  # ... anywhere in a quarter turn
_MIN_STEP_SIGMA_RAD = math.radians(0.002)  # odometry is never perfect


@dataclass(frozen=True)
class SmoothedAngle:
    """`angle_rad (K,)` and its standard deviation `sigma_rad (K,)`; `step_sigma_rad (K - 1,)` the process noise used.

    `shared` is the part of the readings' sigma that their differences do not show, because neighbours err alike.
    """

    angle_rad: Array
    sigma_rad: Array
    step_sigma_rad: Array
    shared: float = 0.0


def smooth_angle(
    angle_rad: Array,
    sigma_rad: Array,
    step_scale: Array,
    least_scale: float = 0.0,
    slips: bool = False,
    most_scale: float = _READING_SCALE_RANGE[1],
    white_scale: float = 0.0,
) -> SmoothedAngle:
    """Random-walk smoothing of `angle_rad (K,)` with `sigma_rad (K,)` (infinite where nothing was read).

    `step_scale (K - 1,)` is how the walk's standard deviation varies from step to step. The size of the walk and of
    the readings' own noise (at least `least_scale` of their sigma) are learnt from the readings; readings far off are down-weighted.
    `slips`: the walk may rest for long and then move by much within a few steps, as phones' headings do; then the readings' own
    noise is at most `most_scale` of their sigma: a pose that trembles from frame to frame is the odometry's, and looks the same.
    And it is at least `white_scale`, which no two readings share: where the walk is large, differences do not show it.
    """
    if slips:
        reading_scale, walk_size = _likely_sizes(angle_rad, sigma_rad, step_scale, (white_scale, most_scale))
    else:
        reading_scale, walk_size = _noise_sizes(angle_rad, sigma_rad, step_scale)
    step = np.maximum(walk_size * step_scale, _MIN_STEP_SIGMA_RAD)
    sigma = sigma_rad * max(reading_scale, least_scale)  # averaging cannot remove what neighbours share
    if slips:
        believed, walked = without_strays(angle_rad, sigma**2, step**2)
        mean, variance = _smooth(angle_rad, believed, walked)
    else:
        mean, variance = _without_outliers(angle_rad, sigma, step)
    shared = math.sqrt(max(least_scale**2 - reading_scale**2, 0.0))
    return SmoothedAngle(mean, np.sqrt(variance), step, shared)


def _without_outliers(angle_rad: Array, sigma: Array, step: Array) -> tuple[Array, Array]:
    """Mean and variance (K,) of a walk without slips: readings far off it count less."""
    weight = np.ones(len(angle_rad))
    for _ in range(_ROUNDS):
        mean, variance = _smooth(angle_rad, sigma**2 / weight, step**2)
        off = np.abs(angle_rad - mean) / np.where(np.isfinite(sigma), sigma, np.inf)
        weight = np.where(off > _HUBER, _HUBER / np.maximum(off, 1e-12), 1.0)
    return mean, variance


def _noise_sizes(angle_rad: Array, sigma_rad: Array, step_scale: Array) -> tuple[float, float]:
    """Factor on the readings' sigma, and size of the walk, from how differences of readings grow with their lag.

    The square of a difference is, on average, `factor^2 (sigma_1^2 + sigma_2^2) + size^2 walk`: noise does not grow
    with the lag, drift does. Medians keep outliers out; non-negative least squares finds both.
    """
    read = np.flatnonzero(np.isfinite(sigma_rad))
    if len(read) < _FEWEST_READINGS:
        return 1.0, _DEFAULT_WALK_RAD
    travelled = np.concatenate(([0.0], np.cumsum(step_scale**2)))
    rows, squares = [], []
    for lag in (1, 2, 3, 4, 6, 8, 12, 16):
        first, second = read[:-lag], read[lag:]
        if len(first) < _FEWEST_READINGS // 2:
            break
        rows.append((np.median(sigma_rad[first] ** 2 + sigma_rad[second] ** 2), np.median(travelled[second] - travelled[first])))
        squares.append(_MEAN_OF_MEDIAN_SQUARE * np.median((angle_rad[second] - angle_rad[first]) ** 2))
    relative = np.array(rows) / np.maximum(np.array(squares), 1e-14)[:, None]
    factor, size = np.sqrt(_two_non_negative(relative))
    return float(np.clip(factor, *_READING_SCALE_RANGE)), float(size)


def _likely_sizes(angle_rad: Array, sigma_rad: Array, step_scale: Array, scale_range: tuple[float, float]) -> tuple[float, float]:
    """Factor on the readings' sigma, and size of the walk, that make the readings most likely, each predicted from those before.

    Most odometry holds its heading for long and then slips by degrees within a few steps: typical differences say
    that it never drifts. The likelihood, with a share of stray readings, hears the few steps that move and the many that do not.
    """
    if np.isfinite(sigma_rad).sum() < _FEWEST_READINGS:
        return 1.0, _DEFAULT_WALK_RAD
    variance, walk = sigma_rad**2, step_scale**2
    best, most = (1.0, _DEFAULT_WALK_RAD), -np.inf
    for factor in _READING_SCALES[(scale_range[0] <= _READING_SCALES) & (scale_range[1] >= _READING_SCALES)]:
        for size in _WALK_SIZES_RAD:
            likelihood = _log_likelihood(angle_rad, factor**2 * variance, np.maximum(size**2 * walk, _MIN_STEP_SIGMA_RAD**2))
            if likelihood > most:
                best, most = (float(factor), float(size)), likelihood
    return best


@compiled
def _beginning(reading: Array, variance: Array) -> tuple[float, float]:
    """Where the walk begins: the middle of the first readings, lest one of them be astray, as sure as one reading."""
    first = np.flatnonzero(np.isfinite(variance))[:_FIRST_READINGS]
    return float(np.median(reading[first])), float(np.median(variance[first]))


@compiled
def _log_likelihood(reading: Array, variance: Array, step_variance: Array) -> float:
    """Of a scalar random walk's readings: Kalman filter whose readings may be astray."""
    total, (m, v) = 0.0, _beginning(reading, variance)
    for k in range(len(reading)):
        if k > 0:
            v += step_variance[k - 1]
        if not np.isfinite(variance[k]):
            continue
        spread, off = v + variance[k], reading[k] - m
        near = (1 - _STRAY_SHARE) * math.exp(-0.5 * off * off / spread) / math.sqrt(2 * math.pi * spread)
        stray = _STRAY_SHARE / _STRAY_RANGE_RAD
        total += math.log(near + stray)
        gain = near / (near + stray) * v / spread  # what may be astray moves the angle that much less
        m, v = m + gain * off, (1 - gain) * v
    return total


def _two_non_negative(columns: Array) -> Array:
    """The non-negative x (2,) that brings `columns (K, 2) @ x` closest to ones."""
    right, gram = columns.sum(axis=0), columns.T @ columns
    determinant = gram[0, 0] * gram[1, 1] - gram[0, 1] ** 2
    if determinant > 0:
        both = np.array((gram[1, 1] * right[0] - gram[0, 1] * right[1], gram[0, 0] * right[1] - gram[0, 1] * right[0])) / determinant
        if (both >= 0).all():
            return np.asarray(both)
    size = np.diag(gram)
    alone = np.where(size > 0, np.maximum(right, 0.0) / np.where(size > 0, size, 1.0), 0.0)
    better = int(np.argmax(alone * right))  # what each alone takes off the sum of squares
    return np.where(np.arange(2) == better, alone, 0.0)


@compiled
def _smooth(reading: Array, variance: Array, step_variance: Array) -> tuple[Array, Array]:
    """Kalman filter and Rauch-Tung-Striebel smoother of a scalar random walk."""
    count = len(reading)
    mean, var = np.empty(count), np.empty(count)
    known = np.isfinite(variance)
    m, v = 0.0, _VAGUE_RAD2
    if known.any():
        m = reading[np.argmax(known)]
    for k in range(count):
        if k > 0:
            v += step_variance[k - 1]
        if known[k]:
            gain = v / (v + variance[k])
            m, v = m + gain * (reading[k] - m), (1 - gain) * v
        mean[k], var[k] = m, v
    for k in range(count - 2, -1, -1):
        gain = var[k] / (var[k] + step_variance[k])
        mean[k] += gain * (mean[k + 1] - mean[k])
        var[k] += gain**2 * (var[k + 1] - var[k] - step_variance[k])
    return mean, var
