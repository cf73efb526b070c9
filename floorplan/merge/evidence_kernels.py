"""Compiled kernels of the evidence merge: scores, conditioning on a merge, roll-outs. See docs/back-end.md, "Evidence".

A live pair h asks whether components `first[h]` and `second[h]` are one plane: `delta` their distance, `var` its variance, both given all
merges so far. The covariance of all planes is `P - U[:r]^T U[:r]`: rank-one updates wait in `U` and are multiplied out in batches.
"""

import numpy as np
from numba import njit

from floorplan.model.checks import Array

SAME_M2 = 1e-10  # (0.01 mm)^2: a pair whose distance is this certain has been made one by other merges
CONCERNED = 0.25  # a pair whose variance falls below this part of what it was is settled by the choice at hand
APART, DEFERRED = 1, 2  # bits of `barred`: seen apart in one frame; put off until something else is decided
LOG_TWO_PI = np.log(2 * np.pi)


@njit(cache=True)
def score(delta: float, var: float, log_prior: float) -> float:
    """Log odds that a pair is one plane (E8)."""
    odds: float = log_prior - 0.5 * (LOG_TWO_PI + np.log(var) + delta * delta / var)
    return odds


@njit(cache=True)
def column(P: Array, U: Array, r: int, a: int, b: int, out: Array) -> None:
    """out <- covariance of every plane with m_a - m_b."""
    pa, pb = P[a], P[b]
    for i in range(out.shape[0]):
        out[i] = pa[i] - pb[i]
    for k in range(r):
        row = U[k]
        part = row[a] - row[b]
        if part != 0.0:
            for i in range(out.shape[0]):
                out[i] -= row[i] * part


@njit(cache=True)
def best_pair(delta: Array, var: Array, log_prior: Array, barred: Array, mask: int, count: int) -> int:
    """The live pair of highest score among those with no bit of `mask`; -1 where none scores above zero."""
    best, found = 0.0, -1
    for h in range(count):
        if barred[h] & mask or var[h] < SAME_M2:
            continue
        value = score(delta[h], var[h], log_prior[h])
        if value > best:
            best, found = value, h
    return found


@njit(cache=True)
def condition(first: Array, second: Array, delta: Array, var: Array, count: int, unit: Array, pull: float) -> None:
    """Every pair's distance and variance after a merge with gain `unit` (covariance with the merged distance / its sigma)."""
    for h in range(count):
        part = unit[first[h]] - unit[second[h]]
        delta[h] -= part * pull
        var[h] = max(var[h] - part * part, 0.0)


@njit(cache=True)
def rivals(
    first: Array, second: Array, delta: Array, var: Array, log_prior: Array, barred: Array, count: int, unit: Array, pull: float,
    chosen: int, close: float, found: Array,
) -> int:
    """Pairs nearly as good as the chosen one that would be lost by merging it; strongest first into `found`, gives back how many."""
    floor = score(delta[chosen], var[chosen], log_prior[chosen]) - close
    strength, used = np.zeros(found.shape[0]), 0
    for h in range(count):
        if h == chosen or barred[h] & APART or var[h] < SAME_M2:
            continue
        now = score(delta[h], var[h], log_prior[h])
        if now <= max(floor, 0.0):
            continue
        part = unit[first[h]] - unit[second[h]]
        then = var[h] - part * part
        if then < SAME_M2 or then > CONCERNED * var[h] or score(delta[h] - part * pull, then, log_prior[h]) > 0.0:
            continue
        place = used
        while place > 0 and strength[place - 1] < now:
            place -= 1
        if place < found.shape[0]:
            for k in range(min(used, found.shape[0] - 1), place, -1):
                strength[k], found[k] = strength[k - 1], found[k - 1]
            strength[place], found[place] = now, h
            used = min(used + 1, found.shape[0])
    return used


@njit(cache=True)
def roll_out(
    first: Array, second: Array, delta: Array, var: Array, log_prior: Array, barred: Array, concerned: Array, count: int, P: Array,
    U: Array, r: int, chosen: int, depth: int,
) -> float:
    """Summed score of merging `chosen` and then greedily up to `depth` more `concerned` pairs: the log evidence of that future.

    A pair counts only once this future has made it better known: a leap at another open question would drown the comparison.

    `U` must have room for depth + 1 more rows; what is written there is not meant to stay.
    """
    before = var
    delta, var = delta[:count].copy(), var[:count].copy()
    cov, total, h = np.empty(P.shape[0]), 0.0, chosen
    for step in range(depth + 1):
        total += score(delta[h], var[h], log_prior[h])
        column(P, U, r + step, first[h], second[h], cov)
        sigma = np.sqrt(var[h])
        for i in range(cov.shape[0]):
            U[r + step, i] = cov[i] / sigma
        condition(first, second, delta, var, count, U[r + step], delta[h] / sigma)
        h = _best_concerned(delta, var, before, log_prior, barred, concerned, count)
        if h < 0:
            break
    return total


@njit(cache=True)
def mark_concerned(first: Array, second: Array, var: Array, count: int, unit: Array, concerned: Array) -> None:
    """Set `concerned` for the pairs that a merge with gain `unit` would make clearly better known."""
    for h in range(count):
        part = unit[first[h]] - unit[second[h]]
        if part * part > (1.0 - CONCERNED) * var[h]:
            concerned[h] = True


@njit(cache=True)
def _best_concerned(delta: Array, var: Array, before: Array, log_prior: Array, barred: Array, concerned: Array, count: int) -> int:
    best, found = 0.0, -1
    for h in range(count):
        if not concerned[h] or barred[h] & APART or var[h] < SAME_M2 or var[h] > CONCERNED * before[h]:
            continue
        value = score(delta[h], var[h], log_prior[h])
        if value > best:
            best, found = value, h
    return found


@njit(cache=True)
def relabel(
    first: Array, second: Array, delta: Array, var: Array, log_prior: Array, barred: Array, origin: Array, final_delta: Array,
    final_var: Array, count: int, keep: int, gone: int, seat: Array,
) -> int:
    """Rename component `gone` to `keep` in all live pairs, join doubled pairs, drop those now inside; gives back how many live.

    Of two pairs that ask the same question the better prior counts (the smaller gap) and a bar of either stays.
    `seat (planes,)` is scratch, -1 everywhere before and after.
    """
    kept = 0
    for h in range(count):
        a = keep if first[h] == gone else first[h]
        b = keep if second[h] == gone else second[h]
        other = b if a == keep else a
        touches = a == keep or b == keep
        if a == b or (touches and seat[other] >= 0):
            final_delta[origin[h]], final_var[origin[h]] = delta[h], var[h]
            if a != b:
                twin = seat[other]
                log_prior[twin] = max(log_prior[twin], log_prior[h])
                barred[twin] = barred[twin] | barred[h]
            continue
        first[kept], second[kept], delta[kept], var[kept] = a, b, delta[h], var[h]
        log_prior[kept], barred[kept], origin[kept] = log_prior[h], barred[h], origin[h]
        if touches:
            seat[other] = kept
        kept += 1
    for h in range(kept):
        seat[first[h]] = seat[second[h]] = -1
    return kept
