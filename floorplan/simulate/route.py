"""Where a surveyor walks: around every block of the corridor grid, into rooms through their doors, and back to the start."""

import itertools
from dataclasses import dataclass

import numpy as np
from shapely.geometry import LineString, Point, Polygon
from shapely.ops import unary_union

from floorplan.model.checks import Array
from floorplan.simulate.building import Building, Opening, Space
from floorplan.simulate.layout import CorridorGrid

BODY_RADIUS_M = 0.25
ROOM_MARGIN_M = 0.95  # one walks about this far from the walls of a room
LOOP_AREA_M2 = 20.0  # one walks round a larger room; into a smaller one one steps and turns on the spot
MIN_LOOP_SIDE_M = 0.7
OVER_LENGTH_M = 2.0  # a route may be this much longer than asked for
LINE_END_M = 0.6  # how far before the end of a dead end one turns


@dataclass(frozen=True)
class Stop:
    """A corner of the route; `spin_rad` is how far the surveyor turns on the spot there, 0 where he walks on."""

    xy: tuple[float, float]
    spin_rad: float = 0.0


@dataclass(frozen=True)
class Route:
    """Stops in order, the doors walked through and the rooms visited."""

    stops: tuple[Stop, ...]
    doors: tuple[str, ...]
    rooms: tuple[str, ...]

    @property
    def length_m(self) -> float:
        """Length of the polyline."""
        return float(LineString([stop.xy for stop in self.stops]).length)

    @property
    def corridor(self) -> Polygon:
        """The area the walker's body sweeps."""
        return LineString([stop.xy for stop in self.stops]).buffer(BODY_RADIUS_M)


def plan_route(building: Building, grid: CorridorGrid, path_m: float, rng: np.random.Generator) -> Route:
    """A route of about `path_m`: the corridor tour, then as many room visits as fit."""
    tour = _corridor_tour(grid, rng)
    doors = [door for door in building.doors if "C1" in door.spaces]
    chosen: list[Opening] = []
    route = _with_visits(building, tour, chosen)
    order = rng.permutation(len(doors))
    for index in order:
        longer = _with_visits(building, tour, [*chosen, doors[index]])
        if longer.length_m < path_m + OVER_LENGTH_M:
            chosen.append(doors[index])
            route = longer
    return route


def _corridor_tour(grid: CorridorGrid, rng: np.random.Generator) -> list[tuple[float, float]]:
    xs = [(a + b) / 2 for a, b in grid.bands_x]
    ys = [(a + b) / 2 for a, b in grid.bands_y]
    if not xs:
        low, high = grid.bounds.x0 + LINE_END_M, grid.bounds.x1 - LINE_END_M
        start = low + (high - low) * float(rng.uniform(0.1, 0.4))
        return [(start, ys[0]), (high, ys[0]), (low, ys[0]), (start, ys[0])]
    tour: list[tuple[float, float]] = []
    hub = (len(xs) // 2, len(ys) // 2)  # every block of the schemes in use touches it
    for i in range(len(xs) - 1):
        for j in range(len(ys) - 1):
            cycle = [(i, j), (i + 1, j), (i + 1, j + 1), (i, j + 1)]
            at = cycle.index(hub) if hub in cycle else 0
            cycle = cycle[at:] + cycle[: at + 1]
            if rng.random() < 0.5:
                cycle = cycle[::-1]
            tour += [(xs[a], ys[b]) for a, b in cycle]
    return [point for index, point in enumerate(tour) if index == 0 or point != tour[index - 1]]


def _with_visits(building: Building, tour: list[tuple[float, float]], doors: list[Opening]) -> Route:
    """The tour with each door's room visited when its door is first passed."""
    stops, used = [Stop(tour[0])], []
    left = list(doors)
    for start, end in itertools.pairwise(tour):
        along = 0 if abs(end[0] - start[0]) > abs(end[1] - start[1]) else 1
        passing = [door for door in left if _passes(door, along, start, end)]
        passing.sort(key=lambda door: abs(door.rect.centre[along] - start[along]))
        for door in passing:
            turn = list(start)
            turn[along] = door.rect.centre[along]
            at = (turn[0], turn[1])
            stops += [Stop(at), *_visit(building, door, at), Stop(at)]
            left.remove(door)
            used.append(door)
        stops.append(Stop(end))
    rooms = tuple(_room_of(building, door).id for door in used)
    return Route(tuple(stops), tuple(door.id for door in used), rooms)


def _passes(door: Opening, along: int, start: tuple[float, float], end: tuple[float, float]) -> bool:
    """Whether the leg runs past the door, in the corridor that the door opens to."""
    low, high = sorted((start[along], end[along]))
    beside = abs(door.rect.centre[1 - along] - start[1 - along])
    return door.along == along and low <= door.rect.centre[along] <= high and beside < 2.2


def _room_of(building: Building, door: Opening) -> Space:
    return building.space(next(space for space in door.spaces if space != "C1"))


def _visit(building: Building, door: Opening, outside: tuple[float, float]) -> list[Stop]:
    """Through the door, a loop along the room's walls (or a turn on the spot), and out."""
    room = _room_of(building, door)
    across = 1 - door.along
    inward = 1.0 if door.rect.centre[across] > outside[across] else -1.0
    inside = list(door.rect.centre)
    inside[across] += inward * (door.rect.size(across) / 2 + 0.75)
    entry = (inside[0], inside[1])
    x0, y0, x1, y1 = room.outline.bounds
    sides = (x1 - x0 - 2 * ROOM_MARGIN_M, y1 - y0 - 2 * ROOM_MARGIN_M)
    if min(sides) < MIN_LOOP_SIDE_M or room.outline.area < LOOP_AREA_M2:
        return [Stop(entry), Stop(_towards(entry, ((x0 + x1) / 2, (y0 + y1) / 2), 0.9), 2 * np.pi), Stop(entry)]
    margin = ROOM_MARGIN_M
    corners = [(x0 + margin, y0 + margin), (x1 - margin, y0 + margin), (x1 - margin, y1 - margin), (x0 + margin, y1 - margin)]
    first = int(np.argmin([np.hypot(c[0] - entry[0], c[1] - entry[1]) for c in corners]))
    loop = corners[first:] + corners[:first]
    return [Stop(entry), *(Stop(c) for c in loop), Stop(loop[0]), Stop(entry)]


def _towards(start: tuple[float, float], goal: tuple[float, float], share: float) -> tuple[float, float]:
    return start[0] + share * (goal[0] - start[0]), start[1] + share * (goal[1] - start[1])


def walkable(building: Building) -> Polygon:
    """Free floor: spaces and door openings, without boxes that stand on the floor."""
    free = unary_union([space.outline for space in building.spaces] + [door.rect.polygon.buffer(1e-4) for door in building.doors])
    low = [solid.outline for solid in building.boxes if solid.z0_m < 1.9]
    return free.difference(unary_union(low)) if low else free


def clearance_m(building: Building, points_xy: Array) -> float:
    """The smallest distance from the points (N, 2) to anything solid; negative when one lies inside it."""
    free = walkable(building)
    edge = free.boundary
    return min(float(edge.distance(Point(p))) * (1 if free.contains(Point(p)) else -1) for p in points_xy)
