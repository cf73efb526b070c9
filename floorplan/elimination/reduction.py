"""Exact elimination of the trajectory: per axis the normal equations are a chain in `p` bordered by the planes.

With `T` the tridiagonal block of the frames, `B` their coupling to the border and `C` the border's own block, the
planes alone obey `S m = s` with `S = C - B^T T^-1 B`. Frames are eliminated in order and only planes that the frame at hand
still feels take part, so that work and memory stay local however long the scan is.
"""

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from scipy.linalg import lapack

from floorplan.elimination.reduction_kernel import subtract_chain
from floorplan.errors import NoSolutionError
from floorplan.model.checks import Array
from floorplan.rows import AxisRows, AxisSolution, right_hand_side, sums_by


@dataclass(frozen=True)
class Chain:
    """`T = L diag(pivot) L^T`: `pivot (N,)` and `multiplier (N-1,)`; held frames are identity rows."""

    pivot: Array
    multiplier: Array

    def solve(self, right: Array) -> Array:
        """`T^-1 right` for `right (N,)`."""
        if len(self.pivot) == 1:  # LAPACK's wrapper does not take a chain without links
            return np.asarray(right / self.pivot)
        return np.asarray(lapack.dpttrs(self.pivot, self.multiplier, right)[0])


@dataclass(frozen=True)
class Coupling:
    """`B` by entries sorted by frame: `frame (E,)`, `column (E,)`, `value (E,)`."""

    frame: Array
    column: Array
    value: Array

    def to_frames(self, border: Array, frames: int) -> Array:
        """`B border` (N,)."""
        return sums_by(self.frame, self.value * border[self.column], frames)

    def to_border(self, positions: Array, columns: int) -> Array:
        """`B^T positions` (columns,)."""
        return sums_by(self.column, self.value * positions[self.frame], columns)


@dataclass(frozen=True)
class ReducedAxis:
    """One axis with its trajectory eliminated; border = V planes, then the kept frames.

    `information (V + Q, V + Q)` is `S`; `kept (Q,)` frames that stay unknowns beside the planes.
    """

    rows: AxisRows
    kept: Array
    chain: Chain
    coupling: Coupling
    information: Array

    @cached_property
    def factor(self) -> Array:
        """Cholesky factor of `S`. Raises NoSolutionError where it is singular."""
        try:
            return cholesky(self.information)
        except np.linalg.LinAlgError as error:
            raise NoSolutionError(f"the planes are not determined ({error}): look for tracks without usable measurements") from error

    def solve_border(self, right: Array) -> Array:
        """`S^-1 right` for `right (V + Q,)` or (V + Q, R)."""
        return cholesky_solve(self.factor, right)

    def covariance(self) -> Array:
        """`S^-1` (V + Q, V + Q)."""
        return self.solve_border(np.eye(len(self.information)))

    def solve(self, right: AxisSolution) -> AxisSolution:
        """The solution of the whole normal equations `A^T W A xi = right`, gauge p_0 = 0."""
        chain_right = self._free(right.position_m)
        border_right = np.concatenate((right.offset_m, right.position_m[self.kept]))
        inner = self.chain.solve(chain_right)
        border = self.solve_border(border_right - self.coupling.to_border(inner, len(border_right)))
        return self._assemble(chain_right, border)

    def trajectory(self, border: Array) -> AxisSolution:
        """Least-squares positions of all frames for a given border (V + Q,), with the planes' offsets."""
        return self._assemble(self._free(right_hand_side(self.rows).position_m), border)

    def _free(self, positions: Array) -> Array:
        """`positions` with those of held frames set to 0."""
        free = positions.copy()
        free[0] = 0.0
        free[self.kept] = 0.0
        return free

    def _assemble(self, chain_right: Array, border: Array) -> AxisSolution:
        position = self.chain.solve(chain_right - self.coupling.to_frames(border, self.rows.frames))
        position[self.kept] = border[self.rows.planes :]
        return AxisSolution(position, border[: self.rows.planes])


def reduce_axis(rows: AxisRows, kept: Array | None = None) -> ReducedAxis:
    """Eliminate every frame of one axis except `kept` (frames, never 0), exactly."""
    kept = np.zeros(0, dtype=np.int64) if kept is None else np.asarray(kept, dtype=np.int64)
    held = np.zeros(rows.frames, dtype=bool)
    held[0] = True
    held[kept] = True
    diagonal = sums_by(rows.frame, rows.weight, rows.frames)
    diagonal[1:] += rows.step_weight
    diagonal[:-1] += rows.step_weight
    corner = _corner(rows, kept, diagonal)
    chain = _factored_chain(np.where(held, 1.0, diagonal), np.where(held[1:] | held[:-1], 0.0, -rows.step_weight))
    coupling = _coupling(rows, kept, held)
    _subtract(chain, coupling, corner)
    return ReducedAxis(rows, kept, chain, coupling, corner)


def cholesky(matrix: Array, overwrite: bool = False) -> Array:
    """Cholesky factor of a symmetric matrix given by its lower triangle, for `cholesky_solve`.

    Raises numpy's LinAlgError where it is not positive definite. `overwrite` lets the factor take the matrix' place.
    """
    if not len(matrix):
        return matrix
    # LAPACK counts by columns: the transpose of a row-ordered matrix is the same memory, so its upper triangle is factored.
    factor, info = lapack.dpotrf(matrix.T, lower=0, clean=0, overwrite_a=overwrite)
    if info != 0:
        raise np.linalg.LinAlgError(f"not positive definite at pivot {info}")
    return np.asarray(factor)


def cholesky_solve(factor: Array, right: Array) -> Array:
    """The solution for a factor of `cholesky`."""
    return np.asarray(lapack.dpotrs(factor, right, lower=0)[0]) if len(factor) else np.zeros_like(right)


def _factored_chain(diagonal: Array, beside: Array) -> Chain:
    if len(diagonal) == 1:
        return Chain(diagonal, beside)
    pivot, multiplier, info = lapack.dpttrf(diagonal, beside)
    if info != 0:
        raise NoSolutionError(f"the trajectory's normal equations are singular at frame {info - 1}: look for odometry rows of weight 0")
    return Chain(pivot, multiplier)


def _corner(rows: AxisRows, kept: Array, diagonal: Array) -> Array:
    """`C`: the border's own block of the normal equations."""
    size, planes = rows.planes + len(kept), rows.planes
    corner = np.zeros((size, size))
    corner[np.arange(planes), np.arange(planes)] = sums_by(rows.plane, rows.weight, planes)
    for column, frame in enumerate(kept, start=planes):
        seen = rows.frame == frame
        coupled = -sums_by(rows.plane[seen], rows.weight[seen], planes)
        corner[column, :planes], corner[:planes, column] = coupled, coupled
        corner[column, column] = diagonal[frame]
        for other in np.flatnonzero(kept == frame + 1) + planes:
            corner[column, other] = corner[other, column] = -rows.step_weight[frame]
    return corner


def _coupling(rows: AxisRows, kept: Array, held: Array) -> Coupling:
    """`B`: measurements of free frames, and the odometry rows between free and kept ones."""
    frame, column, value = rows.frame, rows.plane, -np.asarray(rows.weight)
    if len(kept):
        to_kept = rows.planes + np.arange(len(kept))
        after = kept < rows.frames - 1
        frame = np.concatenate((frame, kept - 1, kept[after] + 1))
        column = np.concatenate((column, to_kept, to_kept[after]))
        value = np.concatenate((value, -rows.step_weight[kept - 1], -rows.step_weight[kept[after]]))
    free = ~held[frame]
    frame, column, value = frame[free], column[free], value[free]
    order = np.argsort(frame, kind="stable")
    return Coupling(frame[order], column[order], value[order])


def _subtract(chain: Chain, coupling: Coupling, corner: Array) -> None:
    """`C - B^T T^-1 B` in place."""
    last = np.full(len(corner), -1)
    last[coupling.column] = coupling.frame  # sorted by frame: the last one stays
    scale = np.sqrt(np.diag(corner))
    start = np.searchsorted(coupling.frame, np.arange(len(chain.pivot) + 1))
    subtract_chain(chain.pivot, chain.multiplier, start, coupling.column, coupling.value, last, scale, corner)
