"""Which segments of neighbouring keyframes show one surface: the mutually nearest, for learning the size of errors, not for the layout."""

import numpy as np

from floorplan.model.checks import Array
from floorplan.model.segment import Segments

_LINK_M = 0.05  # between neighbouring keyframes, odometry's step taken out
_TOUCH_M = 0.30  # along the surface


def surface_of_segment(segments: Segments, step_m: Array) -> Array:
    """A number (S,) per segment that follows its surface from keyframe to keyframe; `step_m (F - 1, 3)` odometry in the world."""
    surface = np.arange(len(segments))
    start = np.searchsorted(segments.frame, np.arange(len(step_m) + 2))
    for k in range(len(step_m)):
        before, now = slice(start[k], start[k + 1]), slice(start[k + 1], start[k + 2])
        if before.start == before.stop or now.start == now.stop:
            continue
        gap = _gaps_m(segments, before, now, step_m[k])
        nearest, back = gap.argmin(axis=0), gap.argmin(axis=1)
        mutual = np.flatnonzero((back[nearest] == np.arange(len(nearest))) & (gap.min(axis=0) < _LINK_M))
        surface[now.start + mutual] = surface[before.start + nearest[mutual]]
    return surface


def _gaps_m(segments: Segments, before: slice, now: slice, step_m: Array) -> Array:
    """How far apart the planes of two keyframes' segments are (B, N); infinite where they cannot be one surface."""
    axis = segments.axis[now].astype(np.int64)
    gap = np.abs(segments.distance_m[before][:, None] - (segments.distance_m[now] + step_m[axis]))
    same = (segments.axis[before][:, None] == axis) & (segments.facing[before][:, None] == segments.facing[now])
    first, second = segments.extent_m[before][:, None], segments.extent_m[now] + step_m[:, None]
    apart = np.maximum(first[..., 0] - second[..., 1], second[..., 0] - first[..., 1])
    apart[:, np.arange(len(axis)), axis] = 0.0
    return np.where(same & (apart.max(axis=2) < _TOUCH_M), gap, np.inf)
