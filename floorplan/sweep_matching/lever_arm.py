"""Where the sensor sits on the robot, told by the turns: wheels report their own axis, a sensor ahead of it swings sideways.

Hand-eye calibration in the plane: between two sweeps with the robot's motion `a` (turned by `w`) and the sensor's `x`,
`x = M a + (R(w) - 1) l`. `l` is the lever arm; `M`, a scale and a turn of the odometry, is solved for as well, so that neither is
taken for a lever. Linear least squares; every turn weighs as much as the surfaces it saw know of it, so corridors add nothing.
"""

from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np

from floorplan.geometry import rotation_about_z
from floorplan.model.checks import Array
from floorplan.model.normal import MAD_TO_SIGMA
from floorplan.model.scan import LeverArm, Recording

_TURN_RAD = np.deg2rad(15.0)  # one turning step: at less the matching's noise hides the lever ...
_LONGEST_M = 1.0  # ... over a longer way the odometry's does
_FEWEST_STEPS = 20
_BLOCKS = 10  # of the recording, left out one by one: what wheels do wrong lasts longer than one turn
_UNSEEN_M2 = 100.0  # variance of a sweep's place along what its surfaces leave open
_REST_M = 0.003  # matching errors that all sweeps share
_FIRST_SPREAD_M, _ROUNDS, _OUTLIER_SPREADS = 0.02, 15, 2.0
_SURE_SIGMAS = 4.0
_LEAST_M = 0.02  # a shorter lever moves no prediction by more than sweeps tell anyway


@dataclass(frozen=True)
class _Turns:
    """K turning steps: `rows (K, 2, 4)` of the unknowns (scale, turn, forward, left), `moved_m (K, 2)`, `known_m2 (K, 2, 2)` of that."""

    rows: Array
    moved_m: Array
    known_m2: Array


def find_lever_arm(recorded: Array, matched: Array, information: Array) -> LeverArm | None:
    """The lever arm between `recorded (N, 3)` poses x, y, yaw of the wheels and `matched (N, 3)` ones of the sensor.

    `information (N, 3, 3)` of each matched pose from its surfaces alone. None where the robot turned too seldom to tell.
    """
    turns = _turns(recorded, matched, information)
    if len(turns.moved_m) < _FEWEST_STEPS:
        return None
    weight = _robust_weights(turns)
    whole = _solved(turns, weight, slice(0, 0))[2:]
    edges = np.linspace(0, len(weight), _BLOCKS + 1).round().astype(int)
    without = [_solved(turns, weight, slice(low, high))[2:] for low, high in pairwise(edges)]
    sigma = np.sqrt((_BLOCKS - 1) / _BLOCKS * np.sum((np.array(without) - whole) ** 2, axis=0))  # delete-a-block jackknife
    size = float(np.hypot(*whole))
    applied = size > _LEAST_M and size > _SURE_SIGMAS * float(sigma.max())
    return LeverArm(float(whole[0]), float(whole[1]), float(sigma[0]), float(sigma[1]), len(weight), applied)


def at_the_sensor(recording: Recording, lever: LeverArm) -> Recording:
    """The recording with each pose moved from the wheels' axis to the sensor."""
    arm = np.array((lever.forward_m, lever.left_m, 0.0))
    return replace(recording, position_m=recording.position_m + recording.odom_from_sensor @ arm)


def _turns(recorded: Array, matched: Array, information: Array) -> _Turns:
    pairs = _pairs(matched)
    start, end = pairs[:, 0], pairs[:, 1]
    a = _seen_from(recorded[start], recorded[end])
    turned = matched[end, 2] - matched[start, 2]
    rows = np.empty((len(pairs), 2, 4))
    rows[:, 0, :2], rows[:, 1, :2] = np.column_stack((a[:, 0], -a[:, 1])), np.column_stack((a[:, 1], a[:, 0]))
    rows[:, :, 2:] = rotation_about_z(turned)[:, :2, :2] - np.eye(2)
    spread = _place_variance(information[start]) + _place_variance(information[end])
    back = rotation_about_z(-matched[start, 2])[:, :2, :2]
    return _Turns(rows, _seen_from(matched[start], matched[end]), back @ spread @ np.swapaxes(back, 1, 2))


def _pairs(matched: Array) -> Array:
    """Rows (K, 2) of sweeps one turning step apart, each beginning where the last one ended."""
    path = np.concatenate(([0.0], np.cumsum(np.hypot(*np.diff(matched[:, :2], axis=0).T))))
    first, found = 0, []
    for k in range(1, len(matched)):
        if abs(matched[k, 2] - matched[first, 2]) >= _TURN_RAD:
            if path[k] - path[first] <= _LONGEST_M:
                found.append((first, k))
            first = k
        elif path[k] - path[first] > _LONGEST_M:
            first = k
    return np.array(found, dtype=np.int64).reshape(-1, 2)


def _seen_from(first: Array, second: Array) -> Array:
    """Places (K, 2) of the second poses in the axes of the first."""
    back = rotation_about_z(-first[:, 2])[:, :2, :2]
    return np.asarray(np.einsum("kij,kj->ki", back, second[:, :2] - first[:, :2]))


def _place_variance(information: Array) -> Array:
    """Covariance (K, 2, 2) of places, m2; a direction that no surface tells gets _UNSEEN_M2."""
    return np.asarray(np.linalg.inv(information + np.eye(3) / _UNSEEN_M2)[:, :2, :2])


def _robust_weights(turns: _Turns) -> Array:
    """Information matrices (K, 2, 2) of the turning steps; slips and wrong matches, far from the rest, hardly count."""
    spread = _FIRST_SPREAD_M
    fit = np.ones(len(turns.moved_m))
    for _ in range(_ROUNDS):
        told = np.linalg.inv(turns.known_m2 + (spread**2 + _REST_M**2) * np.eye(2))
        error = turns.moved_m - turns.rows @ _solved(turns, told * fit[:, None, None], slice(0, 0))
        squared = np.einsum("ki,kij,kj->k", error, told, error)
        fit = 1.0 / (1.0 + squared / (2 * _OUTLIER_SPREADS**2))
        sharp = np.trace(told, axis1=1, axis2=2)
        spread = float(np.median(np.abs(error[sharp > 0.5 * sharp.max()]))) * MAD_TO_SIGMA
    return np.asarray(told * fit[:, None, None])


def _solved(turns: _Turns, weight: Array, left_out: slice) -> Array:
    """The unknowns (4,) without the steps `left_out`."""
    kept = np.ones(len(weight), dtype=bool)
    kept[left_out] = False
    rows, told = turns.rows[kept], weight[kept]
    pulled = np.swapaxes(rows, 1, 2) @ told
    return np.asarray(np.linalg.lstsq((pulled @ rows).sum(axis=0), np.einsum("kai,ki->a", pulled, turns.moved_m[kept]), rcond=None)[0])
