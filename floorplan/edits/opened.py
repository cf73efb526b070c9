"""Rooms that an edit opens: a side of theirs stood on what was taken out."""

from dataclasses import replace

from shapely import LinearRing, LineString, unary_union
from shapely.geometry.base import BaseGeometry

from floorplan.model.plan import Plan, Room

ON_LINE_M = 0.06  # an outline follows a drawn line within this
MIN_SIDE_M = 0.3  # shorter gaps are corners


def opened_rooms(rooms: tuple[Room, ...], before: Plan, after: Plan) -> tuple[Room, ...]:
    """The rooms, those only partly closed now that were closed by lines of `before` which `after` has no more."""
    left, gone = _lines(after), _lines(before).difference(_lines(after))
    if gone.is_empty:
        return rooms
    return tuple(replace(room, partial=True) if _open_m(room, gone, left) >= MIN_SIDE_M else room for room in rooms)


def _lines(plan: Plan) -> BaseGeometry:
    """What is drawn of walls, on the axes and off them."""
    lines = [line for wall in plan.walls for line in (*wall.seen, *wall.inferred)]
    lines += [(line.start, line.end) for line in plan.free_lines]
    return unary_union([LineString(line) for line in lines if len(line) > 1])


def _open_m(room: Room, gone: BaseGeometry, left: BaseGeometry) -> float:
    """Length of a room's outline that lies on a line taken out and on none that stands."""
    taken = gone.buffer(ON_LINE_M).difference(left.buffer(ON_LINE_M))
    return float(sum(LinearRing(ring).intersection(taken).length for ring in (room.outline, *room.holes)))
