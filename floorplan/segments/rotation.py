"""The rotation of a frame from its own segments: flat pieces of wall, floor and ceiling must come out flat.

Turning the frame by a small `delta` moves the coordinate of a point `q` along the unit axis `a` by `delta . (q x a)`. The
coordinates of one segment should not vary, so its scatter `C` (in the world) gives the normal equations
`K C K^T delta = -K C a` with `K q = q x a`; summed over the segments of a frame they are one 3 x 3 system.
"""

import math
from dataclasses import dataclass

import numpy as np

from floorplan.model.checks import Array
from floorplan.model.segment import Segments
from floorplan.segments.ripple import Ripple

_FLATNESS_M = (
    0.00005  # what a wall shares all over though its blocks do not show it: whole millimetres, blurred by noise of 0.3 mm and more
)
_TILT_PRIOR_RAD = math.radians(0.5)  # of gravity's direction
_YAW_PRIOR_RAD = math.radians(2.0)  # of the yaw the frame was labelled under
_CAUCHY = 3.0  # standard deviations at which a segment's own inclination halves its weight
_ROUNDS = 6
_LEAST_INFORMATION = 4.0  # of the prior's: below, a frame's segments say nothing about its yaw


@dataclass(frozen=True)
class RotationCorrections:
    """Small rotations `delta_rad (F, 3)` in the world about x, y, z; `sigma_rad (F, 3)`, infinite where nothing was seen.

    `shared_rad (F, 3)` is the part of the sigma that neighbouring frames share, because the sensor's ripple does not average out;
    `white` how large the rest is, as a part of the sigma.
    """

    delta_rad: Array
    sigma_rad: Array
    shared_rad: Array
    white: float


def corrections(segments: Segments, world_from_sensor: Array, ripple: Ripple) -> RotationCorrections:
    """What the segments say about the rotations `world_from_sensor (F, 3, 3)` they were labelled under; bent ones say less."""
    count = len(world_from_sensor)
    r = world_from_sensor[segments.frame]
    scatter = r @ segments.scatter_sensor_m2 @ np.swapaxes(r, 1, 2)
    axis = np.eye(3)[segments.axis.astype(np.int64)]
    k = -_skew(axis)
    matrix = k @ scatter @ np.swapaxes(k, 1, 2)
    vector = np.einsum("sij,sjk,sk->si", k, scatter, axis)
    weight = 1 / (segments.sigma_m**2 + _FLATNESS_M**2 + ripple.sensor_m**2 + ripple.own_m**2)
    prior = np.diag((_TILT_PRIOR_RAD**-2, _TILT_PRIOR_RAD**-2, _YAW_PRIOR_RAD**-2))
    robust = np.ones(len(segments))
    for _ in range(_ROUNDS):
        information, right = np.zeros((count, 3, 3)), np.zeros((count, 3))
        np.add.at(information, segments.frame, (weight * robust)[:, None, None] * matrix)
        np.add.at(right, segments.frame, (weight * robust)[:, None] * vector)
        delta = -np.linalg.solve(information + prior, right[..., None])[..., 0]
        robust = 1 / (1 + _misfit(matrix, vector, weight, delta[segments.frame]) / _CAUCHY**2)
    variance = np.diagonal(np.linalg.inv(information + prior), axis1=1, axis2=2)
    seen = np.diagonal(information, axis1=1, axis2=2) > _LEAST_INFORMATION * np.diagonal(prior)
    white = segments.sigma_m**2 + _FLATNESS_M**2 + ripple.own_m**2
    share = ripple.sensor_m**2 / (ripple.sensor_m**2 + (float(np.median(white)) if len(white) else 1.0))
    return RotationCorrections(delta, np.where(seen, np.sqrt(variance), np.inf), np.sqrt(share * variance), math.sqrt(1 - share))


def _misfit(matrix: Array, vector: Array, weight: Array, delta: Array) -> Array:
    """Square of each segment's remaining inclination (S,), in its own standard deviations."""
    gradient = weight[:, None] * (vector + np.einsum("sij,sj->si", matrix, delta))
    curvature = weight[:, None, None] * matrix + np.eye(3) * 1e-6
    return np.asarray(np.einsum("si,si->s", gradient, np.linalg.solve(curvature, gradient[..., None])[..., 0]))


def small_rotation(delta_rad: Array) -> Array:
    """Rotation matrices (..., 3, 3) of small rotation vectors (..., 3), exactly orthonormal (Rodrigues)."""
    angle = np.linalg.norm(delta_rad, axis=-1)[..., None, None]
    skew = _skew(delta_rad)
    safe = np.where(angle > 1e-12, angle, 1.0)
    return np.asarray(np.eye(3) + np.sinc(angle / np.pi) * skew + (1 - np.cos(safe)) / safe**2 * (skew @ skew))


def _skew(vector: Array) -> Array:
    """Matrices (..., 3, 3) with `skew(v) q = v x q`."""
    x, y, z = np.moveaxis(np.asarray(vector, dtype=np.float64), -1, 0)
    zero = np.zeros_like(x)
    return np.stack((np.stack((zero, -z, y), -1), np.stack((z, zero, -x), -1), np.stack((-y, x, zero), -1)), -2)
