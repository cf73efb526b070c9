"""Sides of rooms where no wall, opening or glass was seen: the room goes on there, or nobody looked."""

from shapely import LinearRing, LineString, MultiLineString, Polygon, union_all
from shapely.ops import linemerge

from floorplan.model.plan import Plan, Point
from floorplan.writers.door_symbol import door_symbols

ON_LINE_M = 0.06  # an outline follows a drawn line within this: noise of a face that was joined
MIN_SIDE_M = 0.3  # shorter gaps are corners
MIN_CLOSED_ROOM_SIDE_M = 0.6  # of a room that is closed but for this: as wide as somebody can walk through


def open_sides(plan: Plan) -> tuple[tuple[Point, ...], ...]:
    """Straight or stepped lines along the outlines of rooms, the longest first."""
    known = _drawn(plan)
    found: list[LineString] = []
    for room in plan.rooms:
        shortest = MIN_SIDE_M if room.partial else MIN_CLOSED_ROOM_SIDE_M
        for ring in (room.outline, *room.holes):
            rest = LinearRing(ring).difference(known)
            merged = linemerge(rest) if isinstance(rest, MultiLineString) else rest
            found += [part for part in getattr(merged, "geoms", [merged]) if part.length >= shortest]
    found.sort(key=lambda line: -line.length)
    return tuple(tuple((float(x), float(y)) for x, y in line.coords) for line in found)


def _drawn(plan: Plan) -> Polygon:
    """Everything that closes a room, as an area a little wider than its lines."""
    lines = [line for wall in plan.walls for line in (*wall.seen, *wall.inferred)]
    lines += [(line.start, line.end) for line in plan.free_lines] + [(pane.start, pane.end) for pane in plan.glazing]
    lines += [(*column.outline, column.outline[0]) for column in plan.columns]
    areas = [LineString(line).buffer(ON_LINE_M, cap_style="square") for line in lines if len(line) > 1]
    for door in door_symbols(plan):
        reach = (door.opening.depth_m / 2 + ON_LINE_M) / max(door.opening.width_m, ON_LINE_M)
        areas.append(Polygon(door.placed(((-0.5, -reach), (0.5, -reach), (0.5, reach), (-0.5, reach)))).buffer(ON_LINE_M))
    return union_all(areas)
