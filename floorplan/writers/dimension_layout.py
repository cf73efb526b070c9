"""Where the line and the words of each size inside a room go, so that they can be read: of all places the one that collides least."""

import math
from collections.abc import Iterator
from dataclasses import replace

import numpy as np
from shapely import LineString, Polygon, prepare

from floorplan.model.plan import Dimension, DimensionRole, Plan, Point
from floorplan.writers.chain_layout import outside
from floorplan.writers.dimension_spots import STEP_MM, TEXT_HEIGHT_MM, Spot, point_at, span, spots, text_box
from floorplan.writers.occupancy import LINE_WEIGHT, SYMBOL_WEIGHT, TEXT_WEIGHT, WALL_WEIGHT, Occupancy, Rectangle
from floorplan.writers.placed_dimension import PlacedDimension, dimension_label
from floorplan.writers.scale import Scale
from floorplan.writers.text_size import text_width
from floorplan.writers.unit_style import UnitStyle

LEAVES_ROOM_COST = 60.0  # a room's size belongs inside the room
OFF_FIELD_COST = 60.0  # outside the plan is the place of the chains
ALONG_WALL_COST = 60.0  # a dimension line that runs on a wall line is not seen
BESIDE_WALL_COST = 3.0  # one that runs close beside a wall is taken for a line of it: as dear as five steps aside ...
BESIDE_WALL_MM = 2.5  # ... nearer than this on paper
CROSSES_DOOR_COST = 5.0  # a line through a door's swing
ROOM_SLACK_M = 0.02  # a room's outline and its dimension's ends may differ by rounding
COLLIDES = WALL_WEIGHT  # a place that costs as much lies on a wall, on words or on several lines
RINGS, DIRECTIONS, LINES = 8, 16, 6  # words that find no place at their line are led aside: how far (32 mm), what ways, from how many lines


def place_sizes(plan: Plan, field: Rectangle, scale: Scale, units: UnitStyle, occupied: Occupancy) -> tuple[PlacedDimension, ...]:
    """The sizes of rooms in the plan's order, but for those whose words would lie on others; `occupied` gains words and lines.

    `field` is the plan's own place on the sheet.
    """
    rooms = {room.id: Polygon(room.outline, room.holes).buffer(ROOM_SLACK_M) for room in plan.rooms}
    for polygon in rooms.values():
        prepare(polygon)
    moved_out = {dimension.id for dimension in outside(plan)}
    sizes = [d for d in plan.dimensions if d.role == DimensionRole.ROOM and d.axis < 2 and d.id not in moved_out]
    placer = _Placer(field, scale, units, occupied)
    placed = (placer.place(dimension, rooms.get(dimension.room)) for dimension in sizes)
    return tuple(one for one in placed if one is not None)


class _Placer:
    """What all sizes of a drawing share while they are placed one after the other."""

    def __init__(self, field: Rectangle, scale: Scale, units: UnitStyle, occupied: Occupancy) -> None:
        self.field, self.scale, self.units, self.occupied = field, scale, units, occupied

    def place(self, dimension: Dimension, room: Polygon | None) -> PlacedDimension | None:
        text = dimension_label(dimension, self.units)
        width = self.scale.model_m(text_width(text, TEXT_HEIGHT_MM))
        best, cost = self.cheapest(dimension, width, room)
        aside = self.led_aside(dimension, width, room) if cost >= COLLIDES else None
        if aside is None and cost >= TEXT_WEIGHT:
            return None
        return self.settled(dimension, text, *(aside or (best, None)))

    def cheapest(self, dimension: Dimension, width: float, room: Polygon | None) -> tuple[Spot, float]:
        """The spot that collides least, and what it costs."""
        best, best_cost = None, math.inf
        for line in spots(dimension, width, self.scale):
            if all(spot.cost >= best_cost for spot in line):
                break  # the lines farther aside cost more by themselves
            for spot, words in zip(line, self.words_costs([spot.text_box for spot in line]), strict=True):
                cost = spot.cost + words
                if cost < best_cost:
                    cost += self.line_cost(spot, dimension, room)
                if cost < best_cost:
                    best, best_cost = spot, cost
        if best is None:
            raise ValueError(f"dimension {dimension.id} has no finite place: {dimension}")
        return best, best_cost

    def words_costs(self, boxes: list[Rectangle]) -> list[float]:
        costs = self.occupied.costs(boxes)
        return [float(cost) + (0.0 if self.field.holds(box) else OFF_FIELD_COST) for box, cost in zip(boxes, costs, strict=True)]

    def line_cost(self, spot: Spot, dimension: Dimension, room: Polygon | None) -> float:
        """What the line alone costs: words under it, a wall or a door along it, a room left."""
        axis, box = dimension.axis, spot.line_box(self.scale)
        low, high = span(dimension)
        cost = self.occupied.cost(box, at_least=TEXT_WEIGHT)
        cost += ALONG_WALL_COST * self.occupied.covered_share(box, axis, WALL_WEIGHT)
        beside = Rectangle.around(spot.reach, self.scale.model_m(BESIDE_WALL_MM))
        cost += BESIDE_WALL_COST * self.occupied.covered_share(beside, axis, WALL_WEIGHT)
        cost += CROSSES_DOOR_COST * (self.occupied.covered_share(box, axis, SYMBOL_WEIGHT) > 0)
        line = LineString([point_at(axis, low, spot.across), point_at(axis, high, spot.across)])
        return cost + (0.0 if room is None or room.covers(line) else LEAVES_ROOM_COST)

    def led_aside(self, dimension: Dimension, width: float, room: Polygon | None) -> tuple[Spot, tuple[Point, Point]] | None:
        """The nearest free place for the words off their line, and the leader to it; None where there is none."""
        lines = {spot.across: spot for line in spots(dimension, width, self.scale) for spot in line if not spot.reaches_beyond}
        costs = {across: spot.cost + self.line_cost(spot, dimension, room) for across, spot in lines.items()}
        for across in sorted(lines, key=lambda key: costs[key])[:LINES]:
            if costs[across] >= COLLIDES:
                return None
            low, high = span(dimension)
            foot = point_at(dimension.axis, (low + high) / 2, across)
            centre = self.free_centre(foot, width)
            if centre is not None:
                box = text_box(centre, width, self.scale, 0.0)
                spot = replace(lines[across], text_centre=centre, text_rotation_deg=0.0, text_box=box)
                return spot, (foot, _edge_towards(box, foot))
        return None

    def free_centre(self, foot: Point, width: float) -> Point | None:
        """The nearest centre for words that lie on nothing and whose leader crosses no words and, if it can be helped, no wall."""
        around = _around(foot, self.scale.model_m(STEP_MM))
        places = [(centre, text_box(centre, width, self.scale, 0.0)) for centre in around]
        places = [(centre, box) for centre, box in places if self.field.holds(box)]
        free = self.occupied.free([box for _, box in places], 0.0)
        centres = [places[k][0] for k in np.flatnonzero(free)]
        leaders = [Rectangle.around((foot, centre)) for centre in centres]
        for barrier in (WALL_WEIGHT, TEXT_WEIGHT):
            open_to = np.flatnonzero(self.occupied.free(leaders, barrier))
            if len(open_to):
                return centres[int(open_to[0])]
        return None

    def settled(self, dimension: Dimension, text: str, spot: Spot, leader: tuple[Point, Point] | None) -> PlacedDimension:
        axis, line_box = dimension.axis, spot.line_box(self.scale)
        line = (point_at(axis, dimension.start[axis], spot.across), point_at(axis, dimension.end[axis], spot.across))
        extended = (not self.occupied.touches(line[0], WALL_WEIGHT), not self.occupied.touches(line[1], WALL_WEIGHT))
        self.occupied.add(spot.text_box, TEXT_WEIGHT)
        self.occupied.add(line_box, LINE_WEIGHT)
        if leader is not None:
            self.occupied.add(Rectangle.around(leader), LINE_WEIGHT)
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
            leader=leader,
        )


def _around(centre: Point, step: float) -> Iterator[Point]:
    """Points on rings about a centre, nearest first."""
    for ring in range(1, RINGS + 1):
        for way in range(DIRECTIONS):
            angle = math.tau * way / DIRECTIONS
            yield centre[0] + ring * step * math.cos(angle), centre[1] + ring * step * math.sin(angle)


def _edge_towards(box: Rectangle, point: Point) -> Point:
    """The point of a box that is nearest to another point."""
    return min(max(point[0], box.x0), box.x1), min(max(point[1], box.y0), box.y1)
