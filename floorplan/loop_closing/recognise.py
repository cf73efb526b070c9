"""Whether one place is another one seen before, and how the two lie: search by likelihood, then matching."""

import math
from dataclasses import dataclass

import numpy as np

from floorplan.loop_closing.places import Cloud
from floorplan.model.checks import Array
from floorplan.sweep_matching.kernels import build_cells, match
from floorplan.sweep_matching.search_kernels import best_pose, place_picture

_QUERY_POINTS, _MATCH_POINTS = 250, 400  # of the second place, for the search and for the matching
_YAW_STEP_RAD = math.radians(1.0)  # 0.2 m at 12 m, about the blur
_LEAST_SCORE = 0.5  # mean likelihood: the clouds overlap by two thirds and agree there
_SURE_WITHIN_M = 0.8  # a narrower search cannot mistake one door for the next
_RIVAL_M, _RIVAL_RAD = 1.0, math.radians(10.0)  # a pose so far from the best one is another place
_RIVAL_SHARE = 0.9  # of the best score: as good as that, the places cannot be told apart
_LEAST_MATCHED = 0.55  # of the points lie on the other place's surfaces
_FIRST_GATE_M, _LAST_GATE_M = 0.4, 0.1
_MATCH_SIGMAS, _POINT_SHARE, _ROUNDS, _FREEDOM = 3.0, 0.2, 15.0, 9.0
_OPTIONS = np.array([_FIRST_GATE_M, _LAST_GATE_M, _MATCH_SIGMAS, _POINT_SHARE, _ROUNDS, _FREEDOM])
_BENT_M, _BENT_RAD = 0.02, math.radians(0.25)  # a place drawn over 8 m of path is bent by so much
_NOWHERE = np.zeros(5)


@dataclass(frozen=True)
class Window:
    """How far a pose may lie from where it is expected: standard half widths, m and rad."""

    half_m: float
    half_rad: float


@dataclass(frozen=True)
class Recognised:
    """`relative (3,)` x, y, yaw of the second place seen from the first, its `information (3, 3)`, share of points matched."""

    relative: Array
    information: Array
    share: float


def recognise(place: Cloud, seen: Cloud, expected: Array, window: Window) -> Recognised | None:
    """The pose of `seen` in the axes of `place`, searched within `window` of `expected (3,)`; None where it is not the same place."""
    start = expected if window.half_m <= _FIRST_GATE_M else _searched(place, seen, expected, window)
    return None if start is None else _matched(place, seen, start, window)


def _searched(place: Cloud, seen: Cloud, expected: Array, window: Window) -> Array | None:
    picture, origin = place_picture(place.row[:, :2])
    query = np.ascontiguousarray(seen.row[:: max(len(seen.row) // _QUERY_POINTS, 1), :2])
    asked = np.array((window.half_m, window.half_rad, _YAW_STEP_RAD))
    best = best_pose(picture, origin, query, expected, asked, _LEAST_SCORE, _NOWHERE)
    if best[3] == 0.0:
        return None
    if window.half_m > _SURE_WITHIN_M:
        around = np.array((best[0], best[1], best[2], _RIVAL_M, _RIVAL_RAD))
        if best_pose(picture, origin, query, expected, asked, _RIVAL_SHARE * best[3], around)[3] > 0.0:
            return None
    return best[:3]


def _matched(place: Cloud, seen: Cloud, start: Array, window: Window) -> Recognised | None:
    """Points to lines from a start within the first gate."""
    points = np.column_stack((place.row, np.ones(len(place.row)), np.zeros(len(place.row))))
    frame, first, order = build_cells(points)
    prior = np.diag((window.half_m**-2, window.half_m**-2, window.half_rad**-2))
    every = max(len(seen.row) // _MATCH_POINTS, 1)
    row, sigma = np.ascontiguousarray(seen.row[::every]), np.ascontiguousarray(seen.sigma_m[::every])
    pose, information, share = match(row, sigma, start, prior, points, frame, first, order, _OPTIONS)
    away = pose - start
    if share < _LEAST_MATCHED or math.hypot(away[0], away[1]) > 2 * _FIRST_GATE_M:
        return None
    told = np.linalg.inv(information + prior) + np.diag((_BENT_M**2, _BENT_M**2, _BENT_RAD**2))
    return Recognised(pose, np.linalg.inv(told), share)
