"""Room stamps: their lines, and a place inside the room clear of dimensions."""

from dataclasses import dataclass

from shapely import Polygon, box

from floorplan.model.plan import Plan, Point, Room
from floorplan.writers.occupancy import TEXT_WEIGHT, Occupancy, Rectangle
from floorplan.writers.scale import Scale
from floorplan.writers.text_size import text_width
from floorplan.writers.unit_style import UnitStyle, area_text, ceiling_text

NUMBER_MM, NAME_MM, LINE_MM = 3.0, 2.2, 1.8  # capital heights of the lines of a stamp
LEADING_MM = 1.4  # free space between its lines
GRID = 17  # trial places per side of the room's box
OUTSIDE_COST = 80.0  # a stamp over its own room's walls
DISTANCE_COST = 1.0  # for the whole size of the room: the label point is the best guess
SMALL = 0.7  # stamps that fit no other way are drawn at this size
PARTIAL_MARK = "partly seen"


@dataclass(frozen=True)
class StampLine:
    """One line: attribute tag, text, height of capitals, baseline below the stamp's centre (positive is up), all at size 1."""

    tag: str
    text: str
    height_mm: float
    baseline_mm: float


@dataclass(frozen=True)
class PlacedStamp:
    """A stamp as drawn: `centre` in the plan frame, `size` 1 or `SMALL`."""

    room: Room
    lines: tuple[StampLine, ...]
    centre: Point
    size: float


STAMP_BASELINES_MM = {"NUMBER": 3.6, "NAME": 0.2, "AREA": -3.0, "HEIGHT": -6.2}
STAMP_HEIGHTS_MM = {"NUMBER": NUMBER_MM, "NAME": NAME_MM, "AREA": LINE_MM, "HEIGHT": LINE_MM}


def stamp_texts(room: Room, units: UnitStyle) -> dict[str, str]:
    """Attribute values of a room stamp."""
    name = " - ".join(word for word in (room.name, PARTIAL_MARK if room.partial else "") if word)
    return {
        "NUMBER": room.id,
        "NAME": name,
        "AREA": area_text(room.area_m2, room.area_sigma_m2, units),
        "HEIGHT": ceiling_text(room.ceiling_height_m, room.ceiling_sigma_m, units),
    }


def stamp_lines(room: Room, units: UnitStyle) -> tuple[StampLine, ...]:
    """The lines of a room's stamp that have something to say, in place."""
    return tuple(StampLine(tag, text, STAMP_HEIGHTS_MM[tag], STAMP_BASELINES_MM[tag]) for tag, text in stamp_texts(room, units).items())


def stamp_rectangle(lines: tuple[StampLine, ...], centre: Point, size: float, scale: Scale) -> Rectangle:
    """The box around a stamp in the plan frame."""
    shown = [line for line in lines if line.text]
    width = max(text_width(line.text, line.height_mm, bold=line.tag == "NUMBER") for line in shown) + 2 * LEADING_MM
    top = max(line.baseline_mm + line.height_mm for line in shown) + LEADING_MM / 2
    bottom = min(line.baseline_mm for line in shown) - LEADING_MM / 2
    half = scale.model_m(width * size) / 2
    return Rectangle(centre[0] - half, centre[1] + scale.model_m(bottom * size), centre[0] + half, centre[1] + scale.model_m(top * size))


def place_stamps(plan: Plan, scale: Scale, units: UnitStyle, occupied: Occupancy) -> tuple[PlacedStamp, ...]:
    """A stamp per room; `occupied` gains them."""
    return tuple(_place(room, stamp_lines(room, units), scale, occupied) for room in plan.rooms)


def _place(room: Room, lines: tuple[StampLine, ...], scale: Scale, occupied: Occupancy) -> PlacedStamp:
    polygon = Polygon(room.outline, room.holes)
    reach = max(abs(polygon.bounds[2] - polygon.bounds[0]), abs(polygon.bounds[3] - polygon.bounds[1]), 1e-6)
    trials = []
    for size in (1.0, SMALL):
        for centre in (room.label, *_grid(polygon)):
            rectangle = stamp_rectangle(lines, centre, size, scale)
            cost = occupied.cost(rectangle) + (0.0 if size == 1.0 else OUTSIDE_COST / 4)
            cost += DISTANCE_COST * (abs(centre[0] - room.label[0]) + abs(centre[1] - room.label[1])) / reach
            if not polygon.covers(box(rectangle.x0, rectangle.y0, rectangle.x1, rectangle.y1)):
                cost += OUTSIDE_COST
            trials.append((cost, size, centre))
    _, size, centre = min(trials, key=lambda trial: trial[0])
    occupied.add(stamp_rectangle(lines, centre, size, scale), TEXT_WEIGHT)
    return PlacedStamp(room, lines, centre, size)


def _grid(polygon: Polygon) -> list[Point]:
    x0, y0, x1, y1 = polygon.bounds
    steps = [(index + 0.5) / GRID for index in range(GRID)]
    return [(x0 + (x1 - x0) * u, y0 + (y1 - y0) * v) for u in steps for v in steps]
