"""Rooms: free space between walls and closed openings, as polygons on the inner faces, with area and ceiling height."""

from dataclasses import dataclass, replace
from itertools import combinations

import numpy as np
import shapely
from shapely import maximum_inscribed_circle
from shapely.geometry import LineString, MultiPoint, Polygon
from shapely.geometry.base import BaseGeometry
from shapely.geometry.polygon import orient
from shapely.ops import unary_union

from floorplan.config import PlanConfig
from floorplan.model.checks import Array
from floorplan.model.plan import FreeLine, Point, Room, RoomKind
from floorplan.plan.arrangement import NO_REGION, Arrangement, Barrier, MatterShare, arrange
from floorplan.plan.bodies import Body
from floorplan.plan.closures import mouth_barriers, narrow_barriers, opening_barriers
from floorplan.plan.corners import FaceRun
from floorplan.plan.free_space import CELL_M, FreeSpace
from floorplan.plan.gaps import Gap
from floorplan.plan.glazing import GlazedLine, barriers_of
from floorplan.plan.returns import Step, step_barriers
from floorplan.plan.skewed_sides import line_of, with_skewed_sides

CORRIDOR_WIDTH_M = 3.0  # corridors are narrower ...
CORRIDOR_STRETCH = 1.5  # ... and at least about four times as long as wide: perimeter^2 / (16 area), 1 for a square
SAME_LINE_M = 1e-4  # outlines lie on the barriers but for rounding
MIN_ENCLOSED = 0.9  # a room less enclosed than this by walls and openings is partial
MAX_NICHE_M2 = 2.0  # larger it is a room of its own, however weakly its door is known
MIN_GLIMPSE_WIDTH_M = 0.9  # unvisited and narrower: a strip behind a wall of which frames disagree where it stands
MIN_GLIMPSE_ENCLOSED = 0.5  # unvisited and less enclosed than this: the outdoors behind a window, or nothing known


@dataclass(frozen=True)
class RoomScene:
    """What rooms are made from: faces, their gaps, wall bodies, unseen steps, free space, the sensor's path (F, 2), walls off the axes."""

    faces: tuple[FaceRun, ...]
    gaps: tuple[Gap, ...]
    bodies: tuple[Body, ...]
    glazed: tuple[GlazedLine, ...]
    steps: tuple[Step, ...]
    space: FreeSpace
    path_xy_m: Array
    skewed: tuple[FreeLine, ...] = ()


def find_rooms(scene: RoomScene, config: PlanConfig) -> tuple[Room, ...]:
    """Rooms R1.. from the top left; areas without sigma and ceilings without height yet."""
    glass = (barrier for line in scene.glazed for barrier in barriers_of(line, scene.faces))
    thick = frozenset(index for body in scene.bodies for index in (body.low_face, body.high_face))
    openings = opening_barriers(scene.faces, scene.gaps, thick, config) + narrow_barriers(scene.faces, config)
    barriers = (*wall_barriers(scene.faces), *step_barriers(scene.steps), *openings, *glass)
    matter = np.array([body.rectangle.bounds for body in scene.bodies]).reshape(-1, 4)
    mouths = mouth_barriers(scene.faces, config)
    arrangement = arrange((*barriers, *mouths), scene.space, MatterShare(matter))
    lines = unary_union([_line(barrier) for barrier in barriers]).buffer(SAME_LINE_M)
    shapes = [shape for region in range(arrangement.region.max() + 1) for shape in _polygons(arrangement, region)]
    weak, strong = (unary_union([_line(barrier) for barrier in barriers if barrier.weak is kind]) for kind in (True, False))
    shapes = through_mouths(shapes, unary_union([_line(mouth) for mouth in mouths]).difference(lines), lines, scene.path_xy_m)
    shapes = with_niches(shapes, weak.difference(strong.buffer(SAME_LINE_M)), lines)
    shapes = with_skewed_sides(shapes, scene.skewed, lines, scene.space)
    lines = unary_union([lines, *(line_of(line).buffer(SAME_LINE_M) for line in scene.skewed)])
    rooms = [_room(shape, lines, scene.path_xy_m) for shape in shapes if shape.area >= config.min_room_area_m2]
    kept = sorted((room for room in rooms if room is not None), key=lambda room: (-round(room.label[1]), room.label[0]))
    return tuple(_named(room, number + 1) for number, room in enumerate(kept))


def wall_barriers(faces: tuple[FaceRun, ...]) -> tuple[Barrier, ...]:
    """Every drawn stretch of wall."""
    return tuple(Barrier(face.axis, face.offset_m, face.start_m, face.end_m) for face in faces)


def _line(barrier: Barrier) -> LineString:
    ends = ((barrier.offset_m, barrier.start_m), (barrier.offset_m, barrier.end_m))
    return LineString(ends if barrier.axis == 0 else [(y, x) for x, y in ends])


def _polygons(arrangement: Arrangement, region: int) -> list[Polygon]:
    """The polygon of a region (one, for its cells are connected through edges)."""
    if region == NO_REGION:
        return []
    merged = shapely.union_all(shapely.box(*arrangement.boxes_of(region).T))
    return [orient(part.simplify(1e-6)) for part in getattr(merged, "geoms", [merged])]


def through_mouths(shapes: list[Polygon], mouths: BaseGeometry, zone: BaseGeometry, path_xy_m: Array) -> list[Polygon]:
    """Shapes joined through wide gaps of walls, but for those glimpsed there: never entered, and with more open sides of their own."""
    from scipy.sparse import coo_array
    from scipy.sparse.csgraph import connected_components

    near = mouths.buffer(SAME_LINE_M)
    joinable = [k for k, shape in enumerate(shapes) if shape.intersects(near) and not _glimpsed(shape, near, zone, path_xy_m)]
    openings = [shapes[k].boundary.intersection(near).buffer(2 * SAME_LINE_M) for k in joinable]
    pairs = [(a, b) for a, b in combinations(range(len(joinable)), 2) if openings[a].intersection(openings[b]).length > CELL_M]
    table = np.array(pairs, dtype=np.int64).reshape(-1, 2)
    size = len(joinable)
    label = connected_components(coo_array((np.ones(len(table)), (table[:, 0], table[:, 1])), shape=(size, size)), directed=False)[1]
    groups = [unary_union([shapes[k] for k, one in zip(joinable, label, strict=True) if one == number]) for number in np.unique(label)]
    joined = [orient(part.simplify(1e-6)) for group in groups for part in getattr(group, "geoms", [group])]
    return [shape for k, shape in enumerate(shapes) if k not in joinable] + joined


def _glimpsed(shape: Polygon, mouths: BaseGeometry, zone: BaseGeometry, path_xy_m: Array) -> bool:
    """Whether a space was not entered and has more open sides than its mouths."""
    visited = len(path_xy_m) and shape.intersects(MultiPoint(path_xy_m))
    sides = shape.boundary.difference(mouths)
    return not visited and bool(sides.intersection(zone).length < MIN_ENCLOSED * sides.length)


def with_niches(shapes: list[Polygon], weak: BaseGeometry, zone: BaseGeometry) -> list[Polygon]:
    """Small shapes that are closed but for a weak barrier are niches of what lies before it; `zone` is what all barriers cover."""
    weak_zone = weak.buffer(SAME_LINE_M)
    result: list[Polygon] = []
    for shape in sorted(shapes, key=lambda shape: -float(shape.area)):
        host = _host(shape, result, weak_zone, zone) if shape.area < MAX_NICHE_M2 else None
        joined = None if host is None else unary_union([result[host], shape])
        if host is not None and isinstance(joined, Polygon):
            result[host] = orient(joined.simplify(1e-6))
        else:
            result.append(shape)
    return result


def _host(niche: Polygon, larger: list[Polygon], weak_zone: BaseGeometry, zone: BaseGeometry) -> int | None:
    """The shape (index) before the weak barrier of a niche; None where it has none or is open elsewhere too."""
    mouth, rest = niche.boundary.intersection(weak_zone), niche.boundary.difference(weak_zone)
    if mouth.length <= CELL_M or rest.intersection(zone).length < MIN_ENCLOSED * rest.length:
        return None
    before = mouth.buffer(SAME_LINE_M)
    shared = [float(before.intersection(shape.boundary).length) for shape in larger]
    best = max(range(len(shared)), key=lambda k: shared[k], default=None)
    return best if best is not None and shared[best] > CELL_M else None


def _room(shape: Polygon, lines: BaseGeometry, path_xy_m: Array) -> Room | None:
    """A room of a polygon, or None when it is but open space seen from afar."""
    enclosed = shape.boundary.intersection(lines).length / shape.boundary.length
    visited = shape.intersects(MultiPoint(path_xy_m)) if len(path_xy_m) else False
    circle = maximum_inscribed_circle(shape, tolerance=CELL_M)
    if not visited and (enclosed < MIN_GLIMPSE_ENCLOSED or 2 * circle.length < MIN_GLIMPSE_WIDTH_M):
        return None
    return Room(
        "",
        _kind(shape),
        "",
        _ring(shape.exterior.coords),
        float(shape.area),
        0.0,
        tuple(_ring(hole.coords) for hole in shape.interiors),
        (float(circle.coords[0][0]), float(circle.coords[0][1])),
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


def _named(room: Room, number: int) -> Room:
    word = "Corridor" if room.kind is RoomKind.CORRIDOR else "Room"
    return replace(room, id=f"R{number}", name=f"{word} {number}")
