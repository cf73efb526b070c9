"""The published labelling: a pixel belongs to the axis for which most of its k x k neighbourhood lies on the plane through it."""

import math

import numpy as np

from floorplan.compiled import compiled
from floorplan.model.checks import Array
from floorplan.segments.labels import UNLABELLED, Labels

_MAX_HALF_PX = 7  # neighbourhoods close to the sensor would otherwise hold a thousand pixels
_MIN_HALF_PX = 1
_SAMPLES = 7  # look-ups per side of the neighbourhood, evenly spread
_LEAST_SUPPORT = 0.6  # share of the neighbourhood that must lie on the plane
_SIGMAS = 2.0  # neighbour and pixel both carry noise
_FLOOR_M = 0.005
_GATE_M, _GATE_SIGMAS = 0.015, 3.0  # step between neighbouring raw pixels of one surface


def label_by_vote(points: Array, weight: Array, noise_m: Array, world_from_sensor: Array, ray_step: float, window_m: float) -> Labels:
    """The axis the neighbourhood `window_m` across votes for."""
    label, coordinate = _vote(points, weight, noise_m, world_from_sensor, ray_step, window_m)
    return Labels(label, coordinate, _GATE_M + _GATE_SIGMAS * noise_m)


@compiled
def _vote(points: Array, weight: Array, noise_m: Array, rotation: Array, ray_step: float, window_m: float) -> tuple[Array, Array]:
    height, width, _ = points.shape
    labels = np.full((height, width), UNLABELLED, np.int8)
    world = np.empty((height, width, 3), np.float32)
    coordinate = np.empty((height, width, 2), np.float32)
    for i in range(height):
        for j in range(width):
            for a in range(3):
                world[i, j, a] = (
                    rotation[a, 0] * points[i, j, 0] + rotation[a, 1] * points[i, j, 1] + rotation[a, 2] * points[i, j, 2]
                )
    votes = np.zeros(3)
    for i in range(height):
        for j in range(width):
            if weight[i, j] <= 0:
                continue
            x, y, z = world[i, j, 0], world[i, j, 1], world[i, j, 2]
            rho = math.sqrt(x * x + y * y + z * z)
            half = min(max(int(0.5 * window_m / (rho * ray_step) + 0.5), _MIN_HALF_PX), _MAX_HALF_PX)
            skip = max(1, (2 * half) // (_SAMPLES - 1))
            gate = _SIGMAS * noise_m[i, j] + _FLOOR_M
            votes[:] = 0.0
            looked = 0
            for u in range(i - half, i + half + 1, skip):
                if u < 0 or u >= height:
                    continue
                for v in range(j - half, j + half + 1, skip):
                    if v < 0 or v >= width:
                        continue
                    looked += 1
                    if weight[u, v] > 0:
                        if abs(world[u, v, 0] - x) < gate * max(abs(x) / rho, 0.2):
                            votes[0] += 1
                        if abs(world[u, v, 1] - y) < gate * max(abs(y) / rho, 0.2):
                            votes[1] += 1
                        if abs(world[u, v, 2] - z) < gate * max(abs(z) / rho, 0.2):
                            votes[2] += 1
            best = np.argmax(votes)
            if votes[best] >= _LEAST_SUPPORT * looked:
                labels[i, j] = best * 2 + (1 if world[i, j, best] < 0 else 0)
                coordinate[i, j, 0] = world[i, j, best]
    return labels, coordinate
