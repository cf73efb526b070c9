"""What is known of a room beyond its outline: the standard deviation of its area, its ceiling."""

from dataclasses import dataclass, replace

import numpy as np
import shapely
from shapely.geometry import LineString, Polygon
from shapely.geometry import Point as ShapelyPoint

from floorplan.model.checks import Array
from floorplan.model.plan import Dimension, DimensionRole, FreeLine, PlanPlane, Room
from floorplan.model.segment import AXIS_Z
from floorplan.plan.corners import FaceRun
from floorplan.plan.free_space import CELL_M
from floorplan.plan.plan_frame import FLOOR_SUPPORT_RATIO, PlanWorld

ON_FACE_M = 1e-4  # an outline lies on a face when it is this near
UNSEEN_EDGE_SIGMA_M = CELL_M  # where an outline lies on no face it is only as good as the grid of free space
MIN_CEILING_SHARE = 0.5  # one level surface must hold this share of the points above a room


@dataclass(frozen=True)
class RoomHeight:
    """Planes of a room's floor and ceiling, rows of the plan's planes."""

    floor: int
    ceiling: int


def described(
    rooms: tuple[Room, ...],
    heights: tuple[RoomHeight | None, ...],
    faces: tuple[FaceRun, ...],
    skewed: tuple[FreeLine, ...],
    planes: tuple[PlanPlane, ...],
    cov: Array,
) -> tuple[Room, ...]:
    """The rooms with the standard deviations of their areas and with their ceilings; `cov` the planes' joint covariance."""
    known = (with_area_sigma(room, faces, skewed, cov) for room in rooms)
    return tuple(with_ceiling(room, height, planes, cov) for room, height in zip(known, heights, strict=True))


def with_area_sigma(room: Room, faces: tuple[FaceRun, ...], skewed: tuple[FreeLine, ...], covariance_m2: Array) -> Room:
    """The room with sigma_A = sqrt(g^T C g), g the length of outline (signed) on each plane: dA = length * d(offset)."""
    gradient = np.zeros(len(covariance_m2))
    loose = 0.0
    for ring in (room.outline, *room.holes):
        for a, b in zip(ring, (*ring[1:], ring[0]), strict=True):
            axis = 0 if abs(a[0] - b[0]) < abs(a[1] - b[1]) else 1
            length = (b[1] - a[1]) if axis == 0 else (a[0] - b[0])  # positive where the room lies below the edge
            face = face_under(a, b, axis, faces)
            if face is None:
                loose += _loose_variance_m4(LineString([a, b]), skewed)
            else:
                gradient[face.run.plane] += length
    return replace(room, area_sigma_m2=float(np.sqrt(max(float(gradient @ covariance_m2 @ gradient), 0.0) + loose)))


def _loose_variance_m4(edge: LineString, skewed: tuple[FreeLine, ...]) -> float:
    """What an edge on no plane adds: known as well as the wall off the axes that it lies on, else as the grid of free space."""
    (x0, y0), (x1, y1) = edge.coords
    oblique = min(abs(x1 - x0), abs(y1 - y0)) > ON_FACE_M
    on = [line.sigma_m for line in skewed if oblique and _lies_on(edge, line)]
    return float((edge.length * min(on, default=UNSEEN_EDGE_SIGMA_M)) ** 2)


def _lies_on(edge: LineString, line: FreeLine) -> bool:
    whole = LineString([line.start, line.end])
    return all(whole.distance(ShapelyPoint(end)) < CELL_M / 10 for end in edge.coords)


def face_under(a: tuple[float, float], b: tuple[float, float], axis: int, faces: tuple[FaceRun, ...]) -> FaceRun | None:
    """The face that an edge of an outline lies on, the one that covers most of it; None where it lies on none."""
    low, high = sorted((a[1 - axis], b[1 - axis]))
    on = [f for f in faces if f.axis == axis and max(abs(f.offset_m - a[axis]), abs(f.offset_m - b[axis])) < ON_FACE_M]
    best = max(on, key=lambda f: min(f.end_m, high) - max(f.start_m, low), default=None)
    return best


@dataclass(frozen=True)
class LevelPoints:
    """The points of floors, ceilings and other level planes: `xy_m (Q, 2)` in order of x, `plane (Q,)`, `weight (Q,)`."""

    xy_m: Array
    plane: Array
    weight: Array


def level_points(world: PlanWorld) -> LevelPoints:
    """All points on level planes."""
    rows = np.flatnonzero(np.append(world.plane_axis == AXIS_Z, False)[world.point_plane])  # NO_PLANE is the last row
    rows = rows[np.argsort(world.point_m[rows, 0], kind="stable")]
    return LevelPoints(world.point_m[rows, :2], world.point_plane[rows], world.point_weight[rows])


def room_height(room: Room, level: LevelPoints, world: PlanWorld) -> RoomHeight | None:
    """Floor and ceiling of a room: the lowest well seen level plane inside its outline, and the one that holds most points above."""
    shape = Polygon(room.outline, room.holes)
    x0, y0, x1, y1 = shape.bounds
    beside = slice(*np.searchsorted(level.xy_m[:, 0], (x0, x1)))
    near = np.flatnonzero((level.xy_m[beside, 1] > y0) & (level.xy_m[beside, 1] < y1)) + beside.start
    inside = near[shapely.contains_xy(shape, *level.xy_m[near].astype(np.float64).T)]
    weight = np.bincount(level.plane[inside], weights=level.weight[inside], minlength=len(world.plane_axis))
    floor = _lowest_plane(weight * (world.plane_facing > 0), world.plane_offset_m)
    ceiling = _main_plane(weight * (world.plane_facing < 0))
    if floor is None or ceiling is None or world.plane_offset_m[ceiling] <= world.plane_offset_m[floor]:
        return None
    return RoomHeight(floor, ceiling)


def _lowest_plane(weight: Array, offset_m: Array) -> int | None:
    """The floor: tables show more of themselves to a camera held above them, but nothing well seen lies below a floor."""
    enough = weight >= FLOOR_SUPPORT_RATIO * max(float(weight.max(initial=0.0)), 1e-9)
    return int(np.argmin(np.where(enough, offset_m, np.inf))) if enough.any() else None


def _main_plane(weight: Array) -> int | None:
    total = weight.sum()
    return int(np.argmax(weight)) if total > 0 and weight.max() >= MIN_CEILING_SHARE * total else None


def with_ceiling(room: Room, height: RoomHeight | None, planes: tuple[PlanPlane, ...], covariance_m2: Array) -> Room:
    """The room with its ceiling height and sigma where floor and ceiling were seen."""
    if height is None:
        return room
    distance = planes[height.ceiling].offset_m - planes[height.floor].offset_m
    return replace(room, ceiling_height_m=distance, ceiling_sigma_m=_sigma_m(height, covariance_m2))


def height_dimensions(
    rooms: tuple[Room, ...], heights: tuple[RoomHeight | None, ...], planes: tuple[PlanPlane, ...], covariance_m2: Array
) -> tuple[Dimension, ...]:
    """Floor to ceiling, once per pair of level planes, in the first room that shows it, one that was visited if there is any."""
    found: dict[RoomHeight, Dimension] = {}
    for room, height in sorted(zip(rooms, heights, strict=True), key=lambda pair: not pair[0].visited):
        if height is not None and height not in found:
            low, high = planes[height.floor], planes[height.ceiling]
            sigma = _sigma_m(height, covariance_m2)
            at = room.label
            found[height] = Dimension(
                "", DimensionRole.HEIGHT, low.id, high.id, AXIS_Z, high.offset_m - low.offset_m, sigma, at, at, at, room.id
            )
    return tuple(found.values())


def _sigma_m(height: RoomHeight, covariance_m2: Array) -> float:
    a, b = height.floor, height.ceiling
    return float(np.sqrt(max(covariance_m2[a, a] + covariance_m2[b, b] - 2 * covariance_m2[a, b], 0.0)))
