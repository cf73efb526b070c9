"""The rigid motion through control points, and the one of them that does not belong."""

from dataclasses import dataclass

import numpy as np

from floorplan.model.checks import Array

LOUD_M = 0.05  # a point that the others place this far away is told, where ...
LOUD_RATIO = 3.0  # ... without it they fit so many times better, and better than without any other
LEAST_RMS_M = 0.005  # points that fit to less are as good as exact
FEWEST = 3  # points of which one can be told from the others


@dataclass(frozen=True)
class Fit:
    """Turn and shift from plan to grid; `rms_m` of what they miss."""

    angle_rad: float
    shift_m: Array
    rms_m: float

    def missed_m(self, here: Array, there: Array) -> Array:
        """How far each point (N, 2) of the plan comes to lie from its place on the grid, (N,)."""
        return np.asarray(np.linalg.norm(here @ _turn(self.angle_rad).T + self.shift_m - there, axis=1))


def fit_points(here: Array, there: Array, angle_rad: float | None = None) -> Fit:
    """Turn and shift with the least squares of misses (N, 2); only the shift where the angle is given."""
    a, b = here - here.mean(axis=0), there - there.mean(axis=0)
    if angle_rad is None:
        angle_rad = float(np.arctan2((a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0]).sum(), (a * b).sum()))
    turn = _turn(angle_rad)
    shift = there.mean(axis=0) - turn @ here.mean(axis=0)
    return Fit(angle_rad, shift, float(np.sqrt((((a @ turn.T) - b) ** 2).sum(axis=1).mean())))


@dataclass(frozen=True)
class OddPoint:
    """The point (its row) that all others contradict, and how far from its place they put it."""

    row: int
    miss_m: float


def odd_point(here: Array, there: Array) -> OddPoint | None:
    """The one point without which the others fit far better: a bad one pulls the fit, so that its neighbours seem wrong too."""
    rows = np.arange(len(here))
    if len(rows) < FEWEST:
        return None
    fits = [fit_points(here[rows != row], there[rows != row]) for row in rows]
    order = np.argsort([fit.rms_m for fit in fits], kind="stable")
    best = int(order[0])
    miss = float(fits[best].missed_m(here[[best]], there[[best]])[0])
    others = min(fit_points(here, there).rms_m, fits[int(order[1])].rms_m)
    singled_out = others > LOUD_RATIO * max(fits[best].rms_m, LEAST_RMS_M)
    return OddPoint(best, miss) if miss > LOUD_M and singled_out else None


def _turn(angle_rad: float) -> Array:
    cos, sin = np.cos(angle_rad), np.sin(angle_rad)
    return np.array([[cos, -sin], [sin, cos]])
