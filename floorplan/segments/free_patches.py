"""Upright surfaces that follow no axis: straight lines in plan, outside the Manhattan model."""

import math

import numpy as np

from floorplan.compiled import compiled
from floorplan.grid.components import Components
from floorplan.model.checks import Array
from floorplan.model.segment import FreePatches
from floorplan.segments.labels import OFF_AXIS

_MIN_LENGTH_M = 0.5
_MIN_HEIGHT_M = 0.5  # of cameras: less is furniture
_MIN_OFF_AXIS_RAD = math.radians(5.0)
_MAX_RMS_SIGMAS = 2.0  # a curved or stepped surface fits worse than its noise
_FLOOR_M = 0.01
_TRIM = 0.01
COLUMNS = 9  # of a patch: normal yaw, start x y, end x y, height low high, sigma, points


def off_axis_patches(components: Components, points: Array, noise_m: Array, world_from_sensor: Array) -> Array:
    """One row of `COLUMNS` per straight one among the components labelled OFF_AXIS."""
    rows = _lines(components.label, components.start, components.order, points.reshape(-1, 3), noise_m.ravel(), world_from_sensor)
    return np.asarray(rows[rows[:, 6] - rows[:, 5] >= _MIN_HEIGHT_M]) if len(points) > 1 else rows


def patches_of(rows: Array, frame: Array, pixels_per_point: Array) -> FreePatches:
    """The patches of `rows (Q, COLUMNS)`, seen in keyframes `frame (Q,)` whose points stand for `pixels_per_point (Q,)` pixels."""
    count = np.round(rows[:, 8] * pixels_per_point)
    return FreePatches(frame, rows[:, 0], rows[:, 1:3], rows[:, 3:5], rows[:, 5:7], rows[:, 7], count)


@compiled
def _lines(label: Array, start: Array, order: Array, points: Array, noise_m: Array, r: Array) -> Array:
    """One row of `COLUMNS` per component that is a straight line in plan."""
    rows = np.empty((np.count_nonzero(label == OFF_AXIS), COLUMNS))
    count = 0
    for c in range(len(label)):
        if label[c] == OFF_AXIS and _line(points, order[start[c] : start[c + 1]], noise_m, r, rows[count]):
            count += 1
    return rows[:count]


@compiled
def _line(points: Array, pixels: Array, noise_m: Array, r: Array, row: Array) -> bool:
    """The line through the pixels into `row`; False where it is none, is short, or follows an axis."""
    count = len(pixels)
    world = np.empty((3, count))
    for k in range(count):
        x, y, z = points[pixels[k], 0], points[pixels[k], 1], points[pixels[k], 2]
        for a in range(3):
            world[a, k] = r[a, 0] * x + r[a, 1] * y + r[a, 2] * z
    centre_x, centre_y = world[0].mean(), world[1].mean()
    xx, xy, yy = 0.0, 0.0, 0.0
    for k in range(count):
        dx, dy = world[0, k] - centre_x, world[1, k] - centre_y
        xx += dx * dx
        xy += dx * dy
        yy += dy * dy
    along = 0.5 * math.atan2(2 * xy, xx - yy)  # the direction of the greatest scatter
    t_x, t_y = math.cos(along), math.sin(along)
    n_x, n_y = -t_y, t_x
    if n_x * centre_x + n_y * centre_y > 0:
        n_x, n_y = t_y, -t_x
    yaw = math.atan2(n_y, n_x)
    off_axis = abs(yaw - 0.5 * math.pi * math.floor(yaw / (0.5 * math.pi) + 0.5))
    rms = math.sqrt(max(0.5 * (xx + yy) - math.hypot(0.5 * (xx - yy), xy), 0.0) / count)
    if off_axis < _MIN_OFF_AXIS_RAD or rms > _MAX_RMS_SIGMAS * np.median(noise_m[pixels]) + _FLOOR_M:
        return False
    low, high = _trimmed_ends((world[0] - centre_x) * t_x + (world[1] - centre_y) * t_y)
    if high - low < _MIN_LENGTH_M:
        return False
    row[0] = yaw
    row[1], row[2] = centre_x + low * t_x, centre_y + low * t_y
    row[3], row[4] = centre_x + high * t_x, centre_y + high * t_y
    row[5], row[6] = _trimmed_ends(world[2])
    row[7], row[8] = math.hypot(rms / math.sqrt(count), _FLOOR_M / 2), count
    return True


@compiled
def _trimmed_ends(values: Array) -> tuple[float, float]:
    """The quantiles `_TRIM` and 1 - `_TRIM`, interpolated."""
    ordered = np.sort(values)
    position = _TRIM * (len(ordered) - 1)
    k = int(position)
    after = min(k + 1, len(ordered) - 1)
    part = position - k
    low = ordered[k] + part * (ordered[after] - ordered[k])
    high = ordered[len(ordered) - 1 - k] - part * (ordered[len(ordered) - 1 - k] - ordered[len(ordered) - 1 - after])
    return float(low), float(high)
