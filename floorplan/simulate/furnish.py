"""Furniture, columns and the clutter of a preset, placed where nobody walks."""

import itertools
from dataclasses import replace

import numpy as np
from shapely.geometry import Polygon
from shapely.ops import unary_union

from floorplan.simulate.building import Box, BoxKind, Building, Opening, OpeningKind, Space, SpaceKind, rect_along
from floorplan.simulate.route import Route

CLEAR_OF_PATH_M = 0.30  # kept free beside the walker's body
DOOR_ZONE_M = 0.9  # kept free on both sides of a door
OPENING_ZONE_M = 0.15  # kept free of piers
HEAD_ROOM_M = 1.9  # what hangs higher stands in nobody's way
DARK_SHARE = 0.15  # of the furniture: black lacquer, screens, cloth
CORRIDOR_DENSITY = 0.35
BEAM_PITCH_M = (1.8, 2.8)
MULLION_PITCH_M = 0.95
PIER_LENGTH_M, PIER_DEPTH_M, PIER_GAP_M = (0.4, 1.8), (0.10, 0.40), (0.3, 2.2)
MULLION_M = 0.05
TOUCH_M = 1e-6


def furnish(building: Building, route: Route, rng: np.random.Generator) -> Building:
    """The building with columns and furniture (no taller than 1.25 m)."""
    building = _with_columns(building, route, rng)
    boxes: list[Box] = list(building.boxes)
    for space in building.spaces:
        standing = [solid.outline for solid in building.boxes if solid.z0_m < HEAD_ROOM_M]
        keep_free = unary_union([keep_out(building, space, route), *standing])
        boxes += _along_walls(space, keep_free, rng)
        if space.kind is SpaceKind.ROOM:
            boxes += _tables(space, unary_union([keep_free, *[b.outline for b in boxes]]), rng)
    return replace(building, boxes=tuple(boxes))


def keep_out(building: Building, space: Space, route: Route) -> Polygon:
    """Where nothing may stand in a space: the path and the doors' swing."""
    zones = [route.corridor.buffer(CLEAR_OF_PATH_M)]
    zones += [door.rect.polygon.buffer(DOOR_ZONE_M, join_style="mitre") for door in building.doors if space.id in door.spaces]
    return unary_union(zones)


def _with_columns(building: Building, route: Route, rng: np.random.Generator) -> Building:
    """Free-standing columns in large rooms, as holes of the room."""
    spaces = []
    for space in building.spaces:
        outline = space.outline
        if space.kind is SpaceKind.ROOM and outline.area > 22.0 and rng.random() < 0.5:
            x0, y0, x1, y1 = outline.bounds
            size = float(rng.uniform(0.3, 0.5))
            at = (x0 + (x1 - x0) * rng.uniform(0.3, 0.7), y0 + (y1 - y0) * rng.uniform(0.3, 0.7))
            column = rect_along(0, (round(at[0], 4), round(at[0] + size, 4)), (round(at[1], 4), round(at[1] + size, 4))).polygon
            if not column.intersects(keep_out(building, space, route)):
                outline = outline.difference(column)
        spaces.append(replace(space, outline=outline))
    return replace(building, spaces=tuple(spaces))


def along_walls(space: Space) -> list[tuple[int, float, float, float, float]]:
    """Straight wall runs of a space's exterior: axis it runs along, low, high, offset, inward sign."""
    points = np.array(space.outline.normalize().exterior.coords)
    runs = []
    for start, end in itertools.pairwise(points):
        along = int(np.argmax(np.abs(end - start)))
        left = np.array([-(end - start)[1], (end - start)[0]])
        inward = -np.sign(left[1 - along])  # shapely's normal form is clockwise: the inside is on the right
        runs.append(
            (along, float(min(start[along], end[along])), float(max(start[along], end[along])), float(start[1 - along]), float(inward))
        )
    return runs


def against_wall(run: tuple[int, float, float, float, float], at: float, length: float, depth: float) -> Polygon:
    """A footprint of `length` x `depth` against a wall run."""
    along, _, _, offset, inward = run
    across = sorted((offset, offset + inward * depth))
    return rect_along(along, (at, at + length), (across[0], across[1])).polygon


def _along_walls(space: Space, keep_free: Polygon, rng: np.random.Generator) -> list[Box]:
    """Desks, drawers, sideboards and shelves along the walls, in corridors fewer."""
    boxes: list[Box] = []
    density = CORRIDOR_DENSITY if space.kind is SpaceKind.CORRIDOR else 1.0
    for run in along_walls(space):
        at = run[1] + float(rng.uniform(0.05, 1.2))
        while at < run[2] - 0.5:
            length, height = float(rng.uniform(0.5, 1.8)), float(rng.uniform(0.42, 1.25))
            depth = float(rng.uniform(0.3, 0.75)) if density == 1.0 else float(rng.uniform(0.25, 0.4))
            foot = against_wall(run, at, length, depth)
            if rng.random() < density * 0.6 and stands_free(foot, space, keep_free, boxes):
                boxes.append(Box(BoxKind.FURNITURE, foot, 0.0, height, bool(rng.random() < DARK_SHARE)))
            at += length + float(rng.uniform(0.1, 2.0)) / density
    return boxes


def stands_free(foot: Polygon, space: Space, keep_free: Polygon, boxes: list[Box]) -> bool:
    """Whether a footprint lies in the space, off the path, and off what already stands there."""
    inside = space.outline.buffer(1e-6).contains(foot)
    return bool(inside and not foot.intersects(keep_free) and not any(foot.intersects(b.outline) for b in boxes))


def _tables(space: Space, taken: Polygon, rng: np.random.Generator) -> list[Box]:
    """A table in the middle of a room, with chairs."""
    x0, y0, x1, y1 = space.outline.bounds
    size = (float(rng.uniform(0.8, 2.2)), float(rng.uniform(0.7, 1.1)))
    middle = ((x0 + x1) / 2 + float(rng.uniform(-0.3, 0.3)), (y0 + y1) / 2 + float(rng.uniform(-0.3, 0.3)))
    table = _centred(middle, size)
    if rng.random() < 0.3 or taken.intersects(table) or not space.outline.contains(table):
        return []
    boxes = [Box(BoxKind.FURNITURE, table, 0.69, 0.74)]
    boxes.append(Box(BoxKind.FURNITURE, _centred(middle, (size[0] * 0.3, 0.2)), 0.0, 0.69))
    for side in (-1, 1):
        chair = _centred((middle[0], middle[1] + side * (size[1] / 2 + 0.3)), (0.45, 0.45))
        if not taken.intersects(chair) and space.outline.contains(chair):
            boxes.append(Box(BoxKind.FURNITURE, chair, 0.0, 0.46, bool(rng.random() < DARK_SHARE)))
    return boxes


def _centred(middle: tuple[float, float], size: tuple[float, float]) -> Polygon:
    return rect_along(0, (middle[0] - size[0] / 2, middle[0] + size[0] / 2), (middle[1] - size[1] / 2, middle[1] + size[1] / 2)).polygon


def add_glass_and_beams(building: Building, route: Route, rng: np.random.Generator) -> Building:
    """Area 6's difficulties: glass walls with mullions, beams under the ceilings, piers 10-40 cm before the walls."""
    openings, boxes = list(building.openings), list(building.boxes)
    for index, door in enumerate(building.doors):
        if "C1" in door.spaces and index % 2 == 0:
            panes = _glass_beside(building, door, rng, len(openings))
            openings += panes
            boxes += [box for pane in panes for box in _mullions(pane)]
    building = _with_piers(replace(building, openings=tuple(openings)), route, rng)
    return replace(building, boxes=(*boxes, *_beams(building.space("C1"), rng)))


def _glass_beside(building: Building, door: Opening, rng: np.random.Generator, count: int) -> list[Opening]:
    """A glass wall in the same wall as a door, on the side that has more room."""
    along = door.along
    reaches = [_reach_of_wall(building.space(space), door) for space in door.spaces]
    low, high = max(reach[0] for reach in reaches) + 0.2, min(reach[1] for reach in reaches) - 0.2
    a, b = door.rect.interval(along)
    sides = [(low, a - 0.15), (b + 0.15, high)]
    best = max(sides, key=lambda side: side[1] - side[0])
    if best[1] - best[0] < 0.9:
        return []
    width = min(best[1] - best[0], float(rng.uniform(1.5, 5.0)))
    span = (best[1] - width, best[1]) if best[1] < a else (best[0], best[0] + width)
    rect = rect_along(along, (round(span[0], 4), round(span[1], 4)), door.rect.interval(1 - along))
    return [Opening(f"O{count + 1}", OpeningKind.GLASS_WALL, rect, along, 0.08, 2.25, door.spaces)]


def _reach_of_wall(space: Space, door: Opening) -> tuple[float, float]:
    """The straight run of the space's wall that holds the door."""
    along = door.along
    for run in _all_runs(space):
        touches = min(abs(run[3] - side) for side in door.rect.interval(1 - along)) < TOUCH_M
        low, high = door.rect.interval(along)
        if run[0] == along and touches and run[1] - TOUCH_M < low and high < run[2] + TOUCH_M:
            return run[1], run[2]
    return door.rect.interval(along)


def _all_runs(space: Space) -> list[tuple[int, float, float, float, float]]:
    runs = along_walls(space)
    for ring in space.outline.interiors:
        runs += along_walls(replace(space, outline=Polygon(ring)))
    return runs


def _mullions(pane: Opening) -> list[Box]:
    low, high = pane.rect.interval(pane.along)
    middle = pane.rect.centre[1 - pane.along]
    count = max(int((high - low) / MULLION_PITCH_M), 1)
    across = (middle - MULLION_M / 2, middle + MULLION_M / 2)
    places = np.linspace(low, high, count + 1)[1:-1]
    return [
        Box(BoxKind.MULLION, rect_along(pane.along, (p - MULLION_M / 2, p + MULLION_M / 2), across).polygon, pane.sill_m, pane.head_m)
        for p in places
    ]


def _beams(corridor: Space, rng: np.random.Generator) -> list[Box]:
    """Beams across the corridor every two metres or so."""
    boxes = []
    x0, y0, x1, y1 = corridor.outline.bounds
    drop, width = float(rng.uniform(0.2, 0.35)), float(rng.uniform(0.2, 0.35))
    for along, (low, high) in ((0, (x0, x1)), (1, (y0, y1))):
        at = low + 1.5
        while at < high - 1.5:
            across = (y0, y1) if along == 0 else (x0, x1)
            strip = rect_along(along, (at, at + width), across).polygon.intersection(corridor.outline)
            for part in getattr(strip, "geoms", [strip]):
                if part.area > 0 and part.bounds[3 - along] - part.bounds[1 - along] < 3.2:
                    boxes.append(Box(BoxKind.BEAM, part.envelope, corridor.ceiling_m - drop, corridor.ceiling_m - 1e-4))
            at += float(rng.uniform(*BEAM_PITCH_M))
    return boxes


def _with_piers(building: Building, route: Route, rng: np.random.Generator) -> Building:
    """Steps of 10 to 40 cm in the walls of corridors and rooms: planes close to one another."""
    spaces = []
    for space in building.spaces:
        outline, keep_free = space.outline, route.corridor.buffer(CLEAR_OF_PATH_M)
        zones = [o.rect.polygon.buffer(OPENING_ZONE_M) for o in building.openings if space.id in o.spaces]
        for run in _all_runs(space):
            at = run[1] + float(rng.uniform(0.3, 2.0))
            while at < run[2] - 0.6:
                length, depth = float(rng.uniform(*PIER_LENGTH_M)), float(rng.uniform(*PIER_DEPTH_M))
                inward = run if space.outline.contains(against_wall(run, at, 0.1, depth).centroid) else (*run[:4], -run[4])
                pier = against_wall(inward, round(at, 4), round(length, 4), round(depth, 4))
                blocked = pier.intersects(keep_free) or any(pier.intersects(zone) for zone in zones)
                if not blocked and outline.buffer(1e-6).contains(pier):
                    outline = outline.difference(pier.buffer(1e-7, join_style="mitre"))
                at += (0.3 if blocked else length) + float(rng.uniform(*PIER_GAP_M))
        spaces.append(replace(space, outline=outline))
    return replace(building, spaces=tuple(spaces))
