"""The vertical in the odometry's world as it wanders: measured in some frames, a random walk in between."""

from dataclasses import dataclass, replace

import numpy as np

from floorplan.model.checks import Array

LEAST_DRIFT_RAD2_PER_S = np.deg2rad(0.02) ** 2  # the best odometry ...
MOST_DRIFT_RAD2_PER_S = np.deg2rad(5.0) ** 2  # ... and the worst that still can be called one
LONG_LAG_S = 2.0  # over which drift shows against the measurements' noise
EXPECTED_DRIFT_RAD2_PER_S = np.deg2rad(1.0) ** 2  # while the recording's own drift is not known yet
START_RAD = np.deg2rad(4.0)  # a whole recording's mean vertical against that of one moment
GATE_SIGMAS = 3.0
ROBUST_ROUNDS = 6
OUTLIER_SIGMAS = 2.5
MEDIAN_OF_CHI2_2 = 1.386  # median of a chi-square variable of two degrees of freedom


@dataclass(frozen=True)
class VerticalFilter:
    """The vertical in the odometry's world so far: `up_world (3,)`, its variance per direction, the time in seconds."""

    up_world: Array
    variance_rad2: float
    time_s: float | None = None

    @classmethod
    def starting_at(cls, up_world: Array) -> "VerticalFilter":
        """Before the first frame, near the vertical of the recording as a whole."""
        return cls(up_world, START_RAD**2)

    def at(self, time_s: float) -> "VerticalFilter":
        """Later: the vertical may have wandered."""
        elapsed = 0.0 if self.time_s is None else time_s - self.time_s
        variance = min(self.variance_rad2 + EXPECTED_DRIFT_RAD2_PER_S * elapsed, START_RAD**2)
        return replace(self, variance_rad2=variance, time_s=time_s)

    def admits(self, up_world: Array, sigma_rad: float) -> bool:
        """True when a measured vertical is explained by drift and noise."""
        gate = GATE_SIGMAS * np.sqrt(self.variance_rad2 + sigma_rad**2)
        return bool(np.linalg.norm(up_world - self.up_world) < gate)

    def with_measured(self, up_world: Array, sigma_rad: float) -> "VerticalFilter":
        """After a measurement."""
        gain = self.variance_rad2 / (self.variance_rad2 + sigma_rad**2)
        mean = self.up_world + gain * (up_world - self.up_world)
        return replace(self, up_world=mean / np.linalg.norm(mean), variance_rad2=(1 - gain) * self.variance_rad2)


def smooth_up(time_s: Array, up_world: Array, sigma_rad: Array) -> Array:
    """Smoothed verticals (K, 3) of measured ones (K, 3) at increasing times (K,); outliers count little (Cauchy weights)."""
    if len(time_s) < 2:
        return np.asarray(up_world)
    drift = drift_rate_rad2_per_s(time_s, up_world)
    sigma_rad = np.maximum(sigma_rad, np.sqrt(_variance(up_world, 1) / 2))  # neighbours differ by the noise of two
    link = 1.0 / (drift * np.maximum(np.diff(time_s), 1e-6))
    weight = np.ones(len(time_s))
    smoothed = np.asarray(up_world)
    for _ in range(ROBUST_ROUNDS):
        smoothed = _solve(weight / sigma_rad**2, link, up_world)
        error = np.linalg.norm(smoothed - up_world, axis=1) / sigma_rad
        weight = 1.0 / (1.0 + (error / OUTLIER_SIGMAS) ** 2)
    return np.asarray(smoothed / np.linalg.norm(smoothed, axis=1, keepdims=True))


def drift_rate_rad2_per_s(time_s: Array, up_world: Array) -> float:
    """Variance per second and direction by which the vertical wanders in the odometry's world, from the measurements themselves.

    Differences over a short and a long lag have the same measurement noise; what the long ones have more is drift.
    """
    lag = max(1, round(LONG_LAG_S / max(float(np.median(np.diff(time_s))), 1e-6)))
    lag = min(lag, len(time_s) - 1)
    short, long = _variance(up_world, 1), _variance(up_world, lag)
    seconds = float(np.median(time_s[lag:] - time_s[:-lag]) - np.median(np.diff(time_s)))
    rate = (long - short) / seconds if seconds > 0 else 0.0
    return float(np.clip(rate, LEAST_DRIFT_RAD2_PER_S, MOST_DRIFT_RAD2_PER_S))


def _variance(up_world: Array, lag: int) -> float:
    """Robust variance per direction of differences over `lag` rows."""
    square = ((up_world[lag:] - up_world[:-lag]) ** 2).sum(axis=1)
    return float(np.median(square)) / MEDIAN_OF_CHI2_2


def _solve(weight: Array, link: Array, target: Array) -> Array:
    """Minimise sum weight |u_k - target_k|^2 + sum link |u_{k+1} - u_k|^2."""
    from scipy.linalg import solveh_banded

    banded = np.zeros((2, len(weight)))
    banded[1] = weight
    banded[1, :-1] += link
    banded[1, 1:] += link
    banded[0, 1:] = -link
    return np.asarray(solveh_banded(banded, weight[:, None] * target))
