"""Exact elimination of the trajectory: a block chain (the frames' states) joined to planes, reduced to the planes alone.

The normal equations of a scan are `[[T, B], [B^T, C]] [x, m] = [h, c]`: `T` block tridiagonal over the frames, `C` diagonal
over the planes, `B` sparse. Eliminating `x` leaves `S m = c - B^T T^-1 h` with `S = C - B^T T^-1 B`.
"""

from dataclasses import dataclass

import numpy as np
from scipy.linalg import cho_factor, cho_solve, cholesky, lapack, solve_triangular

from floorplan import chain_kernels
from floorplan.errors import NoSolutionError
from floorplan.model.checks import Array

ROUNDING = 1e-14  # a share below this part of a column's scale is rounding error of the reduced system


@dataclass(frozen=True)
class Rows:
    """Measurement rows of one chain, R rows sorted by frame: `m[column] - x[frame, component] = distance_m`.

    `weight (R,)` is 1 / sigma^2 (1 / m^2); a row of weight 0 is left out.
    """

    frame: Array
    component: Array
    column: Array
    distance_m: Array
    weight: Array


@dataclass(frozen=True)
class Chain:
    """Odometry part of the normal equations of N frames with n states each, and G columns that touch every frame.

    `diagonal (N, n, n)`; `coupling (N-1, n, n)` block of frame i + 1 against frame i; `rhs (N, n)`; `dense (N, n, G)`,
    `dense_information (G, G)`, `dense_rhs (G,)`; `square_sum` the rows' weighted squared right-hand sides;
    `log_weight` sum of the log weights of the odometry rows; the first `pinned` states of frame 0 are zero (the gauge).
    """

    diagonal: Array
    coupling: Array
    rhs: Array
    dense: Array
    dense_information: Array
    dense_rhs: Array
    square_sum: float
    log_weight: float
    pinned: int


@dataclass(frozen=True)
class Factored:
    """Block Cholesky of a chain with its measurement rows: what back-substitution needs."""

    chain: Chain
    rows: Rows
    lower: Array
    link: Array
    rhs: Array
    log_det: float


@dataclass(frozen=True)
class Reduced:
    """The small system in the planes (then the dense columns): `information (M+G, M+G)`, `rhs (M+G,)`.

    `constant` is the least squares value left when the quadratic form is completed: the cost of a solution m is
    `m^T S m - 2 m^T rhs + constant`. `log_weight` and `log_det` are those of all rows and of the chain.
    """

    factored: Factored
    planes: int
    information: Array
    rhs: Array
    constant: float
    log_weight: float


def eliminate(chain: Chain, rows: Rows, planes: int, forgotten: float = ROUNDING) -> Reduced:
    """Reduce the chain and its rows to `planes` columns. Raises NoSolutionError where the chain is singular.

    A column's share in a frame below `forgotten` of its own scale is dropped.
    """
    rows = _usable(rows)
    diagonal, rhs = chain.diagonal.copy(), chain.rhs.copy()
    free = ~((rows.frame == 0) & (rows.component < chain.pinned))
    held = Rows(*(values[free] for values in (rows.frame, rows.component, rows.column, rows.distance_m, rows.weight)))
    np.add.at(diagonal, (held.frame, held.component, held.component), held.weight)
    np.add.at(rhs, (held.frame, held.component), -held.weight * held.distance_m)
    factored = _factor(chain, held, diagonal, rhs)
    information, reduced_rhs = _column_part(chain, rows, planes)
    quadratic = chain_kernels.reduce_columns(
        factored.lower, factored.link, rhs, chain.dense, _row_starts(held.frame, len(rhs)), held.component, held.column,
        held.weight, _last_frame(held, planes), np.sqrt(np.diag(information)[:planes]), information, reduced_rhs, forgotten,
    )
    information = information + information.T  # the kernel fills one of the two entries of a pair, either one
    information[np.diag_indices_from(information)] /= 2
    square_sum = chain.square_sum + float(rows.weight @ rows.distance_m**2)
    log_weight = chain.log_weight + float(np.log(rows.weight).sum())
    return Reduced(factored, planes, information, reduced_rhs, square_sum - quadratic, log_weight)


def solve_planes(reduced: Reduced) -> tuple[Array, Array]:
    """Least squares values (M+G,) of the columns and their covariance (M+G, M+G)."""
    factor = cho_factor(reduced.information, lower=True, check_finite=False)
    return cho_solve(factor, reduced.rhs, check_finite=False), inverse_from_cholesky(factor[0])


def solve_offsets(reduced: Reduced) -> Array:
    """Least squares values (M+G,) of the columns alone."""
    return np.asarray(cho_solve(cho_factor(reduced.information, lower=True, check_finite=False), reduced.rhs, check_finite=False))


def inverse_from_cholesky(lower: Array) -> Array:
    """Symmetric inverse from a lower Cholesky factor."""
    inverse, status = lapack.dpotri(lower, lower=1)
    if status != 0:
        raise NoSolutionError("The reduced system is singular: some tracks have no usable measurement.")
    strict = np.tril(inverse, -1)
    return np.asarray(np.tril(inverse) + strict.T)


def back_substitute(reduced: Reduced, columns: Array) -> Array:
    """States (N, n) of every frame, given the values of planes and dense columns."""
    factored = reduced.factored
    rows, rhs = factored.rows, factored.rhs.copy()
    np.add.at(rhs, (rows.frame, rows.component), rows.weight * columns[rows.column])
    rhs -= factored.chain.dense @ columns[reduced.planes :]
    chain_kernels.solve_chain(factored.lower, factored.link, rhs)
    return rhs


def log_marginal_likelihood(reduced: Reduced) -> float:
    """Log density of all rows with states and planes integrated out (flat prior on the planes), less a constant."""
    factor = cholesky(reduced.information, lower=True, check_finite=False)
    solved = solve_triangular(factor, reduced.rhs, lower=True, check_finite=False)
    cost = reduced.constant - float(solved @ solved)
    log_det = reduced.factored.log_det + 2 * float(np.log(np.diag(factor)).sum())
    return 0.5 * (reduced.log_weight - log_det - cost)


def state_covariance(reduced: Reduced, column_covariance: Array, frame: int) -> Array:
    """Marginal covariance (n, n) of one frame's states."""
    factored = reduced.factored
    rows, (count, n) = factored.rows, factored.rhs.shape
    result, felt = np.empty((n, n)), np.empty((n, len(column_covariance)))
    for k in range(n):
        unit = np.zeros((count, n))
        unit[frame, k] = 1.0
        chain_kernels.solve_chain(factored.lower, factored.link, unit)
        result[k] = unit[frame]
        felt[k] = np.bincount(rows.column, -rows.weight * unit[rows.frame, rows.component], len(column_covariance))
        felt[k, reduced.planes :] += np.einsum("ik,ikg->g", unit, factored.chain.dense)
    return np.asarray(result + felt @ column_covariance @ felt.T)


def _usable(rows: Rows) -> Rows:
    order = np.argsort(rows.frame, kind="stable")
    order = order[rows.weight[order] > 0]
    fields = (rows.frame, rows.component, rows.column, rows.distance_m, rows.weight)
    return Rows(*(np.ascontiguousarray(values[order]) for values in fields))


def _factor(chain: Chain, rows: Rows, diagonal: Array, rhs: Array) -> Factored:
    lower, link = np.zeros_like(diagonal), np.zeros_like(diagonal)
    log_det = chain_kernels.factor_chain(diagonal, chain.coupling, lower, link)
    if not np.isfinite(log_det):
        raise NoSolutionError("The trajectory's normal equations are singular: check the odometry rows for zeros or NaN.")
    return Factored(chain, rows, lower, link, rhs, log_det)


def _column_part(chain: Chain, rows: Rows, planes: int) -> tuple[Array, Array]:
    total = planes + chain.dense.shape[2]
    information, rhs = np.zeros((total, total)), np.zeros(total)
    on_diagonal = np.arange(planes)
    information[on_diagonal, on_diagonal] = np.bincount(rows.column, rows.weight, planes)
    rhs[:planes] = np.bincount(rows.column, rows.weight * rows.distance_m, planes)
    information[planes:, planes:] = chain.dense_information
    rhs[planes:] = chain.dense_rhs
    return information, rhs


def _row_starts(frame: Array, frames: int) -> Array:
    return np.searchsorted(frame, np.arange(frames + 1))


def _last_frame(rows: Rows, planes: int) -> Array:
    last = np.full(planes, -1)
    np.maximum.at(last, rows.column, rows.frame)
    return last
