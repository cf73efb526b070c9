"""Rooms: free space between walls and closed openings, as polygons on the inner faces, with area and ceiling height."""

from dataclasses import dataclass, replace

import numpy as np
from shapely.geometry import LineString, MultiPoint, Polygon, box
from shapely.geometry.base import BaseGeometry
from shapely.geometry.polygon import orient
from shapely.ops import unary_union

from floorplan.config import PlanConfig
from floorplan.model.checks import Array
from floorplan.model.plan import Point, Room, RoomKind
from floorplan.plan.arrangement import NO_REGION, Arrangement, Barrier, MatterShare, arrange
from floorplan.plan.bodies import Body
from floorplan.plan.corners import FaceRun
from floorplan.plan.free_space import CELL_M, FreeSpace
from floorplan.plan.gaps import OPEN_SHARE, Gap
from floorplan.plan.glazing import GlazedLine, barriers_of

CORRIDOR_WIDTH_M = 3.0  # corridors are narrower ...
CORRIDOR_STRETCH = 1.5  # ... and at least about four times as long as wide: perimeter^2 / (16 area), 1 for a square
SAME_LINE_M = 1e-4  # outlines lie on the barriers but for rounding
MIN_ENCLOSED = 0.9  # a room less enclosed than this by walls and openings is partial
MIN_GLIMPSE_ENCLOSED = 0.5  # unvisited and less enclosed than this: the outdoors behind a window, or nothing known


@dataclass(frozen=True)
class RoomScene:
    """What rooms are made from: faces, their gaps, wall bodies, free space and the sensor's path (F, 2)."""

    faces: tuple[FaceRun, ...]
    gaps: tuple[Gap, ...]
    bodies: tuple[Body, ...]
    glazed: tuple[GlazedLine, ...]
    space: FreeSpace
    path_xy_m: Array


def find_rooms(scene: RoomScene, config: PlanConfig) -> tuple[Room, ...]:
    """Rooms R1.. from the top left; areas without sigma and ceilings without height yet."""
    glass = (barrier for line in scene.glazed for barrier in barriers_of(line, scene.faces))
    barriers = (*wall_barriers(scene.faces), *opening_barriers(scene, config), *glass)
    matter = np.array([body.rectangle.bounds for body in scene.bodies]).reshape(-1, 4)
    arrangement = arrange(barriers, scene.space, MatterShare(matter))
    lines = unary_union([_line(barrier) for barrier in barriers]).buffer(SAME_LINE_M)
    shapes = [shape for region in range(arrangement.region.max() + 1) for shape in _polygons(arrangement, region)]
    rooms = [_room(shape, lines, scene.path_xy_m) for shape in shapes if shape.area >= config.min_room_area_m2]
    kept = sorted((room for room in rooms if room is not None), key=lambda room: (-round(room.label[1]), room.label[0]))
    return tuple(_named(room, number + 1) for number, room in enumerate(kept))


def wall_barriers(faces: tuple[FaceRun, ...]) -> tuple[Barrier, ...]:
    """Every drawn stretch of wall."""
    return tuple(Barrier(face.axis, face.offset_m, face.start_m, face.end_m) for face in faces)


def opening_barriers(scene: RoomScene, config: PlanConfig) -> tuple[Barrier, ...]:
    """Openings up to door width, seen through or not, in walls known to be walls: thick, hit above the gap, or unseen there."""
    thick = {index for body in scene.bodies for index in (body.low_face, body.high_face)}
    closed = []
    for gap in scene.gaps:
        face = scene.faces[gap.face]
        after = face if gap.after is None else scene.faces[gap.after]
        in_wall = (
            gap.lintel
            or (gap.lintel is None and gap.after is not None)
            or gap.passed < OPEN_SHARE
            or gap.face in thick
            or gap.after in thick
        )
        if gap.is_window or (gap.width_m <= config.max_door_width_m and in_wall):
            closed.append(Barrier(face.axis, face.offset_m, gap.start_m, gap.end_m, solid=False))
            if after.offset_m != face.offset_m:  # the two sides of the opening are not quite in line: close the step
                closed.append(_step(face, after, gap))
    return tuple(closed)


def _step(face: FaceRun, after: FaceRun, gap: Gap) -> Barrier:
    low, high = sorted((face.offset_m, after.offset_m))
    at = gap.end_m if after.start_m >= gap.end_m - CELL_M else gap.start_m
    return Barrier(1 - face.axis, at, low, high, solid=False)


def _line(barrier: Barrier) -> LineString:
    ends = ((barrier.offset_m, barrier.start_m), (barrier.offset_m, barrier.end_m))
    return LineString(ends if barrier.axis == 0 else [(y, x) for x, y in ends])


def _polygons(arrangement: Arrangement, region: int) -> list[Polygon]:
    """The polygon of a region (one, for its cells are connected through edges)."""
    if region == NO_REGION:
        return []
    merged = unary_union([box(*b) for b in arrangement.boxes_of(region)])
    return [orient(part.simplify(1e-6)) for part in getattr(merged, "geoms", [merged])]


def _room(shape: Polygon, lines: BaseGeometry, path_xy_m: Array) -> Room | None:
    """A room of a polygon, or None when it is but open space seen from afar."""
    enclosed = shape.boundary.intersection(lines).length / shape.boundary.length
    visited = shape.intersects(MultiPoint(path_xy_m)) if len(path_xy_m) else False
    if not visited and enclosed < MIN_GLIMPSE_ENCLOSED:
        return None
    label = _label(shape)
    return Room(
        "",
        _kind(shape),
        "",
        _ring(shape.exterior.coords),
        float(shape.area),
        0.0,
        tuple(_ring(hole.coords) for hole in shape.interiors),
        label,
        visited=bool(visited),
        partial=bool(enclosed < MIN_ENCLOSED),
    )


def _ring(coords: object) -> tuple[Point, ...]:
    points = np.asarray(coords)[:-1]
    return tuple((float(x), float(y)) for x, y in points)


def _kind(shape: Polygon) -> RoomKind:
    around = shape.boundary.length
    narrow = 2 * shape.area / around <= CORRIDOR_WIDTH_M / 2 * 1.6  # w l / (w + l) of a strip four times as long as wide
    return RoomKind.CORRIDOR if narrow and around**2 / (16 * shape.area) >= CORRIDOR_STRETCH else RoomKind.ROOM


def _label(shape: Polygon) -> Point:
    """The point farthest from the outline, where a stamp has most room."""
    from shapely import maximum_inscribed_circle

    centre = maximum_inscribed_circle(shape, tolerance=0.05).coords[0]
    return (float(centre[0]), float(centre[1]))


def _named(room: Room, number: int) -> Room:
    word = "Corridor" if room.kind is RoomKind.CORRIDOR else "Room"
    return replace(room, id=f"R{number}", name=f"{word} {number}")
