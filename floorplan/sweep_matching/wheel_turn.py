"""How much the wheels turn too far: a little with every metre where one is larger than the other, a part of every turn where
their distance is wrong. Both are the same all recording long, so matched turns tell them.
"""

import numpy as np

from floorplan.geometry import rotation_about_z
from floorplan.model.checks import Array
from floorplan.model.normal import MAD_TO_SIGMA
from floorplan.model.scan import Recording, WheelTurn
from floorplan.sweep_matching.refine import level_poses, with_level_poses

_STRETCH_M, _STRETCH_RAD = 0.5, np.deg2rad(15.0)  # motion over which turns are compared: at less the matching's noise counts
_FEWEST_STRETCHES = 40
_BLOCKS = 10  # of the recording, left out one by one
_ROUNDS, _OUTLIER_SPREADS = 15, 2.0
_LEAST_SPREAD_RAD = 1e-6
_SURE_SIGMAS = 4.0
_LEAST_RAD_PER_M, _LEAST_PART = np.deg2rad(0.3), 0.02  # less than sweeps a metre apart or half a turn apart tell anyway


def find_wheel_turn(recorded: Array, matched: Array) -> WheelTurn | None:
    """What to add to the wheels' turns, from `recorded (N, 3)` and `matched (N, 3)` poses x, y, yaw; None where too little was walked."""
    step = _steps(recorded)
    edges = _stretches(step)
    if len(edges) <= _FEWEST_STRETCHES:
        return None
    walked = np.add.reduceat(np.concatenate((step[:, [0, 2]], np.zeros((1, 2)))), edges)[:-1]
    missing = np.diff(matched[edges, 2]) - walked[:, 1]
    weight = _robust_weights(walked, missing)
    whole = _solved(walked, missing, weight)
    blocks = np.array_split(np.arange(len(missing)), _BLOCKS)
    without = np.array([_solved(*(np.delete(part, block, axis=0) for part in (walked, missing, weight))) for block in blocks])
    sigma = np.sqrt((_BLOCKS - 1) / _BLOCKS * np.sum((without - whole) ** 2, axis=0))  # delete-a-block jackknife
    sure = (np.abs(whole) > (_LEAST_RAD_PER_M, _LEAST_PART)) & (np.abs(whole) > _SURE_SIGMAS * sigma)
    return WheelTurn(float(whole[0]), float(whole[1]), float(sigma[0]), float(sigma[1]), bool(sure.any()))


def turned_right(recording: Recording, turn: WheelTurn) -> Recording:
    """The recording with every turn of its odometry mended, and so its path."""
    pose = level_poses(recording)
    step = _steps(pose)
    mended = (1.0 + turn.part) * step[:, 2] + turn.rad_per_m * step[:, 0]
    pose[1:, 2] = pose[0, 2] + np.cumsum(mended)
    walked = np.einsum("nij,nj->ni", rotation_about_z(pose[:-1, 2])[:, :2, :2], step[:, :2])
    pose[1:, :2] = pose[0, :2] + np.cumsum(walked, axis=0)
    return with_level_poses(recording, pose)


def _steps(pose: Array) -> Array:
    """Motions (N-1, 3) ahead, left and turn from each pose to the next."""
    back = rotation_about_z(-pose[:-1, 2])[:, :2, :2]
    moved = np.diff(pose, axis=0)
    return np.column_stack((np.einsum("nij,nj->ni", back, moved[:, :2]), moved[:, 2]))


def _stretches(step: Array) -> Array:
    """Rows (S + 1,) of poses with about one stretch of motion between them."""
    motion = np.hypot(step[:, 0], step[:, 1]) / _STRETCH_M + np.abs(step[:, 2]) / _STRETCH_RAD
    whole = np.floor(np.cumsum(motion))
    return np.concatenate(([0], np.flatnonzero(np.diff(whole, prepend=0.0) > 0) + 1))


def _robust_weights(walked: Array, missing: Array) -> Array:
    """Weights (S,): slips and wrong matches hardly count."""
    weight = np.ones(len(missing))
    for _ in range(_ROUNDS):
        error = missing - walked @ _solved(walked, missing, weight)
        spread = max(float(np.median(np.abs(error))) * MAD_TO_SIGMA, _LEAST_SPREAD_RAD)
        weight = 1.0 / (1.0 + (error / (_OUTLIER_SPREADS * spread)) ** 2)
    return weight


def _solved(walked: Array, missing: Array, weight: Array) -> Array:
    """Turn per metre and part of each turn (2,)."""
    pulled = walked.T * weight
    return np.asarray(np.linalg.lstsq(pulled @ walked, pulled @ missing, rcond=None)[0])
