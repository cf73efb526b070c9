"""A laying made exact: the shift at which the common wall faces lie on each other, and how well they then do."""

from dataclasses import dataclass

import numpy as np

from floorplan.model.checks import Array
from floorplan.model.normal import MAD_TO_SIGMA
from floorplan.several.survey import Laying, Survey, laid

CLOSE_M = 0.25  # faces further apart than a grid cell and the drift left in two solved scans are not one
AGREE_M = 0.08  # of one wall: what is left of two scans' drift; half the thinnest wall, whose faces look opposite ways anyway
MIN_OVERLAP_M = 0.3  # along the wall
ROUNDS = 5
SIGMA_FLOOR_M = 0.05  # two solved scans are not stiffer than this against each other


@dataclass(frozen=True)
class Agreement:
    """Of the faces normal to one axis: metres of wall that agree, distinct walls they are of, sigma of the shift along the axis."""

    wall_m: float
    walls: int
    sigma_m: float


@dataclass(frozen=True)
class Refined:
    """The laying and what agrees along x and along y."""

    laying: Laying
    x: Agreement
    y: Agreement

    @property
    def sigma_m(self) -> float:
        """Of the shift, the larger of both axes: each floor-plan axis may become either world axis."""
        return max(self.x.sigma_m, self.y.sigma_m)


@dataclass(frozen=True)
class _Pairs:
    """Faces that may be one: `difference_m (H,)` base less other, `overlap_m (H,)`, `offset_m (H,)` of the base."""

    difference_m: Array
    overlap_m: Array
    offset_m: Array


def refined(base: Survey, other: Survey, laying: Laying) -> Refined:
    """`laying` shifted so that most of the common wall agrees."""
    placed = laid(other, laying)
    pairs = [_pairs(base, placed, axis) for axis in (0, 1)]
    moves = np.array([_mode(pair) for pair in pairs])
    x, y = (_agreement(pair, move) for pair, move in zip(pairs, moves, strict=True))
    return Refined(Laying(laying.quarters, laying.shift_m + moves), x, y)


def _pairs(base: Survey, other: Survey, axis: int) -> _Pairs:
    a, b = np.flatnonzero(base.axis == axis), np.flatnonzero(other.axis == axis)
    difference = base.offset_m[a][:, None] - other.offset_m[b][None]
    low = np.maximum(base.reach_m[a, 0][:, None], other.reach_m[b, 0][None])
    high = np.minimum(base.reach_m[a, 1][:, None], other.reach_m[b, 1][None])
    same = (base.facing[a][:, None] == other.facing[b][None]) & (np.abs(difference) < CLOSE_M) & (high - low > MIN_OVERLAP_M)
    i, j = np.nonzero(same)
    return _Pairs(difference[i, j], (high - low)[i, j], base.offset_m[a][i])


def _mode(pairs: _Pairs) -> float:
    """The shift on which the most metres of wall agree, then their weighted mean."""
    if not len(pairs.difference_m):
        return 0.0
    near = np.abs(pairs.difference_m[:, None] - pairs.difference_m[None]) < AGREE_M
    move = float(pairs.difference_m[np.argmax(near @ pairs.overlap_m)])
    for _ in range(ROUNDS):
        close = np.abs(pairs.difference_m - move) < AGREE_M
        move = float(np.average(pairs.difference_m[close], weights=pairs.overlap_m[close]))
    return move


def _agreement(pairs: _Pairs, move_m: float) -> Agreement:
    off = pairs.difference_m - move_m
    close = np.abs(off) < AGREE_M
    if not close.any():
        return Agreement(0.0, 0, CLOSE_M)
    offsets = np.sort(pairs.offset_m[close])
    walls = 1 + int((np.diff(offsets) > AGREE_M).sum())
    spread = MAD_TO_SIGMA * float(np.median(np.abs(off[close])))
    return Agreement(float(pairs.overlap_m[close].sum()), walls, max(spread, SIGMA_FLOOR_M))
