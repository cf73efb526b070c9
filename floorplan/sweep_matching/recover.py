"""A sweep that does not fit where the odometry puts it is looked for all around: slips, and stamps that come late in a turn."""

import math

import numpy as np

from floorplan.model.checks import Array
from floorplan.sweep_matching.search_kernels import best_pose, place_picture
from floorplan.sweep_matching.surfaces import SweepSurfaces

VIEW_M = 12.0  # of map and sweep; further off a small turn is a large motion
_QUERY_POINTS = 150
_FEWEST_POINTS = 20
_YAW_STEP_RAD = math.radians(1.0)  # 0.2 m at 12 m, about the blur of the picture
_HALF_M, _PER_STEP = 0.5, 0.3  # half width of the search, plus that part of the step
_HALF_RAD, _PER_TURN, _MOST_RAD = math.radians(12.0), 0.5, math.radians(45.0)
_LEAST_SCORE = 0.4
_GAP_HALF_M, _ALL_AROUND_RAD = 1.0, math.radians(170.0)  # where sweeps are missing; just short of half a turn, which would count twice
_TURNED_RAD, _RIVAL_SHARE = math.radians(30.0), 0.9  # a pose turned by more that scores so well is a rival
_NOWHERE = np.zeros(5)


def searched(seen: SweepSurfaces, predicted: Array, step: Array, map_points: Array, after_gap: bool = False) -> Array | None:
    """The pose (3,) about `predicted` at which the sweep looks most like the map; None where it does nowhere.

    `after_gap`: nobody knows which way the sensor turned meanwhile. It is looked for in every direction, and None is given where
    it looks nearly as much like the map when turned otherwise: rooms are square.
    """
    near = np.hypot(map_points[:, 0] - predicted[0], map_points[:, 1] - predicted[1]) < VIEW_M
    row = seen.row[np.hypot(seen.row[:, 0], seen.row[:, 1]) < VIEW_M, :2]
    if near.sum() < _FEWEST_POINTS or len(row) < _FEWEST_POINTS:
        return None
    picture, origin = place_picture(np.ascontiguousarray(map_points[near, :2]))
    query = np.ascontiguousarray(row[:: max(len(row) // _QUERY_POINTS, 1)])
    half_rad = _ALL_AROUND_RAD if after_gap else min(_HALF_RAD + _PER_TURN * abs(step[2]), _MOST_RAD)
    half_m = _HALF_M + _PER_STEP * math.hypot(step[0], step[1])
    window = np.array((_GAP_HALF_M + half_m if after_gap else half_m, half_rad, _YAW_STEP_RAD))
    found = best_pose(picture, origin, query, predicted, window, _LEAST_SCORE, _NOWHERE)
    if found[3] > 0.0 and after_gap:
        around = np.array((found[0], found[1], found[2], math.inf, _TURNED_RAD))
        if best_pose(picture, origin, query, predicted, window, _RIVAL_SHARE * found[3], around)[3] > 0.0:
            return None
    return found[:3] if found[3] > 0.0 else None
