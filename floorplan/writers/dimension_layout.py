"""Where each dimension's line and text go, so that they can be read: of all places the one that collides least."""

from dataclasses import dataclass

from shapely import LineString, Polygon

from floorplan.model.plan import Dimension, DimensionRole, Plan, Point
from floorplan.writers.dimension_spots import TEXT_HEIGHT_MM, Spot, point_at, span, spots
from floorplan.writers.occupancy import LINE_WEIGHT, TEXT_WEIGHT, WALL_WEIGHT, Occupancy, Rectangle
from floorplan.writers.scale import Scale
from floorplan.writers.text_size import text_width
from floorplan.writers.unit_style import UnitStyle, distance_text

LEAVES_ROOM_COST = 60.0  # a room's size belongs inside the room
ROOM_SLACK_M = 0.02  # a room's outline and its dimension's ends may differ by rounding


@dataclass(frozen=True)
class PlacedDimension:
    """A dimension as drawn, plan frame, metres: ends of the dimension line, centre of the text.

    `line_reach` are the ends of the line as drawn: it runs on under text that stands beyond the measured stretch.
    `extended`: whether start and end need an extension line; an end that touches a wall needs none.
    """

    dimension: Dimension
    text: str
    line: tuple[Point, Point]
    line_reach: tuple[Point, Point]
    text_centre: Point
    text_rotation_deg: float
    extended: tuple[bool, bool]
    text_box: Rectangle
    line_box: Rectangle


def dimension_label(dimension: Dimension, units: UnitStyle) -> str:
    """`D1  5.432 m ±0.012`."""
    return f"{dimension.id}  {distance_text(dimension.distance_m, dimension.sigma_m, units)}"


def is_drawn(dimension: Dimension) -> bool:
    """Heights are listed only."""
    return dimension.role != DimensionRole.HEIGHT and dimension.axis < 2


def place_dimensions(plan: Plan, scale: Scale, units: UnitStyle, occupied: Occupancy) -> tuple[PlacedDimension, ...]:
    """All drawn dimensions in the plan's order; `occupied` gains their text and lines."""
    rooms = {room.id: Polygon(room.outline, room.holes).buffer(ROOM_SLACK_M) for room in plan.rooms}
    middle = _middle(plan)
    return tuple(
        _place(dimension, rooms.get(dimension.room), middle, scale, units, occupied) for dimension in plan.dimensions if is_drawn(dimension)
    )


def _middle(plan: Plan) -> Point:
    points = [point for wall in plan.walls for line in wall.seen for point in line]
    if not points:
        return 0.0, 0.0
    box = Rectangle.around(points)
    return (box.x0 + box.x1) / 2, (box.y0 + box.y1) / 2


def _place(
    dimension: Dimension, room: Polygon | None, middle: Point, scale: Scale, units: UnitStyle, occupied: Occupancy
) -> PlacedDimension:
    text = dimension_label(dimension, units)
    width = scale.model_m(text_width(text, TEXT_HEIGHT_MM))
    best, best_cost = None, float("inf")
    for spot in spots(dimension, middle, width, scale):
        if spot.cost >= best_cost:
            continue
        cost = _cost(spot, dimension, room, scale, occupied)
        if cost < best_cost:
            best, best_cost = spot, cost
    if best is None:
        raise ValueError(f"dimension {dimension.id} has no finite place: {dimension}")
    return _settle(dimension, text, best, scale, occupied)


def _cost(spot: Spot, dimension: Dimension, room: Polygon | None, scale: Scale, occupied: Occupancy) -> float:
    cost = spot.cost + occupied.cost(spot.text_box) + occupied.cost(spot.line_box(scale), at_least=TEXT_WEIGHT)
    if dimension.role == DimensionRole.ROOM and room is not None:
        low, high = span(dimension)
        line = LineString([point_at(dimension.axis, low, spot.across), point_at(dimension.axis, high, spot.across)])
        cost += 0.0 if room.covers(line) else LEAVES_ROOM_COST
    return cost


def _settle(dimension: Dimension, text: str, spot: Spot, scale: Scale, occupied: Occupancy) -> PlacedDimension:
    axis, line_box = dimension.axis, spot.line_box(scale)
    line = (point_at(axis, dimension.start[axis], spot.across), point_at(axis, dimension.end[axis], spot.across))
    extended = (not occupied.touches(line[0], WALL_WEIGHT), not occupied.touches(line[1], WALL_WEIGHT))
    occupied.add(spot.text_box, TEXT_WEIGHT)
    occupied.add(line_box, LINE_WEIGHT)
    return PlacedDimension(
        dimension=dimension,
        text=text,
        line=line,
        line_reach=spot.reach,
        text_centre=spot.text_centre,
        text_rotation_deg=spot.text_rotation_deg,
        extended=extended,
        text_box=spot.text_box,
        line_box=line_box,
    )
