"""The door symbol: which way it is drawn (hinge and swing were not surveyed), and its lines in a unit opening."""

import math
from dataclasses import dataclass

from shapely import Point as ShapelyPoint
from shapely import Polygon

from floorplan.model.plan import Opening, Plan, Point, RoomKind

ARC_STEPS = 12  # chords of the quarter circle in picture formats
LOOK_BEYOND_M = 0.30  # beyond the wall's face, where the room on that side is looked up
THIN_WINDOW_M = 0.04  # drawn depth of a window in a wall of unknown thickness
UNIT_LEAF = ((-0.5, 0.0), (-0.5, 1.0))  # hinge at one jamb, leaf open at a right angle; the opening is 1 wide
UNIT_LINE = ((-0.5, 0.0), (0.5, 0.0))  # a passage: one line across


@dataclass(frozen=True)
class DoorSymbol:
    """An opening as drawn: unit symbol turned by `rotation_deg`, scaled by the opening's width, moved to its centre."""

    opening: Opening
    rotation_deg: float

    def placed(self, points: tuple[Point, ...]) -> tuple[Point, ...]:
        turn, width = math.radians(self.rotation_deg), self.opening.width_m
        cosine, sine = math.cos(turn) * width, math.sin(turn) * width
        x, y = self.opening.centre
        return tuple((x + cosine * u - sine * v, y + sine * u + cosine * v) for u, v in points)


def window_lines(opening: Opening) -> tuple[tuple[Point, ...], ...]:
    """A window: its two faces and its middle, in a unit opening."""
    half = max(opening.depth_m, THIN_WINDOW_M) / 2 / opening.width_m
    return tuple(((-0.5, offset), (0.5, offset)) for offset in (-half, 0.0, half))


def unit_arc() -> tuple[Point, ...]:
    """The swing, from the open leaf's end to the other jamb."""
    angles = [math.pi / 2 * (1 - step / ARC_STEPS) for step in range(ARC_STEPS + 1)]
    return tuple((-0.5 + math.cos(angle), math.sin(angle)) for angle in angles)


def door_symbols(plan: Plan) -> tuple[DoorSymbol, ...]:
    """One symbol per opening, drawn into the room, the smaller one of two; beside a corridor into what is no corridor, drawn or not."""
    rooms = [(Polygon(room.outline, room.holes), room.kind == RoomKind.CORRIDOR) for room in plan.rooms]
    return tuple(DoorSymbol(opening, _rotation_deg(opening, rooms)) for opening in plan.openings)


def _rotation_deg(opening: Opening, rooms: list[tuple[Polygon, bool]]) -> float:
    base = 90.0 * opening.along_axis
    beyond = opening.depth_m / 2 + LOOK_BEYOND_M
    x, y = opening.centre
    ahead = (x, y + beyond) if opening.along_axis == 0 else (x - beyond, y)
    behind = (x, y - beyond) if opening.along_axis == 0 else (x + beyond, y)
    return base if _rank(ahead, rooms) <= _rank(behind, rooms) else base + 180.0


def _rank(point: Point, rooms: list[tuple[Polygon, bool]]) -> tuple[int, float]:
    """Sorts sides: rooms by size, then what was not seen (off a corridor it is a room nobody entered), then corridors."""
    for polygon, corridor in rooms:
        if polygon.covers(ShapelyPoint(point)):
            return 2 if corridor else 0, polygon.area
    return 1, 0.0
