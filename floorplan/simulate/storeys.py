"""Several storeys of one shell, one above the other, joined by a spiral stair in a shaft where each walk begins."""

from dataclasses import dataclass, replace

import numpy as np
from scipy.spatial.transform import Rotation, Slerp

from floorplan.model.checks import Array
from floorplan.simulate.building import Building, Rect, SurfaceKind
from floorplan.simulate.route import Route
from floorplan.simulate.surfaces import Surface, surfaces_of, upright
from floorplan.simulate.walk import Walk

SLAB_M = 0.30  # between a storey's highest ceiling and the floor above
SHAFT_HALF_M = 0.5  # a spiral stair of one metre, narrower than any corridor
CLIMB_M_S = 0.35  # upwards on a stair
TOUCH_M = 1e-6


@dataclass(frozen=True)
class Storey:
    """One storey: height of its floor, its spaces and boxes (z from its own floor), its route, rows of the walk on it."""

    floor_m: float
    building: Building
    route: Route
    rows: slice


def storey_height_m(building: Building) -> float:
    """Floor to floor."""
    return max(space.ceiling_m for space in building.spaces) + SLAB_M


def shaft_at(xy: tuple[float, float]) -> Rect:
    """The hole of the stair."""
    x, y = xy
    return Rect(x - SHAFT_HALF_M, y - SHAFT_HALF_M, x + SHAFT_HALF_M, y + SHAFT_HALF_M)


def storey_surfaces(storeys: tuple[Storey, ...]) -> tuple[tuple[Surface, ...], ...]:
    """The surfaces of every storey, in the frame of the lowest; one storey has no shaft."""
    if len(storeys) == 1:
        return (surfaces_of(storeys[0].building),)
    shaft = shaft_at(storeys[0].route.stops[0].xy)
    found = []
    for index, storey in enumerate(storeys):
        cut = [SurfaceKind.CEILING] * (index < len(storeys) - 1) + [SurfaceKind.FLOOR] * (index > 0)
        pieces = [part for s in surfaces_of(storey.building) for part in (_without(s, shaft) if s.kind in cut else [s])]
        if index < len(storeys) - 1:
            pieces += _shaft_sides(storey.building, shaft, storeys[index + 1].floor_m - storey.floor_m)
        found.append(tuple(replace(s, corner=s.corner + np.array([0.0, 0.0, storey.floor_m])) for s in pieces))
    return tuple(found)


def _without(surface: Surface, hole: Rect) -> list[Surface]:
    """A level rectangle without the part under the hole: at most four pieces."""
    (x0, y0), (x1, y1) = surface.corner[:, :2].min(axis=0), surface.corner[:, :2].max(axis=0)
    left, right = max(x0, hole.x0), min(x1, hole.x1)
    bottom, top = max(y0, hole.y0), min(y1, hole.y1)
    if left >= right or bottom >= top:
        return [surface]
    pieces = [(x0, y0, left, y1), (right, y0, x1, y1), (left, y0, right, bottom), (left, top, right, y1)]
    z = surface.corner[0, 2]
    return [
        replace(surface, corner=np.array([[a, b, z], [c, b, z], [c, d, z], [a, d, z]]))
        for a, b, c, d in pieces
        if c - a > TOUCH_M and d - b > TOUCH_M
    ]


def _shaft_sides(building: Building, shaft: Rect, next_floor_m: float) -> list[Surface]:
    """The slab's edges around the hole; they face the stair."""
    ceiling = min((space.ceiling_m for space in building.spaces if space.outline.intersects(shaft.polygon)), default=next_floor_m - SLAB_M)
    corners = [(shaft.x0, shaft.y0), (shaft.x1, shaft.y0), (shaft.x1, shaft.y1), (shaft.x0, shaft.y1)]
    return [
        upright(SurfaceKind.BOX, "shaft", np.array(a), np.array(b), (ceiling, next_floor_m))
        for a, b in zip(corners, [*corners[1:], corners[0]], strict=True)
    ]


def joined(lower: Walk, upper: Walk, floor_m: float, rate_hz: float) -> Walk:
    """`lower`, then up the stair with one turn, then `upper`, which starts `floor_m` above the plane it was walked on."""
    upper_position = upper.position_m + np.array([0.0, 0.0, floor_m])
    rise = upper_position[0] - lower.position_m[-1]
    count = max(int(rise[2] / CLIMB_M_S * rate_hz), 2)
    share = np.arange(1, count) / count
    smooth = share**2 * (3 - 2 * share)
    turn = Rotation.from_rotvec(np.outer(2 * np.pi * smooth, [0.0, 0.0, 1.0]))
    between = Slerp([0.0, 1.0], Rotation.from_matrix(np.stack([lower.world_from_camera[-1], upper.world_from_camera[0]])))
    step_ns = round(1e9 / rate_hz)
    stamps = lower.stamp_ns[-1] + step_ns * np.arange(1, count)
    return Walk(
        np.concatenate((lower.stamp_ns, stamps, stamps[-1] + step_ns + upper.stamp_ns - upper.stamp_ns[0])),
        np.concatenate((lower.position_m, lower.position_m[-1] + smooth[:, None] * rise, upper_position)),
        np.concatenate((lower.world_from_camera, (turn * between(smooth)).as_matrix(), upper.world_from_camera)),
        _yaws(lower, upper, smooth),
    )


def _yaws(lower: Walk, upper: Walk, smooth: Array) -> Array:
    return np.concatenate((lower.yaw_rad, lower.yaw_rad[-1] + smooth * 2 * np.pi, upper.yaw_rad))
