"""Walls off the axes as sides of rooms: what rays crossed before them belongs to the room, what lies behind them does not."""

import numpy as np
from shapely import LineString, Polygon, unary_union
from shapely.geometry.base import BaseGeometry
from shapely.geometry.polygon import orient

from floorplan.model.checks import Array
from floorplan.model.plan import FreeLine
from floorplan.plan.arrangement import INSIDE_SHARE
from floorplan.plan.free_space import CELL_M, FreeSpace

REACH_M = 1.0  # cells of the arrangement that a skewed wall cuts lie this near to it
LOOK_M = 0.30  # how far before and behind a wall the rays are counted that tell its sides apart
ON_LINE_M = 1e-4  # outlines lie on the lines but for rounding
MIN_PIECE_M2 = 0.02  # smaller pieces are the grain of the free space


def with_skewed_sides(shapes: list[Polygon], lines: tuple[FreeLine, ...], walls: BaseGeometry, space: FreeSpace) -> list[Polygon]:
    """The shapes of rooms with their boundary on the lines beside them; `walls` what else bounds rooms."""
    result = list(shapes)
    for line in lines:
        across = _free_side(line, space)
        if across is None:
            continue
        near = _strip(line, across, -REACH_M, REACH_M)
        beside = [k for k, shape in enumerate(result) if shape.intersects(near)]
        known = walls.intersection(near.buffer(REACH_M))
        for k in beside:
            others = [result[other].buffer(ON_LINE_M) for other in beside if other != k]
            result[k] = _bounded(result[k], line, across, unary_union([known, *others]), space)
    return result


def line_of(line: FreeLine) -> LineString:
    """A wall off the axes as a line."""
    return LineString([line.start, line.end])


def _free_side(line: FreeLine, space: FreeSpace) -> Array | None:
    """Along the axis most across a line (2,), towards the side that rays crossed; None where both sides or neither are free."""
    run = np.abs(np.subtract(line.end, line.start))
    across = np.array([0.0, 1.0]) if run[0] >= run[1] else np.array([1.0, 0.0])
    one, other = (space.share_of(_strip(line, sign * across, CELL_M, LOOK_M)) > INSIDE_SHARE for sign in (1, -1))
    return None if one == other else across if one else -across


def _strip(line: FreeLine, across: Array, near_m: float, far_m: float) -> Polygon:
    """What lies between two distances off a line, along an axis, so that its ends are as straight as the walls that meet it."""
    start, end = np.array(line.start), np.array(line.end)
    return Polygon([start + near_m * across, end + near_m * across, end + far_m * across, start + far_m * across])


def _bounded(shape: Polygon, line: FreeLine, across: Array, walls: BaseGeometry, space: FreeSpace) -> Polygon:
    """A shape without what lies behind a wall, and with what is free before it and open to the shape."""
    behind = [part for part in _parts(shape.intersection(_strip(line, -across, 0.0, REACH_M))) if space.share_of(part) <= INSIDE_SHARE]
    before = [
        part
        for part in _parts(_strip(line, across, 0.0, REACH_M).difference(shape).difference(walls))
        if space.share_of(part) > INSIDE_SHARE and _is_open(part, shape, walls)
    ]
    if not behind and not before:
        return shape
    changed = unary_union([shape, *(part.buffer(ON_LINE_M) for part in before)]).difference(unary_union(behind))
    whole = max(_parts(changed), key=lambda part: part.area, default=shape)
    return orient(Polygon(whole.exterior, whole.interiors).simplify(2 * ON_LINE_M))


def _is_open(part: Polygon, shape: Polygon, walls: BaseGeometry) -> bool:
    """Whether nothing bounds the shape towards a part."""
    shared = shape.boundary.intersection(part.buffer(2 * ON_LINE_M)).difference(walls.buffer(2 * ON_LINE_M))
    return bool(shared.length > CELL_M)


def _parts(area: BaseGeometry) -> list[Polygon]:
    return [part for part in getattr(area, "geoms", [area]) if isinstance(part, Polygon) and part.area >= MIN_PIECE_M2]
