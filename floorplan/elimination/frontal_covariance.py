"""Compiled joint covariance of all planes from a frontal factor: backwards in time, each from what comes after it.

Given everything later, a frame or plane is `R z + noise` of the open seats and the next frame, `z`; so its covariance with every
later plane is `R` times theirs (H. E. Rauch, F. Tung, C. T. Striebel, Maximum likelihood estimates of linear dynamic systems, 1965).
"""

from typing import NamedTuple

import numpy as np

from floorplan.compiled import compiled
from floorplan.elimination.block_kernels import forward_block
from floorplan.elimination.frontal_kernels import Factor
from floorplan.model.checks import Array


class _Later(NamedTuple):
    """Covariances of what comes after the frame at hand: the open seats (C,) and the next frame (n).

    `seats (C, K)` with the columns known so far, by the order they became known; `column (C,)` which of those sits where; `among (C, C)`
    of the seats. Of the next frame `felt (n, C)` with the seats and `spread (n, n)` its own. Its covariance with the known columns
    is needed only where a plane comes in: `by_seat seats + by_state state`, `state (n, K)` that of the frame where it was needed last.
    """

    seats: Array
    column: Array
    among: Array
    felt: Array
    spread: Array
    by_seat: Array
    by_state: Array
    state: Array


@compiled
def planes_covariance(factor: Factor, dense: Array) -> Array:
    """Covariance (K, K) of the dense columns (theirs is `dense (G, G)`) and then the planes, last eliminated first."""
    count, seats, n = factor.felt.shape
    width, total = len(dense), len(dense) + factor.done[count]
    P = np.zeros((total, total))
    P[:width, :width] = dense
    later = _Later(
        np.zeros((seats, total)), np.zeros(seats, np.int64), np.zeros((seats, seats)), np.zeros((n, seats)), np.zeros((n, n)),
        np.zeros((n, seats)), np.eye(n), np.zeros((n, total)),
    )  # fmt: skip
    later.seats[:width, :width], later.column[:width], later.among[:width, :width] = dense, np.arange(width), dense
    known = width
    for i in range(count - 1, -1, -1):
        if factor.done[i + 1] > factor.done[i]:
            _bring_up(later, known)
        for k in range(factor.done[i + 1] - 1, factor.done[i] - 1, -1):
            _plane(factor, factor.order[k], later, P, known)
            known += 1
        _frame(factor, i, later)
    return P


@compiled
def _bring_up(later: _Later, known: int) -> None:
    """`state` of the next frame itself."""
    state = np.zeros((len(later.spread), known))
    for k in range(len(state)):
        _weighted_sum(later.by_seat[k], later.seats, state[k], known)
        _weighted_sum(later.by_state[k], later.state, state[k], known)
    later.state[:, :known] = state
    later.by_seat[:], later.by_state[:] = 0.0, np.eye(len(state))


@compiled
def _plane(factor: Factor, plane: int, later: _Later, P: Array, known: int) -> None:
    """Row and column `known` of `P`, and the plane in its seat."""
    pivot, n, seat = factor.pivot[plane], len(later.spread), factor.seat[plane]
    by_seat, by_state = -factor.row[plane] / pivot, -factor.ahead[plane] / pivot
    mine = P[known]
    _weighted_sum(by_seat, later.seats, mine, known)
    _weighted_sum(by_state, later.state, mine, known)
    state = np.dot(later.felt, by_seat) + np.dot(later.spread, by_state)
    variance = 1.0 / pivot + np.dot(by_state, state)
    for a in range(len(by_seat)):
        variance += by_seat[a] * mine[later.column[a]]
    mine[known] = variance
    P[:known, known] = mine[:known]
    for k in range(n):
        later.state[k, known] = state[k]
        later.felt[k, seat] = state[k]
    for a in range(len(by_seat)):
        later.seats[a, known] = mine[later.column[a]]
    later.seats[seat, : known + 1] = mine[: known + 1]
    later.column[seat] = known
    for a in range(len(by_seat)):
        later.among[seat, a] = later.among[a, seat] = mine[later.column[a]]


@compiled
def _frame(factor: Factor, i: int, later: _Later) -> None:
    """The frame at hand in place of the next one."""
    n, seats = later.felt.shape
    lower, felt, link = factor.lower[i], factor.felt[i], factor.link[i]
    root, own = np.eye(n), np.zeros((n, n + seats))  # `own`: by the next frame's states, then by the seats
    for k in range(n):
        forward_block(lower, root[k])  # columns of L^-1
    for k in range(n):
        for r in range(k, n):
            part = root[k, r]
            for c in range(n):
                own[k, c] -= part * link[c, r]
            for a in range(seats):
                own[k, n + a] -= part * felt[a, r]
    across = np.zeros((n, n + seats))  # with the next frame's states and the seats
    _add_product(own[:, :n], later.spread, across[:, :n])
    _add_product(own[:, n:], later.felt.T, across[:, :n])
    _add_product(own[:, :n], later.felt, across[:, n:])
    _add_product(own[:, n:], later.among, across[:, n:])
    later.spread[:] = 0.0
    _add_product(root, root.T, later.spread)
    _add_product(across, own.T, later.spread)
    later.felt[:] = across[:, n:]
    by_seat, by_state = own[:, n:].copy(), np.zeros((n, n))
    _add_product(own[:, :n], later.by_seat, by_seat)
    _add_product(own[:, :n], later.by_state, by_state)
    later.by_seat[:], later.by_state[:] = by_seat, by_state


@compiled
def _add_product(left: Array, right: Array, into: Array) -> None:
    """into += left right, of small matrices."""
    for i in range(left.shape[0]):
        for k in range(left.shape[1]):
            part = left[i, k]
            if part != 0.0:
                for j in range(right.shape[1]):
                    into[i, j] += part * right[k, j]


@compiled
def _weighted_sum(weight: Array, rows: Array, into: Array, known: int) -> None:
    """into[:known] += weight^T rows[:, :known]; empty seats weigh nothing."""
    for a in range(len(weight)):
        if weight[a] != 0.0:
            part, row = weight[a], rows[a]
            for q in range(known):
                into[q] += part * row[q]
