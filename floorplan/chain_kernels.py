"""Compiled kernels of the block chain: elimination into the planes, back-substitution. See docs/back-end.md, "Elimination"."""

import numpy as np
from numba import njit

from floorplan.model.checks import Array

FORGOTTEN = 1e-14  # a column's share below this part of its own scale is rounding error of the reduced system


@njit(cache=True)
def _factor(block: Array, lower: Array) -> float:
    """Cholesky of one n x n block into `lower`; gives back log det, or NaN where the block is not positive definite."""
    n = block.shape[0]
    log_det = 0.0
    for i in range(n):
        for j in range(i + 1):
            value = block[i, j]
            for k in range(j):
                value -= lower[i, k] * lower[j, k]
            if i != j:
                lower[i, j] = value / lower[j, j]
            elif value <= 0.0:
                return np.nan
            else:
                lower[i, i] = np.sqrt(value)
                log_det += np.log(value)
    return log_det


@njit(cache=True)
def _forward(lower: Array, vector: Array) -> None:
    """vector <- L^-1 vector."""
    for i in range(vector.shape[0]):
        value = vector[i]
        for k in range(i):
            value -= lower[i, k] * vector[k]
        vector[i] = value / lower[i, i]


@njit(cache=True)
def _backward(lower: Array, vector: Array) -> None:
    """vector <- L^-T vector."""
    n = vector.shape[0]
    for i in range(n - 1, -1, -1):
        value = vector[i]
        for k in range(i + 1, n):
            value -= lower[k, i] * vector[k]
        vector[i] = value / lower[i, i]


@njit(cache=True)
def _carry(link: Array, vector: Array, out: Array) -> None:
    """out <- out - W vector."""
    for i in range(out.shape[0]):
        for k in range(vector.shape[0]):
            out[i] -= link[i, k] * vector[k]


@njit(cache=True)
def factor_chain(diagonal: Array, coupling: Array, lower: Array, link: Array) -> float:
    """Block Cholesky: `lower (N, n, n)` of the pivots, `link (N, n, n)` = O_i L_i^-T; gives back log det of the chain."""
    count, n = diagonal.shape[0], diagonal.shape[1]
    pivot = np.empty((n, n))
    log_det = 0.0
    for i in range(count):
        pivot[:] = diagonal[i]
        if i > 0:
            for r in range(n):
                for c in range(r + 1):
                    for k in range(n):
                        pivot[r, c] -= link[i - 1, r, k] * link[i - 1, c, k]
        log_det += _factor(pivot, lower[i])
        if i < count - 1:
            for r in range(n):
                link[i, r] = coupling[i, r]
                _forward(lower[i], link[i, r])
    return log_det


@njit(cache=True)
def solve_chain(lower: Array, link: Array, rhs: Array) -> None:
    """rhs (N, n) <- T^-1 rhs."""
    count = rhs.shape[0]
    for i in range(count):
        if i > 0:
            _carry(link[i - 1], rhs[i - 1], rhs[i])
        _forward(lower[i], rhs[i])
    for i in range(count - 1, -1, -1):
        if i < count - 1:
            for k in range(rhs.shape[1]):
                for r in range(rhs.shape[1]):
                    rhs[i, k] -= link[i, r, k] * rhs[i + 1, r]
        _backward(lower[i], rhs[i])


@njit(cache=True)
def _admit(column: int, slot: Array, active: Array, share: Array, count: int) -> int:
    slot[column] = count
    active[count] = column
    share[count] = 0.0
    return count + 1


@njit(cache=True)
def _forget(active: Array, slot: Array, share: Array, last: Array, scale: Array, frame: int, first: int, count: int) -> int:
    """Drop columns whose last row is behind and whose share has decayed to rounding error."""
    kept = first
    for a in range(first, count):
        column = active[a]
        largest = 0.0
        for k in range(share.shape[1]):
            largest = max(largest, abs(share[a, k]))
        if last[column] <= frame and largest < FORGOTTEN * scale[column]:
            slot[column] = -1
            continue
        if kept != a:
            active[kept] = column
            share[kept] = share[a]
            slot[column] = kept
        kept += 1
    return kept


@njit(cache=True, fastmath={"contract", "reassoc"})
def reduce_columns(
    lower: Array, link: Array, rhs: Array, dense: Array, row_start: Array, component: Array, column: Array, weight: Array,
    last: Array, scale: Array, information: Array, reduced_rhs: Array,
) -> float:
    """Subtract B^T T^-1 B from `information` and B^T T^-1 h from `reduced_rhs`; gives back h^T T^-1 h.

    Only columns still felt by the frame at hand are carried (the window): frames know their place to centimetres once the
    planes are given, so a plane's share decays within metres after it was last seen. `dense (N, n, G)` columns
    come after the M planes and are always carried. Rows are sorted by frame, `row_start (N + 1,)`.
    """
    count, n = rhs.shape
    planes, width = scale.shape[0], dense.shape[2]
    slot = np.full(planes + width, -1)
    active = np.empty(planes + width, np.int64)
    share = np.zeros((planes + width, n))
    old, y, quadratic = np.zeros(n), np.zeros(n), 0.0
    used = 0
    for g in range(width):
        used = _admit(planes + g, slot, active, share, used)
    for i in range(count):
        h = rhs[i].copy()
        if i > 0:
            _carry(link[i - 1], y, h)
            for a in range(used):
                old[:] = share[a]
                share[a] = 0.0
                _carry(link[i - 1], old, share[a])
        for g in range(width):
            for k in range(n):
                share[g, k] += dense[i, k, g]
        for r in range(row_start[i], row_start[i + 1]):
            if slot[column[r]] < 0:
                used = _admit(column[r], slot, active, share, used)
            share[slot[column[r]], component[r]] -= weight[r]
        _forward(lower[i], h)
        y[:] = h
        for k in range(n):
            quadratic += y[k] * y[k]
        for a in range(used):
            _forward(lower[i], share[a])
            for k in range(n):
                reduced_rhs[active[a]] -= share[a, k] * y[k]
        for a in range(used):
            into = information[active[a]]
            for b in range(a + 1):
                value = 0.0
                for k in range(n):
                    value += share[a, k] * share[b, k]
                into[active[b]] -= value
        used = _forget(active, slot, share, last, scale, i, width, used)
    return quadratic
