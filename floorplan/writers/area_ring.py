"""A room with holes as one closed ring: the outline, cut to each hole by a slit of zero width."""

from shapely import LineString, Polygon, prepare

from floorplan.model.plan import Point

SLACK_M = 1e-6  # a slit may touch the ring it starts from


def signed_area(ring: tuple[Point, ...]) -> float:
    """Positive when counter-clockwise, square metres."""
    return sum(a[0] * b[1] - b[0] * a[1] for a, b in zip(ring, (*ring[1:], ring[0]), strict=True)) / 2


def slit_ring(outline: tuple[Point, ...], holes: tuple[tuple[Point, ...], ...]) -> tuple[Point, ...]:
    """`outline` with every hole joined to it; the shoelace area of the result is the net area.

    Holes from left to right, each cut at its leftmost corner: what lies to the left of it is joined already, so that a
    corner in sight is always there.
    """
    ring = outline if signed_area(outline) > 0 else outline[::-1]
    if not holes:
        return ring
    room = Polygon(outline, holes).buffer(SLACK_M)
    prepare(room)
    for hole in sorted((hole if signed_area(hole) < 0 else hole[::-1] for hole in holes), key=min):
        corner = hole.index(min(hole))
        start = _nearest_in_sight(ring, hole[corner], room)
        ring = (*ring[: start + 1], *hole[corner:], *hole[: corner + 1], *ring[start:])
    return ring


def _nearest_in_sight(ring: tuple[Point, ...], corner: Point, room: Polygon) -> int:
    """Row of the ring's nearest point from which a straight cut to `corner` stays inside the room."""
    by_distance = sorted(range(len(ring)), key=lambda row: (ring[row][0] - corner[0]) ** 2 + (ring[row][1] - corner[1]) ** 2)
    for row in by_distance:
        if room.covers(LineString([ring[row], corner])):
            return row
    return by_distance[0]  # a room that is not simple has no clean slit: the shortest still keeps the area
