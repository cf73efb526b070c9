"""Compiled elimination of frames and planes in the order of time; see `floorplan.elimination.frontal`."""

from typing import NamedTuple

import numpy as np

from floorplan.compiled import compiled
from floorplan.elimination.block_kernels import backward_block, factor_block, forward_block
from floorplan.model.checks import Array

NOBODY = -1  # in a seat


class FrameRows(NamedTuple):
    """Measurement rows sorted by frame, those of frame i at `start[i]:start[i + 1]`; `last (M,)` frame of every plane."""

    start: Array
    component: Array
    column: Array
    weight: Array
    last: Array


class Front(NamedTuple):
    """Normal equations of what is open: dense columns and planes by seat (C,), and the frame at hand (n states).

    `inner (C, C)`, its lower triangle; `beside (C, n)` against the frame; `state (n, n)`; `column (C,)` who sits where;
    `seat (M + G,)` the seat of a column, or NOBODY.
    """

    inner: Array
    beside: Array
    state: Array
    column: Array
    seat: Array


class Factor(NamedTuple):
    """What solving needs. Frames: `lower (N, n, n)`, `link (N, n, n)` to the next, `felt (N, C, n)` by the seats.

    Planes by column: `pivot (M,)`, `row (M, C)` against the seats, `ahead (M, n)` against the next frame, `seat (M,)`;
    `order (M,)` as they were eliminated, the first `done[i + 1]` of them by frame i.
    """

    lower: Array
    link: Array
    felt: Array
    pivot: Array
    row: Array
    ahead: Array
    seat: Array
    order: Array
    done: Array


@compiled
def empty_front(seats: int, states: int, planes: int, information: Array) -> Front:
    """Nothing but the dense columns, whose own matrix is `information (G, G)`, in the first seats."""
    width = len(information)
    column, seat, inner = np.full(seats, NOBODY), np.full(planes + width, NOBODY), np.zeros((seats, seats))
    for g in range(width):
        column[g], seat[planes + g] = planes + g, g
    inner[:width, :width] = information
    return Front(inner, np.zeros((seats, states)), np.zeros((states, states)), column, seat)


@compiled
def empty_factor(frames: int, states: int, seats: int, planes: int) -> Factor:
    """A factor to be filled by `eliminate`."""
    return Factor(
        np.zeros((frames, states, states)), np.zeros((frames, states, states)), np.zeros((frames, seats, states)), np.ones(planes),
        np.zeros((planes, seats)), np.zeros((planes, states)), np.full(planes, NOBODY), np.full(planes, NOBODY),
        np.zeros(frames + 1, np.int64),
    )  # fmt: skip


@compiled
def eliminate(front: Front, factor: Factor, rows: FrameRows, diagonal: Array, coupling: Array, dense: Array, pinned: int) -> float:
    """Eliminate all frames and planes; the dense columns, which sit in the first seats, stay. Gives back log det, NaN if singular."""
    count, width, nothing = len(diagonal), dense.shape[2], np.zeros_like(front.state)
    log_det, eliminated = 0.0, 0
    for i in range(count):
        front.state[:] += diagonal[i]
        for g in range(width):
            front.beside[g] += dense[i, :, g]
        _enter(front, rows, i, pinned)
        top = _taken(front)
        log_det += _eliminate_frame(front, factor, i, coupling[i] if i < count - 1 else nothing, top)
        for seat in range(width, top):
            plane = front.column[seat]
            if plane != NOBODY and rows.last[plane] == i:
                log_det += _eliminate_plane(front, factor, plane, top)
                factor.order[eliminated] = plane
                eliminated += 1
        factor.done[i + 1] = eliminated
    return log_det


@compiled
def _enter(front: Front, rows: FrameRows, i: int, pinned: int) -> None:
    """Add the measurement rows of frame i; planes seen for the first time take the lowest free seat."""
    for r in range(rows.start[i], rows.start[i + 1]):
        column, weight, k = rows.column[r], rows.weight[r], rows.component[r]
        if front.seat[column] == NOBODY:
            free = 0
            while front.column[free] != NOBODY:
                free += 1
            front.column[free], front.seat[column] = column, free
        seat = front.seat[column]
        front.inner[seat, seat] += weight
        if i > 0 or k >= pinned:
            front.beside[seat, k] -= weight
            front.state[k, k] += weight


@compiled
def _taken(front: Front) -> int:
    """One more than the highest seat taken."""
    top = len(front.column)
    while top > 0 and front.column[top - 1] == NOBODY:
        top -= 1
    return top


@compiled
def _eliminate_frame(front: Front, factor: Factor, i: int, coupling: Array, top: int) -> float:
    """Eliminate the states of frame i and open the next frame (`coupling (n, n)`); gives back log det of the pivots."""
    n = len(front.state)
    lower, link, felt = factor.lower[i], factor.link[i], factor.felt[i]
    log_det = factor_block(front.state, lower)
    for k in range(n):
        link[k] = coupling[k]
        forward_block(lower, link[k])
    for a in range(top):
        felt[a] = front.beside[a]
        forward_block(lower, felt[a])
        for b in range(a + 1):
            for k in range(n):
                front.inner[a, b] -= felt[a, k] * felt[b, k]
        for r in range(n):
            front.beside[a, r] = 0.0
            for k in range(n):
                front.beside[a, r] -= felt[a, k] * link[r, k]
    for r in range(n):
        for c in range(n):
            front.state[r, c] = 0.0
            for k in range(n):
                front.state[r, c] -= link[r, k] * link[c, k]
    return log_det


@compiled
def _eliminate_plane(front: Front, factor: Factor, plane: int, top: int) -> float:
    """Eliminate a plane that no later frame sees; gives back the log of its pivot."""
    seat, n = front.seat[plane], len(front.state)
    row, ahead, pivot = factor.row[plane], factor.ahead[plane], front.inner[seat, seat]
    for a in range(top):
        row[a] = front.inner[max(a, seat), min(a, seat)]
        front.inner[max(a, seat), min(a, seat)] = 0.0
    row[seat] = 0.0
    ahead[:] = front.beside[seat]
    front.beside[seat] = 0.0
    factor.pivot[plane], factor.seat[plane] = pivot, seat
    front.column[seat], front.seat[plane] = NOBODY, NOBODY
    for a in range(top):
        share = row[a] / pivot
        if share != 0.0:
            for b in range(a + 1):
                front.inner[a, b] -= share * row[b]
            for k in range(n):
                front.beside[a, k] -= share * ahead[k]
    for k in range(n):
        for c in range(n):
            front.state[k, c] -= ahead[k] * ahead[c] / pivot
    return np.log(pivot) if pivot > 0.0 else np.nan


@compiled
def substitute_forward(factor: Factor, frames: Array, planes: Array, seats: Array) -> float:
    """Right-hand sides of `frames (N, n)` and `planes (M,)` on their way down, in place; those of the dense columns in `seats (C,)`.

    Gives back the square of what was eliminated, `h^T T^-1 h`.
    """
    count, n = frames.shape
    square = 0.0
    for i in range(count):
        mine = frames[i]
        forward_block(factor.lower[i], mine)
        square += np.dot(mine, mine)
        for a in range(len(seats)):
            for k in range(n):
                seats[a] -= factor.felt[i, a, k] * mine[k]
        if i < count - 1:
            frames[i + 1] -= np.dot(factor.link[i], mine)
        for k in range(factor.done[i], factor.done[i + 1]):
            plane = factor.order[k]
            seat, pivot = factor.seat[plane], factor.pivot[plane]
            planes[plane] += seats[seat]
            seats[seat] = 0.0
            share = planes[plane] / pivot
            square += share * planes[plane]
            for a in range(len(seats)):
                seats[a] -= factor.row[plane, a] * share
            if i < count - 1:
                frames[i + 1] -= factor.ahead[plane] * share
    return square


@compiled
def substitute_back(factor: Factor, frames: Array, planes: Array, seats: Array) -> None:
    """The solution in place of what `substitute_forward` left; `seats (C,)` begins with the dense columns' values."""
    count, n = frames.shape
    after = np.zeros(n)
    for i in range(count - 1, -1, -1):
        for k in range(factor.done[i + 1] - 1, factor.done[i] - 1, -1):
            plane = factor.order[k]
            planes[plane] -= np.dot(factor.row[plane], seats) + np.dot(factor.ahead[plane], after)
            planes[plane] /= factor.pivot[plane]
            seats[factor.seat[plane]] = planes[plane]
        mine = frames[i]
        for k in range(n):
            for a in range(len(seats)):
                mine[k] -= factor.felt[i, a, k] * seats[a]
            for r in range(n):
                mine[k] -= factor.link[i, r, k] * after[r]
        backward_block(factor.lower[i], mine)
        after = mine


@compiled
def reduced_out(
    rows: FrameRows, most_open: int, diagonal: Array, coupling: Array, dense: Array, information: Array, pinned: int, frames: Array,
    planes: Array, wide: Array,
) -> tuple[float, float]:
    """log det and `h^T T^-1 h` of a whole chain, dense columns included.

    Right-hand sides as for `substitute_forward`; `wide (G,)` those of the dense columns.
    """
    (count, states), width, seen = frames.shape, len(information), len(planes)
    seats = width + most_open
    front, factor = empty_front(seats, states, seen, information), empty_factor(count, states, seats, seen)
    log_det = eliminate(front, factor, rows, diagonal, coupling, dense, pinned)
    right, lower = np.zeros(seats), np.zeros((width, width))
    right[:width] = wide
    square = substitute_forward(factor, frames, planes, right)
    log_det += factor_block(front.inner[:width, :width], lower)
    forward_block(lower, right[:width])
    return log_det, square + np.dot(right[:width], right[:width])
