"""Compiled joint covariance of all planes from a frontal factor: backwards in time, each from what comes after it.

Given everything later, a frame or plane is `R z + noise` of the open seats and the next frame, `z`; so its covariance with every
later plane is `R` times theirs (H. E. Rauch, F. Tung, C. T. Striebel, Maximum likelihood estimates of linear dynamic systems, 1965).
"""

from typing import NamedTuple

import numpy as np

from floorplan.block_kernels import backward_block, forward_block
from floorplan.compiled import compiled
from floorplan.frontal_kernels import Factor
from floorplan.model.checks import Array


class _Later(NamedTuple):
    """Covariance of the open seats (C,) and of the next frame (n) with the columns known so far, by the order they became known.

    `seats (C, K)`, `state (n, K)`, `spread (n, n)` of the next frame itself, `column (C,)` which of the known ones sits where.
    """

    seats: Array
    state: Array
    spread: Array
    column: Array


@compiled
def planes_covariance(factor: Factor, dense: Array) -> Array:
    """Covariance (K, K) of the dense columns (theirs is `dense (G, G)`) and then the planes, last eliminated first."""
    count, seats, n = factor.felt.shape
    width, total = len(dense), len(dense) + factor.done[count]
    P = np.zeros((total, total))
    P[:width, :width] = dense
    later = _Later(np.zeros((seats, total)), np.zeros((n, total)), np.zeros((n, n)), np.zeros(seats, np.int64))
    later.seats[:width, :width], later.column[:width] = dense, np.arange(width)
    known = width
    for i in range(count - 1, -1, -1):
        for k in range(factor.done[i + 1] - 1, factor.done[i] - 1, -1):
            _plane(factor, factor.order[k], later, P, known)
            known += 1
        _frame(factor, i, later, known)
    return P


@compiled
def _plane(factor: Factor, plane: int, later: _Later, P: Array, known: int) -> None:
    """Row and column `known` of `P`, and the plane in its seat."""
    pivot, n, seat = factor.pivot[plane], len(later.spread), factor.seat[plane]
    by_seat, by_state = -factor.row[plane] / pivot, -factor.ahead[plane] / pivot
    mine, state = P[known], np.zeros(n)
    _weighted_sum(by_seat, later.seats, mine, known)
    _weighted_sum(by_state, later.state, mine, known)
    for k in range(n):
        for a in range(len(by_seat)):
            state[k] += by_seat[a] * later.state[k, later.column[a]]
        for r in range(n):
            state[k] += by_state[r] * later.spread[r, k]
    variance = 1.0 / pivot + np.dot(by_state, state)
    for a in range(len(by_seat)):
        variance += by_seat[a] * mine[later.column[a]]
    mine[known] = variance
    P[:known, known] = mine[:known]
    later.state[:, known] = state
    for a in range(len(by_seat)):
        later.seats[a, known] = mine[later.column[a]]
    later.seats[seat, : known + 1] = mine[: known + 1]
    later.column[seat] = known


@compiled
def _frame(factor: Factor, i: int, later: _Later, known: int) -> None:
    """The frame at hand in place of the next one."""
    n, felt, lower = len(later.spread), factor.felt[i], factor.lower[i]
    by_seat, by_state = -felt.T.copy(), -factor.link[i].T.copy()
    inverse = np.eye(n)
    for k in range(n):
        forward_block(lower, inverse[k])
        backward_block(lower, inverse[k])
    by_seat, by_state = _solved_transposed(lower, by_seat), _solved_transposed(lower, by_state)
    state, across = np.zeros((n, known)), by_state @ later.spread
    for k in range(n):
        _weighted_sum(by_seat[k], later.seats, state[k], known)
        _weighted_sum(by_state[k], later.state, state[k], known)
        for a in range(len(felt)):
            for r in range(n):
                across[k, r] += by_seat[k, a] * later.state[r, later.column[a]]
    spread = inverse + across @ by_state.T
    for k in range(n):
        for a in range(len(felt)):
            for r in range(n):
                spread[k, r] += state[k, later.column[a]] * by_seat[r, a]
    later.state[:, :known], later.spread[:] = state, spread


@compiled
def _solved_transposed(lower: Array, right: Array) -> Array:
    """`L^-T right`."""
    turned = right.T.copy()
    for k in range(len(turned)):
        backward_block(lower, turned[k])
    return turned.T.copy()


@compiled
def _weighted_sum(weight: Array, rows: Array, into: Array, known: int) -> None:
    """into[:known] += weight^T rows[:, :known]; empty seats weigh nothing."""
    for a in range(len(weight)):
        if weight[a] != 0.0:
            part, row = weight[a], rows[a]
            for q in range(known):
                into[q] += part * row[q]
