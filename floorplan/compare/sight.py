"""Whether a survey looked at a place: through it, at a surface there, or not at all."""

from enum import StrEnum

import numpy as np

from floorplan.compare.pairs import Piece
from floorplan.compare.survey import Rays
from floorplan.model.checks import Array

CELL_M = 0.10  # grain along the wall
ON_SURFACE_M = 0.12  # a ray that ends this near the plane hit it; one that passes ends farther behind
MIN_PASSES = 3  # rays through a cell: one or two may be flying pixels
MOST = 0.5  # of the stretch decides
BAND_M = (1.0, 2.0)  # above the floor: over tables, below lintels; sweeps have one height and are not bound by it


class Sight(StrEnum):
    THROUGH = "looked through"
    SURFACE = "a surface there"
    UNSEEN = "not seen"


def sight_of(rays: Rays, piece: Piece, floor_seen: bool) -> Sight:
    """What the rays say of the stretch."""
    axis, along = piece.axis, 1 - piece.axis
    begin, end = rays.start_m[:, axis] - piece.offset_m, rays.end_m[:, axis] - piece.offset_m
    count = max(1, round((piece.high_m - piece.low_m) / CELL_M))
    hit = np.abs(end) < ON_SURFACE_M
    passed = (begin * end < 0) & ~hit & (np.abs(begin) > 0)
    share = np.divide(begin, begin - end, out=np.zeros(len(begin)), where=passed)
    crossing = rays.start_m + share[:, None] * (rays.end_m - rays.start_m)
    passes = _counted(crossing[passed], along, piece, count, floor_seen)
    hits = _counted(rays.end_m[hit], along, piece, count, floor_seen)
    if np.mean((passes >= MIN_PASSES) & (passes > hits)) >= MOST:
        return Sight.THROUGH
    return Sight.SURFACE if np.mean((hits >= MIN_PASSES) & (hits >= passes)) >= MOST else Sight.UNSEEN


def _counted(points: Array, along: int, piece: Piece, count: int, floor_seen: bool) -> Array:
    """Points per cell of the stretch (count,)."""
    cell = np.floor((points[:, along] - piece.low_m) / (piece.high_m - piece.low_m) * count).astype(int)
    inside = (cell >= 0) & (cell < count)
    if floor_seen:
        inside &= (points[:, 2] > BAND_M[0]) & (points[:, 2] < BAND_M[1])
    return np.bincount(cell[inside], minlength=count)
