"""Odometry as a phone's visual-inertial tracking drifts: scale and sideways rate correlated over about 20 m, yaw, noise."""

from dataclasses import dataclass

import numpy as np

from floorplan.geometry import rotation_about_z
from floorplan.model.checks import Array, freeze
from floorplan.simulate.walk import Walk, rotation_from_yaw_pitch_roll

CORRELATION_M = 20.0
STEP_NOISE_M = 0.0008  # white, per frame and axis
YAW_WALK_RAD = np.radians(0.08)  # per sqrt(m)
TILT_WANDER_RAD = np.radians(0.1)
TILT_CORRELATION_S = 5.0
SIDEWAYS_SHARE = 0.6  # of the scale error's size
UP_SHARE = 0.15
UNIT_ERROR = 0.01
DRAWS = 60
ORDINARY_SIZE = 2.0  # two percent: what a phone's tracking does
LARGEST_SIZE = 6.0


@dataclass(frozen=True)
class Odometry:
    """Estimated poses in the odometry's own gravity-aligned world, z up: `position_m (N, 3)`, `odom_from_camera (N, 3, 3)`."""

    position_m: Array
    odom_from_camera: Array

    def __post_init__(self) -> None:
        freeze(self, {"position_m": (np.float64, ("N", 3)), "odom_from_camera": (np.float64, ("N", 3, 3))})


@dataclass(frozen=True)
class ErrorRates:
    """One draw of the errors along a walk, N frames: `along`, `sideways`, `up` (N,) metres per metre, `yaw_rad (N,)`, `noise_m (N, 3)`."""

    along: Array
    sideways: Array
    up: Array
    yaw_rad: Array
    noise_m: Array


def drifting_odometry(
    walk: Walk, rng: np.random.Generator, *, error: float | None, drift_m: float | None, tilt_rad: float = TILT_WANDER_RAD
) -> Odometry:
    """Odometry of a walk.

    `error`: standard deviation of the scale error (0.02 is 2 %), sideways in proportion, or None to size
    the errors so that start and end lie `drift_m` apart. An error of 0 gives the true motion.
    """
    if error is None:
        rates = _rates_for_drift(walk, drift_m or 0.0, rng)
        size = _size_for_drift(walk, rates, drift_m or 0.0)
    else:
        rates, size = _draw_rates(walk, rng), error / UNIT_ERROR
    tilt = _tilt(walk, rng) * tilt_rad * (0.0 if error == 0 else 1.0)
    start_yaw = float(rng.uniform(-np.pi, np.pi))
    yaw, zero = start_yaw + size * rates.yaw_rad, np.zeros(len(walk))
    # Wrong gravity: the world is tilted a little under the sensor, differently at every moment.
    wrong_up = rotation_from_yaw_pitch_roll(zero, tilt[:, 0], tilt[:, 1])
    rotation = rotation_about_z(yaw) @ wrong_up @ walk.world_from_camera
    position = _positions(walk, rates, size) @ rotation_about_z(np.array(start_yaw)).T
    return Odometry(position, rotation)


def _draw_rates(walk: Walk, rng: np.random.Generator) -> ErrorRates:
    """Errors of unit size: a scale error of one percent."""
    travelled = np.diff(walk.path_m, prepend=0.0)
    scale, sideways, up = (_correlated(travelled, CORRELATION_M, rng) for _ in range(3))
    yaw = np.cumsum(YAW_WALK_RAD * np.sqrt(travelled) * rng.standard_normal(len(walk)))
    noise = STEP_NOISE_M * rng.standard_normal((len(walk), 3))
    return ErrorRates(UNIT_ERROR * scale, UNIT_ERROR * SIDEWAYS_SHARE * sideways, UNIT_ERROR * UP_SHARE * up, np.asarray(yaw), noise)


def _correlated(travelled_m: Array, length_m: float, rng: np.random.Generator) -> Array:
    """An Ornstein-Uhlenbeck process over path length, unit standard deviation (N,)."""
    keep = np.exp(-travelled_m / length_m)
    kicks = rng.standard_normal(len(travelled_m)) * np.sqrt(1 - keep**2)
    values = np.empty(len(travelled_m))
    value = float(rng.standard_normal())
    for index in range(len(values)):
        value = keep[index] * value + kicks[index]
        values[index] = value
    return values


def _positions(walk: Walk, rates: ErrorRates, size: float) -> Array:
    """Positions (N, 3) from the first frame on, in a world that still has the true first yaw."""
    step = np.diff(walk.position_m, axis=0, prepend=walk.position_m[:1])
    length = np.linalg.norm(step[:, :2], axis=1)
    left = np.column_stack((-step[:, 1], step[:, 0], np.zeros(len(step))))
    wrong = step + size * (rates.along[:, None] * step + rates.sideways[:, None] * left)
    wrong[:, 2] += size * rates.up * length
    turned = np.einsum("nij,nj->ni", rotation_about_z(size * rates.yaw_rad), wrong)
    noise = (size > 0) * rates.noise_m
    noise[0] = 0.0
    return np.asarray(np.cumsum(turned + noise, axis=0))


def _rates_for_drift(walk: Walk, drift_m: float, rng: np.random.Generator) -> ErrorRates:
    """A draw whose drift is `drift_m` at an ordinary size: on a closed path most draws cancel out and would need wild ones."""
    best = _draw_rates(walk, rng)
    best_size = drift_m / _drift(walk, best, 1.0)  # to first order
    for _ in range(DRAWS):
        if best_size < ORDINARY_SIZE:
            break
        rates = _draw_rates(walk, rng)
        size = drift_m / _drift(walk, rates, 1.0)
        if size < best_size:
            best, best_size = rates, size
    return best


def _drift(walk: Walk, rates: ErrorRates, size: float) -> float:
    """Distance of the last position from where it truly is, seen from the first."""
    end = _positions(walk, rates, size)[-1] - (walk.position_m[-1] - walk.position_m[0])
    return float(np.linalg.norm(end))


def _size_for_drift(walk: Walk, rates: ErrorRates, drift_m: float) -> float:
    """The size of errors at which the raw drift is `drift_m` (bisection)."""
    low, high = 0.0, LARGEST_SIZE
    for _ in range(40):
        middle = (low + high) / 2
        low, high = (middle, high) if _drift(walk, rates, middle) < drift_m else (low, middle)
    return (low + high) / 2


def _tilt(walk: Walk, rng: np.random.Generator) -> Array:
    """Pitch and roll errors (N, 2) of unit standard deviation, wandering over TILT_CORRELATION_S."""
    seconds = np.diff(walk.stamp_ns, prepend=walk.stamp_ns[0]) * 1e-9
    return np.column_stack([_correlated(seconds, TILT_CORRELATION_S, rng) for _ in range(2)])
