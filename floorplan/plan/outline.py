"""The gross outline of the floor: rooms and wall matter together, small notches closed."""

from shapely.geometry import JOIN_STYLE, Polygon
from shapely.geometry.base import BaseGeometry
from shapely.ops import unary_union

from floorplan.model.plan import Point, Room

MIN_PART_M2 = 1.0  # smaller separate parts are no floor


def gross_outline(rooms: tuple[Room, ...], matter: BaseGeometry, thickness_m: float) -> tuple[tuple[Point, ...], ...]:
    """Outer rings (first point not repeated), after closing everything narrower than a wall (`thickness_m`).

    Outer walls whose outer face nobody saw count up to their inner face: nothing is invented.
    """
    everything = unary_union([Polygon(room.outline) for room in rooms] + [matter])
    half = thickness_m / 2 + 1e-3
    closed = everything.buffer(half, join_style=JOIN_STYLE.mitre).buffer(-half, join_style=JOIN_STYLE.mitre)
    parts = [part for part in getattr(closed, "geoms", [closed]) if isinstance(part, Polygon) and part.area >= MIN_PART_M2]
    rings = (Polygon(part.exterior).simplify(1e-3).exterior.coords[:-1] for part in parts)
    return tuple(tuple((float(x), float(y)) for x, y in ring) for ring in rings)
