"""Readings of a wandering angle that are astray, and places where the walk itself slipped.

A reading is astray when it agrees neither with what came before nor with what comes after. Where what came before and what comes after
disagree with each other, the walk slipped between: to hold it stiff there would bend it for many steps on both sides.
"""

import math

import numpy as np

from floorplan.compiled import compiled
from floorplan.model.checks import Array

_TRUSTED = 2.5  # standard deviations beyond which a reading counts less
_SLIP = 4.0  # standard deviations between past and future that make a slip
_APART = 12  # steps: around a slip past and future disagree for a while, of one slip the worst step is taken
_ROUNDS = 5
_VAGUE_RAD2 = 1.0  # variance before the first reading


def without_strays(reading: Array, variance: Array, step_variance: Array) -> tuple[Array, Array]:
    """Variances (K,) of the readings, larger for strays, and of the steps (K - 1,), larger where the walk slipped.

    `variance` is infinite where nothing was read.
    """
    believed, walked = variance.copy(), step_variance.copy()
    if np.isfinite(variance).sum() < 2:
        return believed, walked
    known = np.isfinite(variance)
    for _ in range(_ROUNDS):
        sides = _both_sides(reading, believed, walked)
        wanted = np.minimum(*(((reading - side[0]) / _TRUSTED) ** 2 - side[1] for side in sides))
        believed = np.maximum(variance, wanted)
        past, future = _both_sides(reading, believed, walked)  # anew: a stray reading must not pass for a slip there and back
        walked = _with_slips(past[2:], future[2:], known, step_variance, walked)
    return believed, walked


def _both_sides(reading: Array, variance: Array, step_variance: Array) -> tuple[Array, Array]:
    """The walk as seen from the past and from the future: see `_seen_from_past`."""
    future = _seen_from_past(reading[::-1].copy(), variance[::-1].copy(), step_variance[::-1].copy())
    return _seen_from_past(reading, variance, step_variance), future[:, ::-1].copy()


@compiled
def _seen_from_past(reading: Array, variance: Array, step_variance: Array) -> Array:
    """Mean and variance of the walk before each reading is heard, and after (4, K)."""
    out = np.empty((4, len(reading)))
    known = np.isfinite(variance)
    m, v = reading[np.argmax(known)], _VAGUE_RAD2
    for k in range(len(reading)):
        if k > 0:
            v += step_variance[k - 1]
        out[0, k], out[1, k] = m, v
        if known[k]:
            gain = v / (v + variance[k])
            m, v = m + gain * (reading[k] - m), (1 - gain) * v
        out[2, k], out[3, k] = m, v
    return out


@compiled
def _with_slips(past: Array, future: Array, known: Array, step_variance: Array, walked: Array) -> Array:
    """The steps' variances, with the square of what past and future differ by added where that is worst: over the whole of a gap."""
    count = len(walked)
    ratio = np.empty(count)
    for k in range(count):
        ratio[k] = abs(past[0, k] - future[0, k + 1]) / math.sqrt(past[1, k] + future[1, k + 1] + walked[k])
    out = walked.copy()
    k = 0
    while k < count:
        if ratio[k] <= _SLIP or ratio[k] < ratio[max(k - _APART, 0) : k + _APART + 1].max():
            k += 1
            continue
        first, last = k, k
        while first > 0 and not known[first]:
            first -= 1
        while last + 1 < count and not known[last + 1]:
            last += 1
        slip = (past[0, k] - future[0, k + 1]) ** 2
        total = step_variance[first : last + 1].sum()
        for j in range(first, last + 1):
            out[j] += slip * step_variance[j] / total
        k = last + _APART
    return out
