"""Room stamps: their lines, and a place inside the room clear of dimensions."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import shapely
from shapely import Polygon

from floorplan.model.checks import Array
from floorplan.model.plan import Plan, Point, Room
from floorplan.writers.occupancy import TEXT_WEIGHT, Occupancy, Rectangle
from floorplan.writers.scale import Scale
from floorplan.writers.text_size import text_width
from floorplan.writers.unit_style import UnitStyle, area_text, ceiling_text

NUMBER_TAG = "NUMBER"
NUMBER_MM, NAME_MM, LINE_MM = 3.0, 2.2, 1.8  # capital heights of the lines of a stamp
LEADING_MM = 1.4  # free space between its lines
GRID = 17  # trial places per side of the room's box
OUTSIDE_COST = 80.0  # a stamp over its own room's walls
DISTANCE_COST = 1.0  # for the whole size of the room: the label point is the best guess
SMALL = 0.7  # stamps that do not fit otherwise are drawn at this size ...
SMALL_COST = 20.0
NUMBER_ONLY_COST = 40.0  # ... and those that do not fit at all show their number alone: the rest is in the schedule
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
    number_only: bool = False

    @property
    def shown(self) -> tuple[StampLine, ...]:
        return tuple(line for line in self.lines if line.text and not (self.number_only and line.tag != NUMBER_TAG))


STAMP_BASELINES_MM = {"NUMBER": 3.6, "NAME": 0.2, "AREA": -3.0, "HEIGHT": -6.2}
STAMP_HEIGHTS_MM = {"NUMBER": NUMBER_MM, "NAME": NAME_MM, "AREA": LINE_MM, "HEIGHT": LINE_MM}


def stamp_texts(room: Room, units: UnitStyle) -> dict[str, str]:
    """Attribute values of a room stamp."""
    name = " - ".join(word for word in (room.name, PARTIAL_MARK if room.partial else "") if word)
    return {
        "NUMBER": room.id,
        "NAME": name,
        "AREA": area_text(room.area_m2, None if room.partial else room.area_sigma_m2, units),
        "HEIGHT": ceiling_text(room.ceiling_height_m, room.ceiling_sigma_m, units),
    }


def stamp_lines(room: Room, units: UnitStyle) -> tuple[StampLine, ...]:
    """The lines of a room's stamp that have something to say, in place."""
    return tuple(StampLine(tag, text, STAMP_HEIGHTS_MM[tag], STAMP_BASELINES_MM[tag]) for tag, text in stamp_texts(room, units).items())


def stamp_rectangle(stamp: PlacedStamp, scale: Scale) -> Rectangle:
    """The box around a stamp in the plan frame."""
    shown, centre, size = stamp.shown, stamp.centre, stamp.size
    width = max(text_width(line.text, line.height_mm, bold=line.tag == NUMBER_TAG) for line in shown) + 2 * LEADING_MM
    top = max(line.baseline_mm + line.height_mm for line in shown) + LEADING_MM / 2
    bottom = min(line.baseline_mm for line in shown) - LEADING_MM / 2
    half = scale.model_m(width * size) / 2
    return Rectangle(centre[0] - half, centre[1] + scale.model_m(bottom * size), centre[0] + half, centre[1] + scale.model_m(top * size))


def place_stamps(plan: Plan, scale: Scale, units: UnitStyle, occupied: Occupancy) -> tuple[PlacedStamp, ...]:
    """A stamp per room; `occupied` gains them."""
    return tuple(_place(room, stamp_lines(room, units), scale, occupied) for room in plan.rooms)


def _place(room: Room, lines: tuple[StampLine, ...], scale: Scale, occupied: Occupancy) -> PlacedStamp:
    polygon = Polygon(room.outline, room.holes)
    forms = ((1.0, False, 0.0), (SMALL, False, SMALL_COST), (1.0, True, NUMBER_ONLY_COST))
    places = (room.label, *_grid(polygon))
    best, best_cost = PlacedStamp(room, lines, room.label, 1.0), float("inf")
    for size, number_only, form_cost in forms:
        if form_cost >= best_cost:
            break
        costs = form_cost + _costs(PlacedStamp(room, lines, room.label, size, number_only), places, polygon, scale, occupied)
        cheapest = int(np.argmin(costs))
        if costs[cheapest] < best_cost:
            best, best_cost = PlacedStamp(room, lines, places[cheapest], size, number_only), costs[cheapest]
    occupied.add(stamp_rectangle(best, scale), TEXT_WEIGHT)
    return best


def _costs(stamp: PlacedStamp, places: Sequence[Point], polygon: Polygon, scale: Scale, occupied: Occupancy) -> Array:
    """What a stamp costs at each (M,) of `places`: what it covers, how far it is from the label point, whether it leaves its room."""
    x0, y0, x1, y1 = polygon.bounds
    here, centre, label = stamp_rectangle(stamp, scale), stamp.centre, stamp.room.label
    boxes = [here.moved(place[0] - centre[0], place[1] - centre[1]) for place in places]
    away = np.abs(np.array(places) - label).sum(axis=1) / max(x1 - x0, y1 - y0)
    inside = shapely.covers(polygon, [shapely.box(box.x0, box.y0, box.x1, box.y1) for box in boxes])
    return np.asarray(occupied.costs(boxes) + DISTANCE_COST * away + np.where(inside, 0.0, OUTSIDE_COST))


def _grid(polygon: Polygon) -> list[Point]:
    x0, y0, x1, y1 = polygon.bounds
    steps = [(index + 0.5) / GRID for index in range(GRID)]
    return [(x0 + (x1 - x0) * u, y0 + (y1 - y0) * v) for u in steps for v in steps]
