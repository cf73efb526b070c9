"""Exact least squares of a block chain (the frames' states) with planes, in one walk along it.

The normal equations of a scan are `[[T, B], [B^T, C]] [x, m] = [h, c]`: `T` block tridiagonal over the frames, `C` diagonal over the
planes, `B` sparse. Frames are eliminated in order; a plane enters with its first row and is eliminated after its last (frontal
elimination: B. M. Irons, A frontal solution program for finite element analysis, 1970). So work grows with the walk and with what is
open at one time, however many planes there are; the joint covariance of all planes is one more walk, backwards.
"""

from dataclasses import dataclass

import numpy as np

from floorplan.elimination.chain import Chain, Rows
from floorplan.elimination.frontal_covariance import planes_covariance
from floorplan.elimination.frontal_kernels import (
    NOBODY,
    Factor,
    FrameRows,
    eliminate,
    empty_factor,
    empty_front,
    reduced_out,
    substitute_back,
    substitute_forward,
)
from floorplan.errors import NoSolutionError
from floorplan.model.checks import Array


@dataclass(frozen=True)
class Eliminated:
    """A chain with its rows and M planes, factored: all but the G dense columns, whose own matrix is `information (G, G)`.

    Right-hand sides: `frame_rhs (N, n)`, `column_rhs (M + G,)`. `log_det` of the factor; `square_sum` of the weighted right-hand
    sides of the rows and `log_weight`, the sum of their log weights.
    """

    factor: Factor
    information: Array
    frame_rhs: Array
    column_rhs: Array
    log_det: float
    square_sum: float
    log_weight: float


@dataclass(frozen=True)
class Solved:
    """Least squares values: `column (M,)` of the planes, 0 where a plane has no row; `state (N, n)` of the frames."""

    column: Array
    state: Array


@dataclass(frozen=True)
class Arranged:
    """Measurement rows by frame, and what of an elimination they alone settle.

    `most_open` planes at one frame; right-hand sides `frame_pull (N, n)`, `column_pull (M,)`; `square_sum` and `log_weight` of the rows.
    """

    rows: FrameRows
    most_open: int
    frame_pull: Array
    column_pull: Array
    square_sum: float
    log_weight: float


def arrange(rows: Rows, shape: tuple[int, int], planes: int, pinned: int) -> Arranged:
    """The rows of `planes` columns for a chain of `shape` (N, n) with `pinned` states of frame 0; those of weight 0 are left out."""
    rows, (frames, states) = _usable(rows), shape
    pulled = rows.weight * rows.distance_m
    free = (rows.frame > 0) | (rows.component >= pinned)
    cell = rows.frame[free] * states + rows.component[free]
    frame_pull = np.bincount(cell, -pulled[free], frames * states).astype(np.float64).reshape(frames, states)
    return Arranged(
        _rows_of_frames(rows, frames, planes),
        _most_open(rows, frames, planes),
        frame_pull,
        np.bincount(rows.column, pulled, planes).astype(np.float64),
        float(pulled @ rows.distance_m),
        float(np.log(rows.weight).sum()),
    )


def eliminate_in_order(chain: Chain, arranged: Arranged) -> Eliminated:
    """Factor the chain with the rows. Raises NoSolutionError where they are singular."""
    frames, states, width = chain.dense.shape
    planes = len(arranged.column_pull)
    seats = width + arranged.most_open
    front, factor = empty_front(seats, states, planes, chain.dense_information), empty_factor(frames, states, seats, planes)
    log_det = eliminate(front, factor, arranged.rows, chain.diagonal, chain.coupling, chain.dense, chain.pinned)
    if not np.isfinite(log_det):
        raise NoSolutionError("The trajectory's normal equations are singular: check the odometry rows for zeros or NaN.")
    information = np.tril(front.inner[:width, :width])
    return Eliminated(
        factor,
        information + np.tril(information, -1).T,
        chain.rhs + arranged.frame_pull,
        np.concatenate([arranged.column_pull, chain.dense_rhs]),
        log_det,
        chain.square_sum + arranged.square_sum,
        chain.log_weight + arranged.log_weight,
    )


def least_squares(eliminated: Eliminated, pull: Array | None = None) -> Solved:
    """The solution; `pull (M,)` is a further right-hand side of the planes."""
    width, column = len(eliminated.information), eliminated.column_rhs.copy()
    if pull is not None:
        column[: len(pull)] += pull
    planes, frames, seats = column[: len(column) - width], eliminated.frame_rhs.copy(), _seats(eliminated, column)
    substitute_forward(eliminated.factor, frames, planes, seats)
    seats[:width] = np.linalg.solve(eliminated.information, seats[:width])
    substitute_back(eliminated.factor, frames, planes, seats)
    return Solved(planes, frames)


def log_marginal_likelihood(eliminated: Eliminated) -> float:
    """Log density of all rows with states and planes integrated out (flat prior on the planes), less a constant (E5)."""
    width, column = len(eliminated.information), eliminated.column_rhs.copy()
    seats = _seats(eliminated, column)
    square = substitute_forward(eliminated.factor, eliminated.frame_rhs.copy(), column[: len(column) - width], seats)
    square += float(seats[:width] @ np.linalg.solve(eliminated.information, seats[:width]))
    log_det = eliminated.log_det + float(np.linalg.slogdet(eliminated.information)[1])
    return 0.5 * (eliminated.log_weight - log_det - (eliminated.square_sum - square))


def log_marginal_likelihood_of(chain: Chain, arranged: Arranged, factor: float) -> float:
    """The same of a chain with every measurement's sigma times `factor`, without a factorisation to keep; NaN where singular."""
    share = factor**-2
    rows = arranged.rows._replace(weight=arranged.rows.weight * share)
    log_det, square = reduced_out(
        rows, arranged.most_open, chain.diagonal, chain.coupling, chain.dense, chain.dense_information, chain.pinned,
        chain.rhs + share * arranged.frame_pull, share * arranged.column_pull, chain.dense_rhs,
    )  # fmt: skip
    log_weight = chain.log_weight + arranged.log_weight + len(rows.weight) * float(np.log(share))
    return 0.5 * (log_weight - log_det - (chain.square_sum + share * arranged.square_sum - square))


def joint_covariance(eliminated: Eliminated) -> Array:
    """Covariance (M, M) of the planes; infinite variance for one without rows."""
    factor, width = eliminated.factor, len(eliminated.information)
    known = factor.order[: factor.done[-1]][::-1]
    found = planes_covariance(factor, np.linalg.inv(eliminated.information))[width:, width:]
    covariance = np.zeros((len(factor.pivot),) * 2)
    covariance[np.ix_(known, known)] = found
    unknown = np.setdiff1d(np.arange(len(covariance)), known)
    covariance[unknown, unknown] = np.inf
    return covariance


def _usable(rows: Rows) -> Rows:
    """The rows of positive weight, sorted by frame."""
    order = np.argsort(rows.frame, kind="stable")
    order = order[rows.weight[order] > 0]
    fields = (rows.frame, rows.component, rows.column, rows.distance_m, rows.weight)
    return Rows(*(np.ascontiguousarray(values[order]) for values in fields))


def _seats(eliminated: Eliminated, column: Array) -> Array:
    """Right-hand sides by seat, before the walk: those of the dense columns."""
    width, seats = len(eliminated.information), np.zeros(eliminated.factor.felt.shape[1])
    seats[:width] = column[len(column) - width :]
    return seats


def _rows_of_frames(rows: Rows, frames: int, planes: int) -> FrameRows:
    last = np.full(planes, NOBODY)
    last[rows.column] = rows.frame  # sorted by frame: the last one stays
    return FrameRows(np.searchsorted(rows.frame, np.arange(frames + 1)), rows.component, rows.column, rows.weight, last)


def _most_open(rows: Rows, frames: int, planes: int) -> int:
    """The largest number of planes between their first row and their last at one frame."""
    first, last = np.full(planes, frames), np.full(planes, -1)
    first[rows.column[::-1]] = rows.frame[::-1]
    last[rows.column] = rows.frame
    seen = last >= 0
    change = np.bincount(first[seen], minlength=frames + 2) - np.bincount(last[seen] + 1, minlength=frames + 2)
    return int(np.cumsum(change).max(initial=0))
