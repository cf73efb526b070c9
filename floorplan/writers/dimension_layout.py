"""Where each dimension's line and text go, so that they can be read: aside or along until nothing collides."""

from dataclasses import dataclass

from shapely import LineString, Polygon

from floorplan.model.plan import Dimension, DimensionRole, Plan, Point
from floorplan.writers.occupancy import LINE_WEIGHT, TEXT_WEIGHT, Occupancy, Rectangle
from floorplan.writers.scale import Scale
from floorplan.writers.text_size import text_width
from floorplan.writers.unit_style import UnitStyle, distance_text

TEXT_HEIGHT_MM = 1.8  # ISO 3098, the smallest size of lettering
TEXT_GAP_MM = 0.8  # between dimension line and text
TICK_MM = 1.2  # half length of the oblique stroke is half of this
CLEARANCE_MM = 0.7  # kept free around text
SIDE_STEP_MM = 4.0  # trials aside: one line of text and its gap
SIDE_STEPS = 12
LEAVES_ROOM_COST = 60.0
ASIDE_COST = 0.6  # per step: the plan's own place is the best guess
OUTSIDE_COST = 6.0  # text beyond the end of its dimension line
WIDE_COST = 8.0  # text wider than its dimension, yet centred


@dataclass(frozen=True)
class PlacedDimension:
    """A dimension as drawn, plan frame, metres: measured points, ends of the dimension line, centre of the text.

    `line_reach` are the ends of the line as drawn: it runs on under text that stands beside the measured stretch.
    """

    dimension: Dimension
    text: str
    line: tuple[Point, Point]
    line_reach: tuple[Point, Point]
    text_centre: Point
    text_rotation_deg: float
    text_box: Rectangle
    line_box: Rectangle


@dataclass(frozen=True)
class _Trial:
    across: float  # coordinate of the dimension line, perpendicular to it
    along: float  # centre of the text, along it
    cost: float


def dimension_label(dimension: Dimension, units: UnitStyle) -> str:
    """`D1  5.432 m ±0.012`."""
    return f"{dimension.id}  {distance_text(dimension.distance_m, dimension.sigma_m, units)}"


def place_dimensions(plan: Plan, scale: Scale, units: UnitStyle, occupied: Occupancy) -> tuple[PlacedDimension, ...]:
    """All drawn dimensions (heights are listed only) in the plan's order; `occupied` gains their text and lines."""
    rooms = {room.id: Polygon(room.outline, room.holes).buffer(0.02) for room in plan.rooms}
    centre = _middle(plan)
    placed = []
    for dimension in plan.dimensions:
        if dimension.role == DimensionRole.HEIGHT or dimension.axis > 1:
            continue
        placed.append(_place(dimension, rooms.get(dimension.room), centre, scale, units, occupied))
    return tuple(placed)


def _middle(plan: Plan) -> Point:
    points = [point for face in plan.faces for point in (face.start, face.end)]
    points += [point for wall in plan.walls for line in wall.seen for point in line]
    if not points:
        return 0.0, 0.0
    box = Rectangle.around(points)
    return (box.x0 + box.x1) / 2, (box.y0 + box.y1) / 2


def _place(
    dimension: Dimension, room: Polygon | None, centre: Point, scale: Scale, units: UnitStyle, occupied: Occupancy
) -> PlacedDimension:
    text = dimension_label(dimension, units)
    width = scale.model_m(text_width(text, TEXT_HEIGHT_MM))
    ends = sorted((dimension.start[dimension.axis], dimension.end[dimension.axis]))
    trials = [
        _tried(dimension, room, across, along, width, scale, occupied, extra)
        for across, extra in _sides(dimension, centre, scale)
        for along in _positions(ends[0], ends[1], width, scale)
    ]
    best = min(trials, key=lambda trial: trial.cost)
    return _settle(dimension, text, width, best, scale, occupied)


def _sides(dimension: Dimension, centre: Point, scale: Scale) -> list[tuple[float, float]]:
    """Coordinates to try for the line, each with its cost: both ways inside a room, outwards only for chains."""
    across = dimension.line[1 - dimension.axis]
    step = scale.model_m(SIDE_STEP_MM)
    outward = 1.0 if across >= centre[1 - dimension.axis] else -1.0
    ways = (1.0, -1.0) if dimension.role == DimensionRole.ROOM else (outward,)
    sides = [(across, 0.0)]
    for count in range(1, SIDE_STEPS + 1):
        sides += [(across + way * count * step, count * ASIDE_COST) for way in ways]
    return sides


def _positions(low: float, high: float, width: float, scale: Scale) -> list[float]:
    """Centres of the text along the line: middle, slid to both sides, beyond either end."""
    middle, slack = (low + high) / 2, max(high - low - width, 0.0) / 2
    beyond = width / 2 + scale.model_m(TICK_MM + CLEARANCE_MM)
    return [middle, middle - slack * 0.6, middle + slack * 0.6, high + beyond, low - beyond]


def _tried(
    dimension: Dimension, room: Polygon | None, across: float, along: float, width: float, scale: Scale, occupied: Occupancy, extra: float
) -> _Trial:
    ends = sorted((dimension.start[dimension.axis], dimension.end[dimension.axis]))
    box = _text_box(dimension.axis, across, along, width, scale)
    cost = extra + occupied.cost(box)
    if not ends[0] <= along <= ends[1]:
        cost += OUTSIDE_COST
    elif width > ends[1] - ends[0]:
        cost += WIDE_COST
    line = LineString([_point(dimension.axis, ends[0], across), _point(dimension.axis, ends[1], across)])
    if dimension.role == DimensionRole.ROOM and room is not None and not room.covers(line):
        cost += LEAVES_ROOM_COST
    return _Trial(across, along, cost)


def _text_box(axis: int, across: float, along: float, width: float, scale: Scale) -> Rectangle:
    """The box of the text, above a horizontal line or left of a vertical one, with its clearance."""
    clear = scale.model_m(CLEARANCE_MM)
    height = scale.model_m(TEXT_HEIGHT_MM)
    centre = _text_centre(axis, across, along, scale)
    wide, high = width + 2 * clear, height + 2 * clear
    return Rectangle.centred(centre, *((wide, high) if axis == 0 else (high, wide)))


def _text_centre(axis: int, across: float, along: float, scale: Scale) -> Point:
    offset = scale.model_m(TEXT_GAP_MM + TEXT_HEIGHT_MM / 2)
    return (along, across + offset) if axis == 0 else (across - offset, along)


def _settle(dimension: Dimension, text: str, width: float, best: _Trial, scale: Scale, occupied: Occupancy) -> PlacedDimension:
    axis = dimension.axis
    low, high = sorted((dimension.start[axis], dimension.end[axis]))
    beside = not low <= best.along <= high
    reach_low = min(low, best.along - width / 2) if beside else low
    reach_high = max(high, best.along + width / 2) if beside else high
    reach = (_point(axis, reach_low, best.across), _point(axis, reach_high, best.across))
    text_box = _text_box(axis, best.across, best.along, width, scale)
    line_box = Rectangle.around(reach, scale.model_m(CLEARANCE_MM / 2))
    occupied.add(text_box, TEXT_WEIGHT)
    occupied.add(line_box, LINE_WEIGHT)
    return PlacedDimension(
        dimension=dimension,
        text=text,
        line=(_point(axis, dimension.start[axis], best.across), _point(axis, dimension.end[axis], best.across)),
        line_reach=reach,
        text_centre=_text_centre(axis, best.across, best.along, scale),
        text_rotation_deg=90.0 * axis,
        text_box=text_box,
        line_box=line_box,
    )


def _point(axis: int, along: float, across: float) -> Point:
    return (along, across) if axis == 0 else (across, along)
