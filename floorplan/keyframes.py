"""Keyframes by change of view: a frame that shows nothing new is not looked at."""

import numpy as np

from floorplan.model.checks import Array


def select_keyframes(stamp_ns: Array, position_m: Array, rotation: Array, distance_m: float, angle_rad: float, gap_s: float) -> Array:
    """Rows (F,) of the frames (N) that moved by `distance_m`, turned by `angle_rad` or came `gap_s` after the last one chosen.

    The first and the last frame are always chosen. `rotation (N, 3, 3)` odom_from_sensor.
    """
    if not len(stamp_ns):
        return np.zeros(0, dtype=np.int64)
    seconds = (stamp_ns - stamp_ns[0]) * 1e-9
    chosen = _changed(seconds, position_m, rotation, distance_m, 1 + 2 * np.cos(angle_rad), gap_s)
    chosen[-1] = True
    return np.flatnonzero(chosen)


def _changed(seconds: Array, position_m: Array, rotation: Array, distance_m: float, min_trace: float, gap_s: float) -> Array:
    """Boolean (N,). The trace of a rotation by an angle is 1 + 2 cos(angle)."""
    chosen = np.zeros(len(seconds), dtype=bool)
    chosen[0], last = True, 0
    for i in range(1, len(seconds)):
        moved = position_m[i] - position_m[last]
        turned = float((rotation[i] * rotation[last]).sum()) <= min_trace
        if turned or moved @ moved >= distance_m**2 or seconds[i] - seconds[last] >= gap_s:
            chosen[i], last = True, i
    return chosen
