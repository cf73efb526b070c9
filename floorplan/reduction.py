"""Exact elimination of the trajectory: per axis the normal equations are a chain in `p` bordered by the planes.

With `T` the tridiagonal block of the frames, `B` their coupling to the border and `C` the border's own block, the
planes alone obey `S m = s` with `S = C - B^T T^-1 B`. The chain is cut into windows whose inner frames touch few
planes, then the frames between windows are eliminated: memory stays flat however long the scan is.
"""

from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from scipy import linalg, sparse

from floorplan.model.checks import Array
from floorplan.rows import AxisRows, AxisSolution, right_hand_side, sums_by

WINDOW_FRAMES = 64  # inner frames of a window see tens of planes, not all: 32 to 256 cost the same


@dataclass(frozen=True)
class Chain:
    """`T` as its diagonal (N,) and the band beside it (N-1,); frames that are not eliminated are held: identity rows."""

    diagonal: Array
    beside: Array

    def banded(self) -> Array:
        """Upper banded storage (2, N) of LAPACK."""
        return np.vstack((np.concatenate(([0.0], self.beside)), self.diagonal))

    def solve(self, right: Array) -> Array:
        """`T^-1 right` for `right (N, ...)`; LAPACK's tridiagonal solver does not take a single row."""
        if len(self.diagonal) == 1:
            return np.asarray(right / self.diagonal)
        return np.asarray(linalg.solveh_banded(self.banded(), right, check_finite=False))


@dataclass(frozen=True)
class ReducedAxis:
    """One axis with its trajectory eliminated; border = V planes, then the kept frames.

    `information (V + kept, V + kept)` is `S`; `kept (Q,)` frames that stay unknowns beside the planes.
    """

    rows: AxisRows
    kept: Array
    chain: Chain
    coupling: sparse.csr_array
    information: Array

    @cached_property
    def _chain_factor(self) -> Array:
        return np.asarray(linalg.cholesky_banded(self.chain.banded()))

    @cached_property
    def _information_factor(self) -> Any:
        return linalg.cho_factor(self.information, lower=True)

    def solve_border(self, right: Array) -> Array:
        """`S^-1 right` for `right (V + kept, ...)`."""
        return np.asarray(linalg.cho_solve(self._information_factor, right)) if len(right) else np.zeros_like(right)

    def solve(self, right: AxisSolution) -> AxisSolution:
        """The solution of the whole normal equations `A^T W A xi = right`, gauge p_0 = 0."""
        chain_right = right.position_m.copy()
        chain_right[0] = 0.0
        chain_right[self.kept] = 0.0
        border_right = np.concatenate((right.offset_m, right.position_m[self.kept]))
        inner = linalg.cho_solve_banded((self._chain_factor, False), chain_right)
        border = self.solve_border(border_right - self.coupling.T @ inner)
        return self._assemble(chain_right, border)

    def trajectory(self, border: Array) -> AxisSolution:
        """Least-squares positions of all frames for a given border (V + kept,), with the planes' offsets."""
        chain_right = right_hand_side(self.rows).position_m
        chain_right[self.kept] = 0.0
        return self._assemble(chain_right, border)

    def _assemble(self, chain_right: Array, border: Array) -> AxisSolution:
        position = linalg.cho_solve_banded((self._chain_factor, False), chain_right - self.coupling @ border)
        position[self.kept] = border[self.rows.planes :]
        return AxisSolution(np.asarray(position), border[: self.rows.planes])


def reduce_axis(rows: AxisRows, kept: Array | None = None) -> ReducedAxis:
    """Eliminate every frame of one axis except `kept` (rows of frames, never 0), exactly."""
    kept = np.zeros(0, dtype=np.int64) if kept is None else np.asarray(kept, dtype=np.int64)
    diagonal = sums_by(rows.frame, rows.weight, rows.frames)
    diagonal[1:] += rows.step_weight
    diagonal[:-1] += rows.step_weight
    coupling = sparse.coo_array((-rows.weight, (rows.frame, rows.plane)), shape=(rows.frames, rows.planes)).tocsr()
    corner = np.diag(sums_by(rows.plane, rows.weight, rows.planes))
    beside = -np.asarray(rows.step_weight)
    if len(kept):
        tridiagonal = sparse.diags_array((beside, diagonal, beside), offsets=(-1, 0, 1)).tocsc()[:, kept]
        seen = coupling[kept].toarray()
        corner = np.block([[corner, seen.T], [seen, tridiagonal.tocsr()[kept].toarray()]])
        coupling = sparse.csr_array(sparse.hstack((coupling, tridiagonal), format="csr"))
    held = np.concatenate(([0], kept))
    chain, coupling = _hold(Chain(diagonal, beside), coupling, held)
    return ReducedAxis(rows, kept, chain, coupling, _schur_complement(chain, coupling, corner))


def _hold(chain: Chain, coupling: sparse.csr_array, held: Array) -> tuple[Chain, sparse.csr_array]:
    """The chain and its coupling with the `held` frames taken out: identity on the diagonal, nothing beside it."""
    free = np.ones(len(chain.diagonal))
    free[held] = 0.0
    released = sparse.csr_array(sparse.diags_array(free) @ coupling)
    released.eliminate_zeros()
    return Chain(np.where(free > 0, chain.diagonal, 1.0), chain.beside * free[1:] * free[:-1]), released


def _schur_complement(chain: Chain, coupling: sparse.csr_array, corner: Array) -> Array:
    """`S = C - B^T T^-1 B`, window by window, then over the frames between windows."""
    count = len(chain.diagonal)
    between = np.arange(0, count, WINDOW_FRAMES)
    information = corner.copy()
    between_coupling = coupling[between].toarray()
    between_diagonal, between_beside = chain.diagonal[between].copy(), np.zeros(len(between) - 1)
    for k, first in enumerate(between):
        inner = slice(first + 1, min(first + WINDOW_FRAMES, count))
        if inner.start >= inner.stop:
            continue
        right = inner.stop < count
        planes, local = _dense_coupling(coupling, inner)
        ends = np.zeros((local.shape[0], 2))
        ends[0, 0] = chain.beside[first]
        ends[-1, 1] = chain.beside[inner.stop - 1] if right else 0.0
        inside = Chain(chain.diagonal[inner], chain.beside[inner.start : inner.stop - 1])
        solved = inside.solve(np.hstack((local, ends)))
        update = np.hstack((local, ends)).T @ solved
        information[np.ix_(planes, planes)] -= update[:-2, :-2]
        between_coupling[k, planes] -= update[-2, :-2]
        between_diagonal[k] -= update[-2, -2]
        if right:
            between_coupling[k + 1, planes] -= update[-1, :-2]
            between_diagonal[k + 1] -= update[-1, -1]
            between_beside[k] -= update[-1, -2]
    rest = Chain(between_diagonal, between_beside)
    information -= between_coupling.T @ rest.solve(between_coupling)
    return (information + information.T) / 2


def _dense_coupling(coupling: sparse.csr_array, inner: slice) -> tuple[Array, Array]:
    """The planes that the frames of a window touch, and their dense coupling (frames, planes)."""
    start, stop = coupling.indptr[inner.start], coupling.indptr[inner.stop]
    planes, column = np.unique(coupling.indices[start:stop], return_inverse=True)
    row = np.repeat(np.arange(inner.stop - inner.start), np.diff(coupling.indptr[inner.start : inner.stop + 1]))
    dense = np.zeros((inner.stop - inner.start, len(planes)))
    dense[row, column] = coupling.data[start:stop]
    return planes, dense
