"""Compiled: merging whole planes after one of them was cut, as the log evidence of what follows."""

from typing import NamedTuple

import numpy as np

from floorplan.compiled import compiled
from floorplan.merge.evidence_live import SAME_M2, score
from floorplan.merge.plane_fit import PlaneFit
from floorplan.model.checks import Array

DEPTH = 60  # merges that may follow one cut: more than a wing of a building shows


class PlanePairs(NamedTuple):
    """Pairs of planes that some pair of tracks links: `first (P,)` < `second (P,)`, `log_prior (P,)`, `apart (P,)`.

    `distance_m (P,)` between them, `variance_m2 (P,)` of it.
    """

    first: Array
    second: Array
    log_prior: Array
    apart: Array
    distance_m: Array
    variance_m2: Array


class Cut(NamedTuple):
    """Some tracks taken off plane `plane`: they lie `shift_m` beside it with variance `variance_m2`, every plane moves by `-u shift_m`.

    `log_prior (2, K)` of what is left and of what was taken with every plane, `apart (2, K)`; `cost` the log evidence the cut alone
    gains. `plane` -1: nothing is cut.
    """

    plane: int
    shift_m: float
    variance_m2: float
    u: Array
    log_prior: Array
    apart: Array
    cost: float


@compiled
def pairs_of_planes(fit: PlaneFit, links: Array, apart: Array) -> PlanePairs:
    """All pairs of planes with a link; `links (T, K)`, `apart (T, K)` of tracks with planes."""
    count = len(fit.plane_m)
    best, never = np.full((count, count), -np.inf), np.zeros((count, count), np.bool_)
    for t in range(len(fit.label)):
        a = fit.label[t]
        for k in range(count):
            best[a, k] = max(best[a, k], links[t, k])
            never[a, k] |= apart[t, k]
    first, second = np.nonzero(np.triu(best, 1) > -np.inf)
    upper = first < second
    first, second = first[upper], second[upper]
    size = len(first)
    prior, bar, distance, variance = np.empty(size), np.empty(size, np.bool_), np.empty(size), np.empty(size)
    C = fit.covariance_m2
    for h in range(size):
        a, b = first[h], second[h]
        prior[h], bar[h] = best[a, b], never[a, b]
        distance[h], variance[h] = fit.plane_m[a] - fit.plane_m[b], C[a, a] + C[b, b] - 2 * C[a, b]
    return PlanePairs(first, second, prior, bar, distance, variance)


@compiled
def something_follows(pairs: PlanePairs, fit: PlaneFit, cut: Cut) -> bool:
    """Whether any merge of two planes gains after the cut."""
    a, C = cut.plane, fit.covariance_m2
    for h in range(len(pairs.first)):
        i, j = pairs.first[h], pairs.second[h]
        prior, bar = pairs.log_prior[h], pairs.apart[h]
        if i == a or j == a:
            other = j if i == a else i
            prior, bar = cut.log_prior[0, other], cut.apart[0, other]
        part = cut.u[i] - cut.u[j]
        if not bar and _score(pairs.distance_m[h] - part * cut.shift_m, pairs.variance_m2[h] + part * part * cut.variance_m2, prior) > 0:
            return True
    for k in range(len(fit.plane_m)):
        if k == a or cut.apart[1, k] or cut.log_prior[1, k] == -np.inf:
            continue
        part = 1.0 + cut.u[k] - cut.u[a]
        apart_m = fit.plane_m[k] - fit.plane_m[a] - part * cut.shift_m
        variance = C[k, k] + C[a, a] - 2 * C[k, a] + part * part * cut.variance_m2
        if _score(apart_m, variance, cut.log_prior[1, k]) > 0:
            return True
    return False


@compiled
def _score(distance: float, variance: float, log_prior: float) -> float:
    return score(distance, variance, log_prior) if variance >= SAME_M2 and log_prior > -np.inf else -np.inf


@compiled
def roll_out(pairs: PlanePairs, fit: PlaneFit, cut: Cut, first: int) -> tuple[float, Array]:
    """Log evidence gained by the cut and all merges of planes that follow, best first; the plane each one went to (K + 1,).

    The last of the K + 1 is what was cut off; it never goes straight back. Merged first is pair `first`, unless that is -1.
    """
    plane, P = _after(fit, cut)
    prior, bar = _questions(pairs, cut, len(plane))
    became, total = np.arange(len(plane)), cut.cost
    for step in range(DEPTH):
        best, i, j = 0.0, -1, -1
        if step == 0 and first >= 0:
            i, j = pairs.first[first], pairs.second[first]
            best = _score(plane[i] - plane[j], P[i, i] + P[j, j] - 2 * P[i, j], prior[i, j])
        for a in range(len(plane) if i < 0 else 0):
            if became[a] != a:
                continue
            for b in range(a + 1, len(plane)):
                if became[b] != b or bar[a, b]:
                    continue
                value = _score(plane[a] - plane[b], P[a, a] + P[b, b] - 2 * P[a, b], prior[a, b])
                if value > best:
                    best, i, j = value, a, b
        if i < 0:
            break
        total += best
        _merge(plane, P, i, j)
        for k in range(len(plane)):
            prior[i, k] = prior[k, i] = max(prior[i, k], prior[j, k])
            bar[i, k] = bar[k, i] = bar[i, k] or bar[j, k]
            if became[k] == j:
                became[k] = i
    return total, became


@compiled
def _after(fit: PlaneFit, cut: Cut) -> tuple[Array, Array]:
    """Offsets and covariance of the planes and of what was cut off; that comes last, and far from certain where nothing was."""
    count, a, v = len(fit.plane_m), cut.plane, cut.variance_m2
    plane, P = np.zeros(count + 1), np.zeros((count + 1, count + 1))
    for k in range(count):
        plane[k] = fit.plane_m[k] - cut.u[k] * cut.shift_m
        for m in range(count):
            P[k, m] = fit.covariance_m2[k, m] + cut.u[k] * cut.u[m] * v
    if a >= 0:
        plane[count] = plane[a] + cut.shift_m
        for k in range(count):
            P[k, count] = P[count, k] = P[a, k] - cut.u[k] * v
        P[count, count] = P[a, a] - 2 * cut.u[a] * v + v
    return plane, P


@compiled
def _questions(pairs: PlanePairs, cut: Cut, size: int) -> tuple[Array, Array]:
    """Prior log odds of every two planes (K + 1, K + 1), and whether they can never be one."""
    prior, bar, last = np.full((size, size), -np.inf), np.zeros((size, size), np.bool_), size - 1
    for h in range(len(pairs.first)):
        i, j = pairs.first[h], pairs.second[h]
        prior[i, j] = prior[j, i] = pairs.log_prior[h]
        bar[i, j] = bar[j, i] = pairs.apart[h]
    a = cut.plane
    if a >= 0:
        for k in range(last):
            prior[a, k] = prior[k, a] = cut.log_prior[0, k]
            bar[a, k] = bar[k, a] = cut.apart[0, k]
            prior[last, k] = prior[k, last] = cut.log_prior[1, k]
            bar[last, k] = bar[k, last] = cut.apart[1, k]
        prior[a, last] = prior[last, a] = -np.inf
    return prior, bar


@compiled
def _merge(plane: Array, P: Array, i: int, j: int) -> None:
    """Condition all planes on i and j being one."""
    gain = P[i] - P[j]
    variance, distance = gain[i] - gain[j], plane[i] - plane[j]
    for k in range(len(plane)):
        plane[k] -= gain[k] * distance / variance
        for m in range(len(plane)):
            P[k, m] -= gain[k] * gain[m] / variance
