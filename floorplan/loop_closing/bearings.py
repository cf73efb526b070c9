"""Which way the nodes look, told by walls at right angles: matching turns a little with every step, walls do not.

Where no wall stands square to those followed so far, nothing is told: a wing at another angle is passed over.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from floorplan.geometry import wrap_to
from floorplan.model.checks import Array, freeze
from floorplan.sweep_matching.surfaces import SweepSurfaces

_QUARTER_RAD = math.pi / 2
_BINS = 90  # of one degree
_BEGINNING = 20  # nodes whose walls say what square is
_WIDE_RAD, _CLOSE_RAD = math.radians(5.0), math.radians(2.0)  # the window about the walls followed, first and last
_LEAST_SHARE = 0.4  # of a node's surfaces stand square
_LEAST_POINTS = 30
_GATE_RAD, _GATE_PER_M = math.radians(2.0), math.radians(0.02)  # matched yaw since the last node that told; a wing at 10 degrees stays out
_GAIN = 0.3  # of a reading, taken into the drift followed
_SIGMA_RAD = math.radians(0.5)  # of one node: radiators and skirtings


@dataclass(frozen=True)
class Bearings:
    """`node (B,)` whose yaw is `yaw_rad (B,)` in a frame square to the walls, known to `sigma_rad`."""

    node: Array
    yaw_rad: Array
    sigma_rad: float = _SIGMA_RAD

    def __post_init__(self) -> None:
        freeze(self, {"node": (np.int64, ("B",)), "yaw_rad": (np.float64, ("B",))})


def follow_walls(yaw_rad: Array, path_m: Array, surfaces: Sequence[SweepSurfaces]) -> Bearings:
    """Bearings of the nodes with matched `yaw_rad (M,)`, followed along the path so that no quarter turn is lost."""
    azimuth = [azimuths(seen) for seen in surfaces]
    beginning = zip(azimuth[:_BEGINNING], yaw_rad[:_BEGINNING], strict=True)
    square = square_to_walls(np.concatenate([a + y for a, y in beginning])).direction_rad
    node, told, drift, last_m = [], [], 0.0, 0.0
    for k, found in enumerate(azimuth):
        off, share = _offset(wrap_to(found + yaw_rad[k] - drift - square, _QUARTER_RAD))
        if len(found) < _LEAST_POINTS or share < _LEAST_SHARE or abs(off) > _GATE_RAD + _GATE_PER_M * (path_m[k] - last_m):
            continue
        node.append(k)
        told.append(yaw_rad[k] - drift - off)
        drift, last_m = drift + _GAIN * off, path_m[k]
    return Bearings(np.array(node, dtype=np.int64), np.array(told))


def azimuths(seen: SweepSurfaces) -> Array:
    """Directions (n,) of the normals of a sweep's flat surfaces, in the sensor's axes."""
    normal = seen.row[:, 2:]
    flat = np.hypot(normal[:, 0], normal[:, 1]) > 0
    return np.asarray(np.arctan2(normal[flat, 1], normal[flat, 0]))


@dataclass(frozen=True)
class SquareWalls:
    """The direction modulo 90 degrees that most surfaces face, and the share of them that do."""

    direction_rad: float
    share: float


def square_to_walls(azimuth_rad: Array) -> SquareWalls:
    """What is square among surfaces that face `azimuth_rad (n,)`."""
    if not len(azimuth_rad):
        return SquareWalls(0.0, 0.0)
    count = np.bincount((np.mod(azimuth_rad, _QUARTER_RAD) / _QUARTER_RAD * _BINS).astype(np.int64) % _BINS, minlength=_BINS)
    smooth = count + np.roll(count, 1) + np.roll(count, -1)
    middle = (int(smooth.argmax()) + 0.5) * _QUARTER_RAD / _BINS
    off, share = _offset(wrap_to(azimuth_rad - middle, _QUARTER_RAD))
    return SquareWalls(middle + off, share)


def _offset(off_rad: Array) -> tuple[float, float]:
    """Mean of the angles within a window that closes on them, and the share of all that lies inside."""
    mean, window = 0.0, _WIDE_RAD
    inside = np.zeros(len(off_rad), dtype=bool)
    while True:
        inside = np.abs(off_rad - mean) < window
        if not inside.any() or window <= _CLOSE_RAD:
            return mean, float(inside.mean()) if len(off_rad) else 0.0
        mean = float(off_rad[inside].mean())
        window = max(0.6 * window, _CLOSE_RAD)
