"""The quarter turn and the shift that lay one plan on another: those under which most wall lies on wall.

No finer rotation is needed: both plans run along their walls.
"""

from dataclasses import dataclass

import numpy as np

from floorplan.compare.faces import FaceRows, offset_differences_m, overlap_m, seen_faces
from floorplan.compare.turn import turned_plan
from floorplan.errors import InputError
from floorplan.model.checks import Array
from floorplan.model.plan import Plan

BIN_M = 0.10  # of the votes for a shift: surveys of one floor differ by centimetres
CANDIDATES = 16  # shifts tried per axis
ON_WALL_M = 0.15  # faces this near lie on each other
MIN_SHARE = 0.3  # of the smaller survey's wall length: less is another floor, or hardly the same part of it
SURE_SHARE = 0.55  # from here on no other floor fits: different buildings reach 0.46 by chance, surveys of one 0.69 and more
RIVAL_BY_CHANCE = 0.6  # below the sure share, another quarter turn that lays this much as well shows that both are chance
AMBIGUOUS = 0.9  # another quarter turn that lays this much as well


@dataclass(frozen=True)
class Alignment:
    """Second plan to first: `quarters` counter-clockwise, then `shift_m (3,)`. `matched_m` of wall lies on wall.

    `rival_share`: what the best other quarter turn matches, as a share of `matched_m`; near 1 the floor looks alike from two sides.
    """

    quarters: int
    shift_m: Array
    matched_m: float
    rival_share: float
    share: float = 1.0  # of the smaller survey's wall that lies on the other's

    @property
    def sure(self) -> bool:
        """Whether so much wall lies on wall that it is no chance."""
        return self.share >= SURE_SHARE

    @property
    def ambiguous(self) -> bool:
        return self.rival_share > AMBIGUOUS


@dataclass(frozen=True)
class _Laid:
    matched_m: float
    quarters: int
    shift_xy: Array


def align(first: Plan, second: Plan) -> Alignment:
    """Lay `second` on `first`. Raises InputError where they share too little wall to tell how."""
    a, tries = seen_faces(first), []
    for quarters in range(4):
        b = seen_faces(turned_plan(second, quarters, np.zeros(3)))
        if len(a.axis) and len(b.axis):
            tries.append(_laid(a, b, quarters))
    tries.sort(key=lambda laid: -laid.matched_m)
    least = min(float(a.length_m.sum()), float(seen_faces(second).length_m.sum()))
    share = tries[0].matched_m / max(least, 1e-9) if tries else 0.0
    if share < MIN_SHARE or (share < SURE_SHARE and tries[1].matched_m > RIVAL_BY_CHANCE * tries[0].matched_m):
        matched = tries[0].matched_m if tries else 0.0
        raise InputError(
            f"the two surveys have only {matched:.1f} m of wall in common, of {least:.1f} m: they are of different floors, "
            "or of parts that hardly overlap; compare two builds of the same floor"
        )
    best = tries[0]
    return Alignment(best.quarters, np.array([*best.shift_xy, 0.0]), best.matched_m, tries[1].matched_m / best.matched_m, share)


def _laid(a: FaceRows, b: FaceRows, quarters: int) -> _Laid:
    """The best shift under one quarter turn."""
    shifts = [np.array([x, y]) for x in _voted(a, b, 0) for y in _voted(a, b, 1)]
    best = max(shifts, key=lambda shift: _matched_m(a, b, shift))
    refined = _refined(a, b, best)
    return _Laid(_matched_m(a, b, refined), quarters, refined)


def _voted(a: FaceRows, b: FaceRows, axis: int) -> Array:
    """Shifts along an axis that many pairs of faces square to it ask for, the most wanted first."""
    alike = (a.axis[:, None] == axis) & (b.axis == axis) & (a.facing[:, None] == b.facing)
    if not alike.any():
        return np.zeros(1)
    shift = (a.offset_m[:, None] - b.offset_m)[alike]
    weight = np.minimum(a.length_m[:, None], b.length_m)[alike]
    first = shift.min() - 1.5 * BIN_M
    bins = np.floor((shift - first) / BIN_M).astype(int)
    votes = np.convolve(np.bincount(bins, weight, bins.max() + 2), np.ones(3), mode="same")
    chosen = np.argsort(-votes, kind="stable")[:CANDIDATES]
    return np.asarray(first + (chosen + 0.5) * BIN_M)


def _matched_m(a: FaceRows, b: FaceRows, shift_xy: Array) -> float:
    near = np.abs(offset_differences_m(a, b, shift_xy)) < ON_WALL_M
    return float(np.where(near, np.maximum(overlap_m(a, b, shift_xy), 0.0), 0.0).sum())


def _refined(a: FaceRows, b: FaceRows, shift_xy: Array) -> Array:
    """The shift under which the median matched metre of wall lies exactly on its partner."""
    for _ in range(3):
        difference, shared = offset_differences_m(a, b, shift_xy), overlap_m(a, b, shift_xy)
        shift_xy = shift_xy.copy()
        for axis in range(2):
            rows = (np.abs(difference) < ON_WALL_M) & (shared > 0) & (b.axis == axis)
            if rows.any():
                shift_xy[axis] -= _weighted_median(difference[rows], shared[rows])
    return shift_xy


def _weighted_median(values: Array, weights: Array) -> float:
    order = np.argsort(values)
    return float(values[order][np.searchsorted(np.cumsum(weights[order]), weights.sum() / 2)])
