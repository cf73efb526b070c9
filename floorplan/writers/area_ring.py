"""A room with holes as one closed ring: the outline, cut to each hole by a slit of zero width."""

from shapely import LineString, Polygon

from floorplan.model.plan import Point

SLACK_M = 1e-6  # a slit may touch the ring it starts from


def signed_area(ring: tuple[Point, ...]) -> float:
    """Positive when counter-clockwise, square metres."""
    return sum(a[0] * b[1] - b[0] * a[1] for a, b in zip(ring, (*ring[1:], ring[0]), strict=True)) / 2


def slit_ring(outline: tuple[Point, ...], holes: tuple[tuple[Point, ...], ...]) -> tuple[Point, ...]:
    """`outline` with every hole joined to it; the shoelace area of the result is the net area. Holes nearest first."""
    ring = outline if signed_area(outline) > 0 else outline[::-1]
    left = [hole if signed_area(hole) < 0 else hole[::-1] for hole in holes]
    room = Polygon(outline, holes).buffer(SLACK_M)
    while left:
        start, index, corner = _shortest_slit(ring, left, room)
        hole = left.pop(index)
        turned = hole[corner:] + hole[:corner]
        ring = (*ring[: start + 1], *turned, turned[0], *ring[start:])
    return ring


def _shortest_slit(ring: tuple[Point, ...], holes: list[tuple[Point, ...]], room: Polygon) -> tuple[int, int, int]:
    """Row of the ring, hole and corner of the hole of the shortest slit that stays inside the room."""
    pairs = sorted(
        ((a[0] - b[0]) ** 2 + (a[1] - b[1]) ** 2, start, index, corner)
        for start, a in enumerate(ring)
        for index, hole in enumerate(holes)
        for corner, b in enumerate(hole)
    )
    for _, start, index, corner in pairs:
        if room.covers(LineString([ring[start], holes[index][corner]])):
            return start, index, corner
    return pairs[0][1:]  # a room that is not simple has no clean slit: the shortest still keeps the area
