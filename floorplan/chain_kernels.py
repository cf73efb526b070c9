"""Compiled kernels of the block chain: elimination into the planes, back-substitution. See docs/back-end.md, "Elimination"."""

import numpy as np
from numba import njit

from floorplan.model.checks import Array

PANEL = 32  # values of one column kept before they are multiplied out: long enough for vector instructions


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
def _admit(column: int, slot: Array, active: Array, panel: Array, count: int) -> int:
    slot[column] = count
    active[count] = column
    panel[count] = 0.0
    return count + 1


@njit(cache=True)
def _forget(active: Array, slot: Array, newest: Array, dying: Array, first: int, count: int) -> int:
    """Drop the columns marked `dying` (count,), moving the others up; gives back how many are left."""
    kept = first
    for a in range(first, count):
        column = active[a]
        if dying[a]:
            slot[column] = -1
            continue
        active[kept] = column
        newest[kept] = newest[a]
        slot[column] = kept
        kept += 1
    return kept


@njit(cache=True, fastmath={"contract", "reassoc"})
def _subtract_gram(panel: Array, active: Array, used: int, information: Array) -> None:
    """information -= panel panel^T, one of the two entries of every pair (whichever comes)."""
    for a in range(used):
        into, mine = information[active[a]], panel[a]
        for b in range(a + 1):
            other, value = panel[b], 0.0
            for k in range(mine.shape[0]):
                value += mine[k] * other[k]
            into[active[b]] -= value


@njit(cache=True)
def _advance(lower: Array, link: Array, panel: Array, newest: Array, used: int, at: int) -> None:
    """Share of every active column in this frame: panel <- L^-1 (panel - W newest)."""
    n = lower.shape[0]
    for a in range(used):
        mine = panel[a, at : at + n]
        _carry(link, newest[a], mine)
        _forward(lower, mine)
        newest[a] = mine


@njit(cache=True)
def reduce_columns(
    lower: Array, link: Array, rhs: Array, dense: Array, row_start: Array, component: Array, column: Array, weight: Array,
    last: Array, scale: Array, information: Array, reduced_rhs: Array, forgotten: float,
) -> float:
    """Subtract B^T T^-1 B from `information` and B^T T^-1 h from `reduced_rhs`; gives back h^T T^-1 h.

    Only columns still felt by the frame at hand are carried (the window): frames know their place to centimetres once the
    planes are given, so a plane's share decays within metres after it was last seen. `dense (N, n, G)` columns
    come after the M planes and are always carried. Rows are sorted by frame, `row_start (N + 1,)`.
    """
    count, n = rhs.shape
    planes, width = scale.shape[0], dense.shape[2]
    total, batch = planes + width, PANEL // n
    slot, active, dying = np.full(total, -1), np.empty(total, np.int64), np.zeros(total, np.bool_)
    panel, newest = np.zeros((total, batch * n)), np.zeros((total, n))
    nothing, y, h, quadratic, used = np.zeros((n, n)), np.zeros(n), np.zeros(n), 0.0, 0
    for g in range(width):
        used = _admit(planes + g, slot, active, panel, used)
    for i in range(count):
        at = (i % batch) * n
        before = link[i - 1] if i > 0 else nothing
        h[:] = rhs[i]
        _carry(before, y, h)
        for g in range(width):
            panel[g, at : at + n] += dense[i, :, g]
        for r in range(row_start[i], row_start[i + 1]):
            if slot[column[r]] < 0:
                newest[used] = 0.0
                used = _admit(column[r], slot, active, panel, used)
            panel[slot[column[r]], at + component[r]] -= weight[r]
        _forward(lower[i], h)
        y[:] = h
        quadratic += np.dot(y, y)
        _advance(lower[i], before, panel, newest, used, at)
        for a in range(used):
            reduced_rhs[active[a]] -= np.dot(newest[a], y)
        if at + n == batch * n or i == count - 1:
            _subtract_gram(panel, active, used, information)
            for a in range(used):
                dying[a] = last[active[a]] <= i and np.abs(newest[a]).max() < forgotten * scale[active[a]] if a >= width else False
            used = _forget(active, slot, newest, dying, width, used)
            panel[:used] = 0.0
    return quadratic
