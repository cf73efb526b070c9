"""Everything that two surveys of one floor say differently, in one value."""

from dataclasses import dataclass, replace

import numpy as np

from floorplan.compare.align import Alignment, align
from floorplan.compare.differences import Repeatability, axis_differences, repeatability
from floorplan.compare.distances import DistanceChange, compare_distances
from floorplan.compare.faces import seen_faces
from floorplan.compare.openings import OpeningChange, compare_openings
from floorplan.compare.pairs import Pairing, Piece, PlanePair, level_pairs, pair_faces
from floorplan.compare.sight import Sight, sight_of
from floorplan.compare.survey import Rays, Survey
from floorplan.compare.turn import turned_plan
from floorplan.model.normal import NORMAL_95
from floorplan.model.plan import Plan, Point

LEAST_INTERVAL_M = 1e-6  # of a wall that both surveys measured exactly


@dataclass(frozen=True)
class WallChange:
    """One wall face in both surveys: `moved_m` along its `axis` of the first plan, second minus first, within `interval_m` (95 %) or not.

    `stretches` are where they lie on each other, in the first plan's frame, as the second survey has them.
    """

    first: tuple[str, ...]
    second: tuple[str, ...]
    axis: int
    moved_m: float
    interval_m: float
    moved: bool
    length_m: float
    stretches: tuple[tuple[Point, Point], ...]


@dataclass(frozen=True)
class WallPiece:
    """A stretch of wall that only one survey has though the other looked through its place."""

    wall: str
    start: Point
    end: Point
    length_m: float


@dataclass(frozen=True)
class Comparison:
    """Two surveys, the second laid on the first; names, changes, agreement. `unseen_m`: wall that only one of them had in view."""

    first: str
    second: str
    alignment: Alignment
    walls: tuple[WallChange, ...]
    gone: tuple[WallPiece, ...]
    new: tuple[WallPiece, ...]
    openings: tuple[OpeningChange, ...]
    distances: tuple[DistanceChange, ...]
    wall_repeatability: Repeatability | None
    distance_repeatability: Repeatability | None
    unseen_m: float
    second_plan: Plan

    @property
    def changed(self) -> bool:
        """Whether anything moved, came or went."""
        return bool(self.gone or self.new or any(wall.moved for wall in self.walls) or self._else_moved)

    @property
    def _else_moved(self) -> bool:
        return any(opening.moved for opening in self.openings) or any(distance.moved for distance in self.distances)


def compare_surveys(first: Survey, second: Survey) -> Comparison:
    """Lay the second survey on the first and compare. Raises InputError where they share too little wall."""
    laid = _laid(first.plan, second.plan)
    pairs = laid.pairing.pairs
    apart = _differences(first.plan, laid.plan, pairs)
    walls = [_wall_change(first.plan, laid.plan, pair, one) for pair, one in zip(pairs, apart, strict=True)]
    rays = second.rays.turned(laid.alignment.quarters, laid.alignment.shift_m)
    gone = _lost(first.plan, laid.pairing.left_first, rays, second.plan.floor_seen)
    new = _lost(laid.plan, laid.pairing.left_second, first.rays, first.plan.floor_seen)
    distances = compare_distances(first.plan, laid.plan, pairs, dict(level_pairs(first.plan.planes, laid.plan.planes)))
    return Comparison(
        first=first.name,
        second=second.name,
        alignment=laid.alignment,
        walls=tuple(sorted(walls, key=lambda wall: -abs(wall.moved_m) / max(wall.interval_m, LEAST_INTERVAL_M))),
        gone=gone.pieces,
        new=new.pieces,
        openings=compare_openings(first.plan, laid.plan, {axis: _typical_sigma_m(apart, axis) for axis in range(2)}),
        distances=distances,
        wall_repeatability=repeatability(np.array([one.moved_m for one in apart]), np.array([one.sigma_m for one in apart])),
        distance_repeatability=repeatability(
            np.array([d.difference_m for d in distances]), np.array([d.interval_m for d in distances]) / NORMAL_95
        ),
        unseen_m=gone.unseen_m + new.unseen_m,
        second_plan=laid.plan,
    )


@dataclass(frozen=True)
class _LaidOn:
    """The second plan in the first one's frame, and what lies on what."""

    alignment: Alignment
    plan: Plan
    pairing: Pairing


def _laid(first: Plan, second: Plan) -> _LaidOn:
    """The alignment under the mean shift of the walls that stayed."""
    rough = _paired(first, second, align(first, second))
    shift = rough.alignment.shift_m.copy()
    for axis in range(2):
        if pairs := _square_to(first, rough.pairing.pairs, axis):
            shift[axis] -= axis_differences(first, rough.plan, pairs).shift_m
    return _paired(first, second, replace(rough.alignment, shift_m=shift))


def _paired(first: Plan, second: Plan, alignment: Alignment) -> _LaidOn:
    plan = turned_plan(second, alignment.quarters, alignment.shift_m)
    return _LaidOn(alignment, plan, pair_faces(seen_faces(first), seen_faces(plan)))


def _square_to(first: Plan, pairs: tuple[PlanePair, ...], axis: int) -> tuple[PlanePair, ...]:
    return tuple(pair for pair in pairs if first.planes[pair.first].axis == axis)


@dataclass(frozen=True)
class _Apart:
    """One pair's residual along its axis."""

    axis: int
    moved_m: float
    sigma_m: float


def _differences(first: Plan, second: Plan, pairs: tuple[PlanePair, ...]) -> tuple[_Apart, ...]:
    """Per pair, in the order of `pairs`."""
    found: dict[PlanePair, _Apart] = {}
    for axis in range(2):
        if square := _square_to(first, pairs, axis):
            rows = axis_differences(first, second, square)
            found |= {pair: _Apart(axis, float(rows.moved_m[k]), float(rows.sigma_m[k])) for k, pair in enumerate(square)}
    return tuple(found[pair] for pair in pairs)


def _typical_sigma_m(apart: tuple[_Apart, ...], axis: int) -> float:
    """How well places along an axis compare: root mean square over the walls square to it."""
    of_axis = [one.sigma_m for one in apart if one.axis == axis]
    return float(np.sqrt(np.mean(np.square(of_axis)))) if of_axis else 0.0


def _wall_change(first: Plan, second: Plan, pair: PlanePair, apart: _Apart) -> WallChange:
    offset, interval = second.planes[pair.second].offset_m, NORMAL_95 * apart.sigma_m
    return WallChange(
        first=_walls_of(first, pair.first_faces),
        second=_walls_of(second, pair.second_faces),
        axis=apart.axis,
        moved_m=apart.moved_m,
        interval_m=interval,
        moved=abs(apart.moved_m) > interval,
        length_m=pair.length_m,
        stretches=tuple(_stretch(apart.axis, offset, low, high) for low, high in pair.spans_m),
    )


def _walls_of(plan: Plan, faces: tuple[int, ...]) -> tuple[str, ...]:
    """Ids of the walls that some faces (indices) belong to; of the face itself where no wall owns it."""
    wall_of = {face: wall.id for wall in plan.walls for face in wall.faces}
    ids = [wall_of.get(plan.faces[number].id, plan.faces[number].id) for number in faces]
    return tuple(dict.fromkeys(ids))


@dataclass(frozen=True)
class _Lost:
    pieces: tuple[WallPiece, ...]
    unseen_m: float


def _lost(plan: Plan, left: tuple[Piece, ...], rays: Rays, floor_seen: bool) -> _Lost:
    """Pieces of `plan` whose place the other survey looked through, and the length of those it did not look at."""
    pieces, unseen_m = [], 0.0
    for piece in left:
        sight = sight_of(rays, piece, floor_seen)
        if sight is Sight.UNSEEN:
            unseen_m += piece.high_m - piece.low_m
        if sight is Sight.THROUGH:
            pieces.append(_wall_piece(plan, piece))
    return _Lost(tuple(pieces), unseen_m)


def _wall_piece(plan: Plan, piece: Piece) -> WallPiece:
    start, end = _stretch(piece.axis, piece.offset_m, piece.low_m, piece.high_m)
    return WallPiece(_walls_of(plan, (piece.face,))[0], start, end, piece.high_m - piece.low_m)


def _stretch(axis: int, offset_m: float, low_m: float, high_m: float) -> tuple[Point, Point]:
    """Both ends of a piece of wall square to an axis."""
    return ((offset_m, low_m), (offset_m, high_m)) if axis == 0 else ((low_m, offset_m), (high_m, offset_m))
