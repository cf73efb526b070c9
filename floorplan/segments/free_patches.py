"""Upright surfaces that follow no axis: straight lines in plan, outside the Manhattan model."""

import math
from dataclasses import dataclass

import numpy as np

from floorplan.geometry import wrap_to
from floorplan.grid.components import Components
from floorplan.model.checks import Array
from floorplan.model.segment import FreePatches
from floorplan.segments.labels import OFF_AXIS

_MIN_LENGTH_M = 0.5
_MIN_HEIGHT_M = 0.5  # of cameras: less is furniture
_MIN_OFF_AXIS_RAD = math.radians(5.0)
_MAX_RMS_SIGMAS = 2.0  # a curved or stepped surface fits worse than its noise
_FLOOR_M = 0.01
_TRIM_PERCENT = 1.0


def off_axis_patches(
    components: Components, points: Array, noise_m: Array, world_from_sensor: Array, frame: int, pixels_per_point: float
) -> FreePatches:
    """The straight ones among the components labelled OFF_AXIS."""
    rows: list[_Line] = []
    for c in np.flatnonzero(components.label == OFF_AXIS):
        pixels = components.order[components.start[c] : components.start[c + 1]]
        world = points.reshape(-1, 3)[pixels].astype(np.float64) @ world_from_sensor.T
        row = _line(world, float(np.median(noise_m.ravel()[pixels])), points.shape[0] == 1)
        if row is not None:
            rows.append(row)
    return FreePatches(
        np.full(len(rows), frame),
        np.array([row.normal_yaw_rad for row in rows]),
        np.array([row.start_m for row in rows]).reshape(-1, 2),
        np.array([row.end_m for row in rows]).reshape(-1, 2),
        np.array([row.height_m for row in rows]).reshape(-1, 2),
        np.array([row.sigma_m for row in rows]),
        np.array([round(row.points * pixels_per_point) for row in rows]),
    )


@dataclass(frozen=True)
class _Line:
    """One straight upright patch: a row of `FreePatches`."""

    normal_yaw_rad: float
    start_m: Array
    end_m: Array
    height_m: Array
    sigma_m: float
    points: int


def _line(world: Array, noise_m: float, sweep: bool) -> _Line | None:
    """The line through `world (n, 3)`; None where it is none, or follows an axis."""
    centre = world.mean(axis=0)
    flat = world[:, :2] - centre[:2]
    variance, direction = np.linalg.eigh(flat.T @ flat / len(flat))
    normal, tangent = direction[:, 0], direction[:, 1]
    normal = -normal if normal @ centre[:2] > 0 else normal
    yaw = math.atan2(normal[1], normal[0])
    off_axis = abs(float(wrap_to(np.asarray(yaw), math.pi / 2)))
    along = np.percentile(flat @ tangent, (_TRIM_PERCENT, 100 - _TRIM_PERCENT))
    height = np.percentile(world[:, 2], (_TRIM_PERCENT, 100 - _TRIM_PERCENT))
    rms = math.sqrt(max(float(variance[0]), 0.0))
    if off_axis < _MIN_OFF_AXIS_RAD or rms > _MAX_RMS_SIGMAS * noise_m + _FLOOR_M:
        return None
    if along[1] - along[0] < _MIN_LENGTH_M or (not sweep and height[1] - height[0] < _MIN_HEIGHT_M):
        return None
    start, end = centre[:2] + along[0] * tangent, centre[:2] + along[1] * tangent
    return _Line(yaw, start, end, height, math.hypot(rms / math.sqrt(len(world)), _FLOOR_M / 2), len(world))
