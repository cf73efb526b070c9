"""What `--hard` adds: biased depth, tall cabinets, open door leaves, a wandering tilt, worse odometry."""

from dataclasses import replace

import numpy as np
from shapely.affinity import rotate
from shapely.geometry import Polygon

from floorplan.simulate.building import Box, BoxKind, Building, Opening, SpaceKind, rect_along
from floorplan.simulate.furnish import against_wall, along_walls, keep_out, stands_free
from floorplan.simulate.route import Route

DEPTH_SCALE_ERROR = 0.004
RIPPLE_M = 0.006
RIPPLE_PERIOD_M = 0.75
FIXED_PATTERN_M = 0.008
TILT_WANDER_RAD = np.radians(0.4)
ODOMETRY_ERROR = (0.02, 0.03)

CABINET_HEIGHT_M = (1.6, 2.0)
CABINET_DEPTH_M = (0.35, 0.6)
CABINET_LENGTH_M = (0.8, 2.4)
LEAF_THICKNESS_M = 0.04
LEAF_OPEN_DEG = (70.0, 110.0)
LEAF_SHARE = 0.6


def add_hard_objects(building: Building, route: Route, rng: np.random.Generator) -> Building:
    """The building with tall cabinets against walls and with door leaves standing open."""
    boxes: list[Box] = list(building.boxes)
    for door in building.doors:
        if rng.random() < LEAF_SHARE:
            leaf = _leaf(door, building, route, rng)
            boxes += [leaf] if leaf is not None else []
    for space in building.spaces:
        keep_free = keep_out(building, space, route)
        runs = along_walls(space)
        wanted = 3 if space.kind is SpaceKind.CORRIDOR else int(rng.integers(1, 3))
        for _ in range(wanted * 4):
            run = runs[int(rng.integers(len(runs)))]
            length, depth = float(rng.uniform(*CABINET_LENGTH_M)), float(rng.uniform(*CABINET_DEPTH_M))
            if wanted == 0 or run[2] - run[1] < length:
                continue
            foot = against_wall(run, float(rng.uniform(run[1], run[2] - length)), length, depth)
            if stands_free(foot, space, keep_free, boxes):
                boxes.append(Box(BoxKind.CABINET, foot, 0.0, float(rng.uniform(*CABINET_HEIGHT_M))))
                wanted -= 1
    return replace(building, boxes=tuple(boxes))


def _leaf(door: Opening, building: Building, route: Route, rng: np.random.Generator) -> Box | None:
    """A leaf hinged at one jamb on the room's side, opened into the room; None where it would stand in the way."""
    room = building.space(next(space for space in door.spaces if space != "C1"))
    along, across = door.along, 1 - door.along
    low, high = door.rect.interval(along)
    at_low = bool(rng.random() < 0.5)
    inward = 1.0 if room.outline.centroid.coords[0][across] > door.rect.centre[across] else -1.0
    face = door.rect.interval(across)[1 if inward > 0 else 0]
    width = high - low
    closed_along = (low, low + width) if at_low else (high - width, high)
    depth = sorted((face, face + inward * LEAF_THICKNESS_M))
    closed = rect_along(along, closed_along, (depth[0], depth[1])).polygon
    hinge_along = low if at_low else high
    hinge = (hinge_along, face) if along == 0 else (face, hinge_along)
    leaf = _opened(closed, hinge, float(rng.uniform(*LEAF_OPEN_DEG)), door, inward)
    blocked = leaf.intersects(route.corridor) or not room.outline.buffer(0.02).contains(leaf)
    return None if blocked else Box(BoxKind.LEAF, leaf, 0.01, door.head_m - 0.02)


def _opened(closed: Polygon, hinge: tuple[float, float], angle_deg: float, door: Opening, inward: float) -> Polygon:
    """The leaf turned about its hinge, into the room whichever way that is."""
    across = 1 - door.along
    turned = [rotate(closed, sign * angle_deg, origin=hinge) for sign in (-1, 1)]
    return max(turned, key=lambda leaf: inward * (leaf.centroid.coords[0][across] - hinge[across]))
