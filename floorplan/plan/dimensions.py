"""Numbered wall-to-wall dimensions: which pairs of faces are measured, where their lines run, what they are worth."""

from dataclasses import dataclass, replace

from shapely.geometry import LineString, Polygon, box
from shapely.geometry import Point as ShapelyPoint

from floorplan.model.checks import Array
from floorplan.model.plan import Dimension, DimensionRole, Room
from floorplan.plan.corners import FaceRun
from floorplan.plan.walls import distance_sigma_m, point_on

MIN_ROOM_SPAN_M = 0.8  # nearer faces make no room: a wall, a shaft, a cupboard
MIN_SHARED_M = 0.5  # faces that look at each other over less than this are not measured against each other
TEXT_WIDTH_M, TEXT_HEIGHT_M = 1.2, 0.3  # what a dimension's text covers at 1:50 to 1:100
FRACTIONS = (0.3, 0.7, 0.2, 0.8, 0.4, 0.6, 0.12, 0.88, 0.5)  # where along the shared stretch a line may run, best first


@dataclass(frozen=True)
class FacingPair:
    """Two faces (indices) that look at each other with nothing between them over `low_m`..`high_m` along them."""

    lower: int
    upper: int
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
    faces: tuple[FaceRun, ...], rooms: tuple[Room, ...], covariance_m2: Array | None, plane_ids: tuple[str, ...]
) -> tuple[Dimension, ...]:
    """One dimension per pair of planes and room, its line placed clear of the others' texts and of the room stamps."""
    areas = [Polygon(room.outline, room.holes) for room in rooms]
    taken = [_stamp_box(room) for room in rooms]
    measured: set[tuple[str, str, str]] = set()
    dimensions: list[Dimension] = []
    for pair in facing_pairs(faces):
        lower, upper = faces[pair.lower], faces[pair.upper]
        room = _room_at(pair, faces, rooms, areas)
        key = (plane_ids[lower.run.plane], plane_ids[upper.run.plane], room)
        if key in measured or (rooms and not room):
            continue
        measured.add(key)
        at = _clear_position(pair, faces, taken)
        taken.append(_text_box(lower, upper, at))
        start, end = point_on(lower, at), point_on(upper, at)
        middle = ((start[0] + end[0]) / 2, (start[1] + end[1]) / 2)
        distance = float(upper.offset_m - lower.offset_m)
        sigma = distance_sigma_m(lower, upper, covariance_m2)
        dimensions.append(Dimension("", DimensionRole.ROOM, key[0], key[1], lower.axis, distance, sigma, start, end, middle, room))
    return tuple(dimensions)


def _room_at(pair: FacingPair, faces: tuple[FaceRun, ...], rooms: tuple[Room, ...], areas: list[Polygon]) -> str:
    """The room that a line between the two faces crosses all the way, or nothing."""
    at = 0.5 * (pair.low_m + pair.high_m)
    line = LineString([point_on(faces[pair.lower], at), point_on(faces[pair.upper], at)])
    shares = [(line.intersection(area).length / line.length, room.id) for room, area in zip(rooms, areas, strict=True)]
    share, room_id = max(shares, default=(0.0, ""))
    return room_id if share > 0.9 else ""


def _clear_position(pair: FacingPair, faces: tuple[FaceRun, ...], taken: list[Polygon]) -> float:
    """Coordinate along the faces at which the text covers least of what is already there."""

    def covered(at: float) -> float:
        text = _text_box(faces[pair.lower], faces[pair.upper], at)
        return sum(text.intersection(other).area for other in taken)

    places = [pair.low_m + fraction * (pair.high_m - pair.low_m) for fraction in FRACTIONS]
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
    """Ids D1, D2, ... from the top left of the plan downwards, heights last."""
    order = sorted(dimensions, key=lambda d: (d.role is DimensionRole.HEIGHT, d.room, -round(d.line[1], 2), round(d.line[0], 2)))
    return tuple(replace(dimension, id=f"D{number + 1}") for number, dimension in enumerate(order))
