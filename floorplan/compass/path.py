"""The most likely course of the Manhattan yaw over a whole recording, modulo 90 degrees: dynamic programming."""

import math

import numpy as np

from floorplan.compass.directions import BIN_RAD, QUARTER_RAD
from floorplan.compiled import compiled
from floorplan.geometry import wrap_to
from floorplan.model.checks import Array

_EVIDENCE = 12.0  # log-likelihood between a frame all of whose surfaces agree and one where none does
_HUBER = 2.0  # steps beyond this many standard deviations cost linearly: odometry slips
_REACH_BINS = 44  # 22 degrees: the largest jump between two neighbours of the path


def step_sigma_rad(peak_rad: Array, share: Array, turn_rad: Array) -> Array:
    """Standard deviation (K - 1,) of odometry's heading error per step, learnt from how the frames' own peaks move.

    `peak_rad (K,)` best yaw of each frame relative to the odometry, `turn_rad (K - 1,)` how far the odometry turned.
    """
    strong = share > np.quantile(share, 0.5)
    pair = strong[1:] & strong[:-1]
    moved = np.abs(wrap_to(np.diff(peak_rad), QUARTER_RAD))
    if pair.sum() < 8:
        return np.full(len(turn_rad), math.radians(1.0))
    still = pair & (np.abs(turn_rad) <= np.median(np.abs(turn_rad[pair])))
    turning = pair & ~still
    base = 1.48 * np.median(moved[still])
    per_turn = 1.48 * np.median(moved[turning] / np.maximum(np.abs(turn_rad[turning]), BIN_RAD)) if turning.any() else 0.0
    return np.asarray(np.sqrt(base**2 + (min(per_turn, 0.5) * turn_rad) ** 2 + BIN_RAD**2))


def best_path(histograms: Array, sigma_rad: Array) -> Array:
    """Yaw (K,) in radians, unwrapped, that trades the frames' `histograms (K, BINS)` against jumps of the odometry."""
    bins = _viterbi(np.ascontiguousarray(histograms), sigma_rad / BIN_RAD, _EVIDENCE, _HUBER, _REACH_BINS)
    yaw = (bins + 0.0) * BIN_RAD
    steps = wrap_to(np.diff(yaw), QUARTER_RAD)
    return np.concatenate((yaw[:1], yaw[0] + np.cumsum(steps)))


@compiled
def _viterbi(histograms: Array, sigma_bins: Array, evidence: float, huber: float, reach: int) -> Array:
    count, bins = histograms.shape
    cost = -evidence * histograms[0]
    came_from = np.zeros((count, bins), np.int16)
    step_cost = np.zeros(2 * reach + 1)
    for k in range(1, count):
        for o in range(-reach, reach + 1):
            z = abs(o) / sigma_bins[k - 1]
            step_cost[o + reach] = 0.5 * z * z if z < huber else huber * (z - 0.5 * huber)
        following = np.empty(bins)
        for b in range(bins):
            best, best_from = 1e300, b
            for o in range(-reach, reach + 1):
                a = (b - o) % bins
                c = cost[a] + step_cost[o + reach]
                if c < best:
                    best, best_from = c, a
            following[b] = best - evidence * histograms[k, b]
            came_from[k, b] = best_from
        cost = following
    path = np.zeros(count, np.int64)
    path[count - 1] = np.argmin(cost)
    for k in range(count - 1, 0, -1):
        path[k - 1] = came_from[k, path[k]]
    return path
