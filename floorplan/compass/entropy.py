"""The published compass: the yaw at which the points' projections on x and y are least entropic, frame after frame.

The first frames are searched over a quarter turn in one degree steps, the others in a narrow window about the previous
yaw turned on by the odometry; where nothing axis-aligned is seen the odometry's yaw is held. Points are
split linearly between bins of at most 2 cm: counted whole, an exactly aligned wall would fall on a bin's edge or not.
"""

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from floorplan.compass.prior import CompassPrior
from floorplan.compiled import compiled
from floorplan.grid.normals import NoiseScale, pixel_weights
from floorplan.model.checks import Array
from floorplan.model.scan import IngestedScan, SensorKind
from floorplan.readers.base import BadFrame, Source

BIN_M = 0.02
GLOBAL_STEP_RAD, WINDOW_STEP_RAD, WINDOW_RAD = math.radians(1.0), math.radians(0.05), math.radians(0.3)
_GRID_PX = 88  # columns kept of a camera's image
_MAX_RANGE_M = 12.0  # farther points spread over many bins and tell little
_LEAST_POINTS = 60
_LEAST_CONTRAST = 0.05  # nats between the best yaw and the quarter turn's mean: less and nothing axis-aligned is seen
_HELD_SIGMA_RAD = math.radians(0.5)
_FOUND_SIGMA_RAD = math.radians(0.05)


@dataclass(frozen=True)
class _Fused:
    """The yaw of one frame relative to its level frame, and whether walls were seen."""

    yaw_rad: float
    measured: bool


def entropy_survey(
    scan: IngestedScan, source: Source, level_from_sensor: Array, turn_rad: Array, step_m: Array, progress: Callable[[int, int], None]
) -> CompassPrior:
    """The fused yaw of every keyframe, to be used as it is."""
    sensor = scan.recording.sensor
    stride = max(1, sensor.width // _GRID_PX) if sensor.kind is SensorKind.CAMERA else 1
    fused: list[_Fused] = []
    for k, frame in enumerate(source.frames(scan.keyframe, stride)):
        before = fused[-1].yaw_rad if fused else 0.0
        if isinstance(frame, BadFrame):
            fused.append(_Fused(before, False))
        else:
            seen = pixel_weights(frame.points, frame.confidence) > 0
            level = frame.points[seen].astype(np.float64) @ level_from_sensor[k].T
            fused.append(_fuse(level[np.linalg.norm(level[:, :2], axis=1) < _MAX_RANGE_M], before, not any(f.measured for f in fused)))
        progress(k + 1, len(scan.keyframe))
    measured = np.array([f.measured for f in fused], dtype=bool)
    sigma = np.where(measured, _FOUND_SIGMA_RAD, _HELD_SIGMA_RAD)
    yaw = np.array([f.yaw_rad for f in fused])
    return CompassPrior(level_from_sensor, yaw, sigma, measured, turn_rad, step_m, NoiseScale(), final=True)


def _fuse(level: Array, predicted_rad: float, first: bool) -> _Fused:
    """Search about `predicted_rad` (level frames keep odometry's heading, so the prediction is the previous yaw itself)."""
    if len(level) < _LEAST_POINTS:
        return _Fused(predicted_rad, False)
    quarter = np.arange(0.0, math.pi / 2, GLOBAL_STEP_RAD)
    everywhere = projection_entropy(level, quarter) if first else projection_entropy(level, predicted_rad + quarter[::9])
    if first:
        predicted_rad = float(quarter[everywhere.argmin()])
    window = predicted_rad + np.arange(-WINDOW_RAD, WINDOW_RAD + WINDOW_STEP_RAD / 2, WINDOW_STEP_RAD) * (4 if first else 1)
    entropy = projection_entropy(level, window)
    if everywhere.mean() - entropy.min() < _LEAST_CONTRAST:
        return _Fused(predicted_rad, False)
    return _Fused(_minimum(window, entropy), True)


def _minimum(yaw_rad: Array, entropy: Array) -> float:
    """The least entropic yaw, between the steps by a parabola."""
    k = int(entropy.argmin())
    if k in (0, len(yaw_rad) - 1):
        return float(yaw_rad[k])
    before, at, after = entropy[k - 1 : k + 2]
    bend = before - 2 * at + after
    return float(yaw_rad[k] + (0.5 * (before - after) / bend if bend > 0 else 0.0) * (yaw_rad[1] - yaw_rad[0]))


def projection_entropy(level: Array, yaw_rad: Array) -> Array:
    """Entropy in nats (Y,) of the x and y marginals together, of points `level (n, 3)` turned by each of `yaw_rad (Y,)`."""
    return _entropies(np.ascontiguousarray(level[:, :2]), yaw_rad)


@compiled
def _entropies(points: Array, yaw_rad: Array) -> Array:
    count = len(points)
    reach = 0.0
    for k in range(count):
        reach = max(reach, math.hypot(points[k, 0], points[k, 1]))
    bins = int(2 * reach / BIN_M) + 3
    result = np.zeros(len(yaw_rad))
    for y in range(len(yaw_rad)):
        c, s = math.cos(yaw_rad[y]), math.sin(yaw_rad[y])
        histogram = np.zeros((2, bins))
        for k in range(count):
            for a in range(2):
                turned = c * points[k, 0] - s * points[k, 1] if a == 0 else s * points[k, 0] + c * points[k, 1]
                position = (turned + reach) / BIN_M
                low = int(position)
                histogram[a, low] += 1 - (position - low)
                histogram[a, low + 1] += position - low
        for a in range(2):
            for b in range(bins):
                if histogram[a, b] > 0:
                    share = histogram[a, b] / count
                    result[y] -= share * math.log(share)
    return result
