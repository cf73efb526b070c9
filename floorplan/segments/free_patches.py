"""Upright surfaces that follow no axis: straight lines in plan, outside the Manhattan model."""

import math
from typing import NamedTuple

import numpy as np

from floorplan.compiled import compiled
from floorplan.grid.components import Components
from floorplan.grid.normals import SurfaceNormals
from floorplan.model.checks import Array
from floorplan.model.segment import FreePatches
from floorplan.segments.labels import OFF_AXIS

_MIN_LENGTH_M = 0.5
_MIN_HEIGHT_M = 0.5  # of cameras: less is furniture
_MIN_OFF_AXIS_RAD = math.radians(5.0)
_MAX_RMS_SIGMAS = 2.0  # a curved or stepped surface fits worse than its noise
_FLOOR_M = 0.01
_TRIM = 0.01
_NEAR_RAD = math.radians(12.0)  # a pixel of the line's surface may have a normal this far off, and its own noise
_BEYOND_M = 0.3  # the line's ends, where more of its surface may be
_NEAR_SIGMAS = 2.5
_ROUNDS = 3
COLUMNS = 9  # of a patch: normal yaw, start x y, end x y, height low high, sigma, points


def off_axis_patches(components: Components, points: Array, normals: SurfaceNormals, world_from_sensor: Array) -> Array:
    """One row of `COLUMNS` per straight one among the components labelled OFF_AXIS.

    A component holds those pixels of its surface whose normals happen to lean away from the axes: of a wall 11 degrees off them, the
    steeper ones. So the line is fitted anew to all pixels that lie on it and look its way, whatever their label.
    """
    flat = points.reshape(-1, 3)
    pixel = Pixels(flat, normals.normal.reshape(-1, 3), normals.sigma_rad.ravel(), normals.noise_m.ravel())
    rows = _lines(components.label, components.start, components.order, pixel, world_from_sensor)
    return np.asarray(rows[rows[:, 6] - rows[:, 5] >= _MIN_HEIGHT_M]) if len(points) > 1 else rows


def patches_of(rows: Array, frame: Array, pixels_per_point: Array) -> FreePatches:
    """The patches of `rows (Q, COLUMNS)`, seen in keyframes `frame (Q,)` whose points stand for `pixels_per_point (Q,)` pixels."""
    count = np.round(rows[:, 8] * pixels_per_point)
    return FreePatches(frame, rows[:, 0], rows[:, 1:3], rows[:, 3:5], rows[:, 5:7], rows[:, 7], count)


class Pixels(NamedTuple):
    """A frame's pixels (N): `point (N, 3)` and `normal (N, 3)` in sensor axes, `sigma_rad` of the normal, `noise_m` along the ray."""

    point: Array
    normal: Array
    sigma_rad: Array
    noise_m: Array


@compiled
def _lines(label: Array, start: Array, order: Array, pixel: Pixels, r: Array) -> Array:
    """One row of `COLUMNS` per component that is a straight line in plan."""
    rows = np.empty((np.count_nonzero(label == OFF_AXIS), COLUMNS))
    count = 0
    for c in range(len(label)):
        if label[c] != OFF_AXIS:
            continue
        pixels = order[start[c] : start[c + 1]]
        found = _line(pixel, pixels, r, rows[count])
        for _ in range(_ROUNDS):
            if found:
                pixels = _on_line(pixel, r, rows[count])
                found = len(pixels) > 0 and _line(pixel, pixels, r, rows[count])
        if found:
            count += 1
    return rows[:count]


@compiled
def _on_line(pixel: Pixels, r: Array, row: Array) -> Array:
    """The pixels that lie on the line of `row` and whose surface looks as it does."""
    n_x, n_y = math.cos(row[0]), math.sin(row[0])
    length = math.hypot(row[3] - row[1], row[4] - row[2])
    t_x, t_y = (row[3] - row[1]) / length, (row[4] - row[2]) / length
    found = np.empty(len(pixel.point), np.int64)
    count = 0
    for k in range(len(pixel.point)):
        x, y, z = pixel.point[k, 0], pixel.point[k, 1], pixel.point[k, 2]
        dx = r[0, 0] * x + r[0, 1] * y + r[0, 2] * z - row[1]
        dy = r[1, 0] * x + r[1, 1] * y + r[1, 2] * z - row[2]
        height = r[2, 0] * x + r[2, 1] * y + r[2, 2] * z
        along = dx * t_x + dy * t_y
        if not abs(dx * n_x + dy * n_y) < _NEAR_SIGMAS * math.hypot(pixel.noise_m[k], 0.5 * _FLOOR_M):
            continue  # also where there is no point
        if along < -_BEYOND_M or along > length + _BEYOND_M or height < row[5] or height > row[6]:
            continue
        n = pixel.normal[k]
        across = n_x * (r[0, 0] * n[0] + r[0, 1] * n[1] + r[0, 2] * n[2]) + n_y * (r[1, 0] * n[0] + r[1, 1] * n[1] + r[1, 2] * n[2])
        if across > math.cos(_NEAR_RAD + pixel.sigma_rad[k]):
            found[count] = k
            count += 1
    return found[:count]


@compiled
def _line(pixel: Pixels, pixels: Array, r: Array, row: Array) -> bool:
    """The line through the pixels into `row`; False where it is none, is short, or follows an axis."""
    count = len(pixels)
    world = np.empty((3, count))
    for k in range(count):
        x, y, z = pixel.point[pixels[k], 0], pixel.point[pixels[k], 1], pixel.point[pixels[k], 2]
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
    if off_axis < _MIN_OFF_AXIS_RAD or rms > _MAX_RMS_SIGMAS * np.median(pixel.noise_m[pixels]) + _FLOOR_M:
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
