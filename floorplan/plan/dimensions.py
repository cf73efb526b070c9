"""Numbered wall-to-wall dimensions: which pairs of faces are measured, where their lines run, what they are worth."""

from dataclasses import dataclass, replace

import numpy as np
import shapely
from shapely.geometry import LineString, Polygon, box
from shapely.geometry import Point as ShapelyPoint

from floorplan.model.checks import Array
from floorplan.model.plan import Dimension, DimensionRole, Room
from floorplan.plan.corners import FaceRun
from floorplan.plan.faces import spans
from floorplan.plan.walls import distance_sigma_m, point_on

MIN_ROOM_SPAN_M = 0.8  # nearer faces make no room: a wall, a shaft, a cupboard
MIN_SHARED_M = 0.3  # faces that look at each other over less than this, a pillar's width, are not measured against each other
TEXT_WIDTH_M, TEXT_HEIGHT_M = 1.2, 0.3  # what a dimension's text covers at 1:50 to 1:100
SAME_LINE_M = 0.02  # faces nearer than this are one line in a drawing
STEP_M = 0.05  # grain at which the place for a dimension line is looked for
FRACTIONS = (0.3, 0.7, 0.2, 0.8, 0.4, 0.6, 0.12, 0.88, 0.5)  # where along the shared stretch a line may run, best first


@dataclass(frozen=True)
class FacingPair:
    """Two faces (indices) that look at each other with nothing between them over `low_m`..`high_m` along them."""

    lower: int
    upper: int
    low_m: float
    high_m: float


@dataclass(frozen=True)
class RoomStretch:
    """Where a facing pair is measured in one room: `low_m`..`high_m` along the faces."""

    pair: FacingPair
    room: str
    low_m: float
    high_m: float


def facing_pairs(faces: tuple[FaceRun, ...]) -> tuple[FacingPair, ...]:
    """All pairs of room size, longest shared stretch first."""
    pairs = []
    for i, lower in enumerate(faces):
        for j, upper in enumerate(faces):
            looks = lower.axis == upper.axis and lower.facing == 1 and upper.facing == -1
            if looks and upper.offset_m - lower.offset_m >= MIN_ROOM_SPAN_M and lower.overlap_m(upper) >= MIN_SHARED_M:
                pairs += _clear_stretches(faces, i, j)
    return tuple(sorted(pairs, key=lambda pair: pair.low_m - pair.high_m))


def _clear_stretches(faces: tuple[FaceRun, ...], i: int, j: int) -> list[FacingPair]:
    """The longest part of the shared stretch that no parallel face interrupts."""
    lower, upper = faces[i], faces[j]
    clear = LineString([(max(lower.start_m, upper.start_m), 0), (min(lower.end_m, upper.end_m), 0)])
    for other in faces:
        if other.axis == lower.axis and lower.offset_m < other.offset_m < upper.offset_m:
            clear = clear.difference(LineString([(other.start_m, 0), (other.end_m, 0)]))
    parts = [part for part in getattr(clear, "geoms", [clear]) if part.length >= MIN_SHARED_M]
    if not parts:
        return []
    longest = max(parts, key=lambda part: part.length)
    return [FacingPair(i, j, float(longest.bounds[0]), float(longest.bounds[2]))]


def wall_to_wall(
    faces: tuple[FaceRun, ...], rooms: tuple[Room, ...], covariance_m2: Array, plane_ids: tuple[str, ...]
) -> tuple[Dimension, ...]:
    """The distances between faces of each room that do not follow from others, lines clear of the others' texts and of room stamps.

    As on any drawing: k walls of one room across an axis are placed by k - 1 numbers, those with the longest stretch in common.
    """
    tied: dict[tuple[str, int], list[frozenset[int]]] = {}
    taken = [_stamp_box(room) for room in rooms]
    dimensions: list[Dimension] = []
    for stretch in _room_stretches(faces, rooms):
        lower, upper = faces[stretch.pair.lower], faces[stretch.pair.upper]
        known = tied.get((stretch.room, lower.axis), [])
        if any({lower.run.plane, upper.run.plane} <= planes for planes in known):
            continue  # the sum or difference of others
        at = _clear_position(stretch, faces, taken)
        start, end = point_on(lower, at), point_on(upper, at)
        new = Dimension(
            "",
            DimensionRole.ROOM,
            plane_ids[lower.run.plane],
            plane_ids[upper.run.plane],
            lower.axis,
            float(upper.offset_m - lower.offset_m),
            distance_sigma_m(lower, upper, covariance_m2),
            start,
            end,
            ((start[0] + end[0]) / 2, (start[1] + end[1]) / 2),
            stretch.room,
        )
        if not any(_same_distance(new, old) for old in dimensions):
            taken.append(_text_box(lower, upper, at))
            dimensions.append(new)
        tied[stretch.room, lower.axis] = _joined(known, frozenset((lower.run.plane, upper.run.plane)))
    return tuple(dimensions)


def _joined(groups: list[frozenset[int]], ends: frozenset[int]) -> list[frozenset[int]]:
    """Groups of planes whose distances are known, with those joined that `ends` connects."""
    apart = [group for group in groups if not group & ends]
    return [*apart, ends.union(*(group for group in groups if group & ends))]


def _same_distance(a: Dimension, b: Dimension) -> bool:
    """Whether two dimensions of one room measure the same: both ends on the same lines as far as a drawing shows."""
    ends = max(abs(a.start[a.axis] - b.start[a.axis]), abs(a.end[a.axis] - b.end[a.axis]))
    return a.room == b.room and a.axis == b.axis and ends < SAME_LINE_M


def _room_stretches(faces: tuple[FaceRun, ...], rooms: tuple[Room, ...]) -> list[RoomStretch]:
    """For every facing pair, the longest stretch of lines between the two that stays within one room, longest first."""
    found = []
    insides = [Polygon(room.outline, room.holes).buffer(SAME_LINE_M) for room in rooms]
    shapely.prepare(insides)
    for pair in facing_pairs(faces):
        places = np.arange(pair.low_m + STEP_M / 2, pair.high_m, STEP_M)
        lines = shapely.linestrings([(point_on(faces[pair.lower], at), point_on(faces[pair.upper], at)) for at in places])
        for room, inside in zip(rooms, insides, strict=True):
            within = shapely.covers(inside, lines)
            first, last = max(spans(within), key=lambda span: span[1] - span[0], default=(0, 0))
            if (last - first) * STEP_M >= MIN_SHARED_M:
                found.append(RoomStretch(pair, room.id, float(places[first]), float(places[last - 1])))
    return sorted(found, key=lambda stretch: stretch.low_m - stretch.high_m)


def _clear_position(stretch: RoomStretch, faces: tuple[FaceRun, ...], taken: list[Polygon]) -> float:
    """Coordinate along the faces at which the text covers least of what is already there."""

    def covered(at: float) -> float:
        text = _text_box(faces[stretch.pair.lower], faces[stretch.pair.upper], at)
        return float(sum(text.intersection(other).area for other in taken))

    places = [stretch.low_m + fraction * (stretch.high_m - stretch.low_m) for fraction in FRACTIONS]
    return min(places, key=covered)


def _text_box(lower: FaceRun, upper: FaceRun, at: float) -> Polygon:
    middle = 0.5 * (lower.offset_m + upper.offset_m)
    half_across, half_along = TEXT_WIDTH_M / 2, TEXT_HEIGHT_M / 2
    if lower.axis == 0:
        return box(middle - half_across, at - half_along, middle + half_across, at + half_along)
    return box(at - half_along, middle - half_across, at + half_along, middle + half_across)


def _stamp_box(room: Room) -> Polygon:
    point = ShapelyPoint(room.label)
    return box(point.x - TEXT_WIDTH_M / 2, point.y - 2 * TEXT_HEIGHT_M, point.x + TEXT_WIDTH_M / 2, point.y + 2 * TEXT_HEIGHT_M)


def numbered(dimensions: tuple[Dimension, ...]) -> tuple[Dimension, ...]:
    """Ids D1, D2, ...: sizes room by room from the top left, then the chains outside side by side, the lengths over all, heights last."""
    order = sorted(dimensions, key=_drawing_order)
    return tuple(replace(dimension, id=f"D{number + 1}") for number, dimension in enumerate(order))


def _drawing_order(dimension: Dimension) -> tuple[int, int, tuple[float, float]]:
    role = list(DimensionRole).index(dimension.role)
    number = int(dimension.room[1:] or 0)
    x, y = round(dimension.line[0], 2), round(dimension.line[1], 2)
    if dimension.role in (DimensionRole.CHAIN, DimensionRole.OVERALL):  # along one side after the other
        return role, dimension.axis, (y, x) if dimension.axis == 0 else (x, y)
    return role, number, (-y, x)
