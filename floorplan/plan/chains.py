"""Dimensions outside the plan: for each side a chain from corner to corner of the rooms along it, and the length over all."""

from dataclasses import dataclass
from itertools import pairwise

import numpy as np
import shapely
from shapely.geometry import LineString, Polygon
from shapely.geometry.base import BaseGeometry

from floorplan.model.checks import Array
from floorplan.model.plan import Dimension, DimensionRole, Point, Room
from floorplan.plan.corners import FaceRun
from floorplan.plan.room_facts import face_under

MIN_EDGE_M = 0.5  # shorter pieces of a room's outline, pilasters and rebates, begin no bay
SAME_LINE_M = 0.02  # corners nearer than this are one line in a drawing
PROBE_M = 0.01  # how far inside its room an edge is looked along
CROSSED_M = 0.05  # more of a room than this in the way hides a corner from the side
CHAIN_OUT_M, OVERALL_OUT_M = 1.0, 1.6  # outside the rooms; a sheet spaces them by its own scale


@dataclass(frozen=True)
class Stop:
    """A corner that a chain stops at: row of its plane, coordinate, the corner itself, length of the edge it ends."""

    plane: int
    offset_m: float
    at: Point
    length_m: float


@dataclass(frozen=True)
class Side:
    """A side of the building: the chain runs along `axis`; it lies below (-1) or above (+1) the rooms on the other axis."""

    axis: int
    outward: int


SIDES = (Side(0, -1), Side(1, -1), Side(0, 1), Side(1, 1))  # bottom and left first: the others only say what these do not


def outside_chains(
    faces: tuple[FaceRun, ...], rooms: tuple[Room, ...], covariance_m2: Array, plane_ids: tuple[str, ...]
) -> tuple[Dimension, ...]:
    """Chains and overall dimensions of all sides; a side that would repeat the opposite one is left out."""
    if not rooms:
        return ()
    shape = shapely.union_all([Polygon(room.outline, room.holes) for room in rooms])
    found: list[Dimension] = []
    for side in SIDES:
        stops = side_stops(side, faces, rooms, shape)
        told = {end for d in found if d.axis == side.axis for end in (d.from_plane, d.to_plane)}
        if len(stops) > 1 and not {plane_ids[stop.plane] for stop in stops} <= told:
            known = {(d.from_plane, d.to_plane) for d in found if d.role is DimensionRole.OVERALL}
            new = _chain(side, stops, shape, covariance_m2, plane_ids)
            found += [d for d in new if d.role is DimensionRole.CHAIN or (d.from_plane, d.to_plane) not in known]
    return tuple(found)


def side_stops(side: Side, faces: tuple[FaceRun, ...], rooms: tuple[Room, ...], shape: BaseGeometry) -> tuple[Stop, ...]:
    """Corners that can be seen from a side, in order along it: ends of room edges on seen faces with no room before them."""
    found = [stop for room in rooms for ring in (room.outline, *room.holes) for stop in _edges(side, ring, faces, shape)]
    kept: list[Stop] = []
    for stop in sorted(found, key=lambda stop: (stop.offset_m, -stop.length_m)):
        if not kept or stop.offset_m - kept[-1].offset_m >= SAME_LINE_M:
            kept.append(stop)
        elif stop.length_m > kept[-1].length_m:
            kept[-1] = stop
    return tuple(kept)


def _edges(side: Side, ring: tuple[Point, ...], faces: tuple[FaceRun, ...], shape: BaseGeometry) -> list[Stop]:
    axis, across = side.axis, 1 - side.axis
    stops = []
    for a, b in zip(ring, (*ring[1:], ring[0]), strict=True):
        length = abs(a[across] - b[across])
        if abs(a[axis] - b[axis]) > PROBE_M or length < MIN_EDGE_M:
            continue
        face = face_under(a, b, axis, faces)
        outer = max(a, b, key=lambda point: side.outward * point[across])
        if face is not None and _in_sight(side, outer, face, shape):
            stops.append(Stop(face.run.plane, float(face.offset_m), outer, length))
    return stops


def _in_sight(side: Side, corner: Point, face: FaceRun, shape: BaseGeometry) -> bool:
    """Whether nothing but walls lies between a corner and the outside."""
    x0, y0, x1, y1 = shape.bounds
    far = (y1 if side.axis == 0 else x1) + 1.0 if side.outward > 0 else (y0 if side.axis == 0 else x0) - 1.0
    beside = corner[side.axis] + face.facing * PROBE_M
    start = corner[1 - side.axis] + side.outward * PROBE_M
    ends = [(beside, start), (beside, far)] if side.axis == 0 else [(start, beside), (far, beside)]
    return bool(LineString(ends).intersection(shape).length < CROSSED_M)


def _chain(side: Side, stops: tuple[Stop, ...], shape: BaseGeometry, covariance_m2: Array, plane_ids: tuple[str, ...]) -> list[Dimension]:
    """The bays between neighbouring stops, and first to last; one bay is the overall length itself."""
    overall = (DimensionRole.OVERALL, stops[0], stops[-1])
    spans = [(DimensionRole.CHAIN, a, b) for a, b in pairwise(stops)] if len(stops) > 2 else []
    edge = shape.bounds[(1 - side.axis) + (2 if side.outward > 0 else 0)]
    dimensions = []
    for role, low, high in (*spans, overall):
        out = edge + side.outward * (CHAIN_OUT_M if role is DimensionRole.CHAIN else OVERALL_OUT_M)
        middle = (low.offset_m + high.offset_m) / 2
        line = (middle, float(out)) if side.axis == 0 else (float(out), middle)
        ids = plane_ids[low.plane], plane_ids[high.plane]
        sigma = _sigma_m(low.plane, high.plane, covariance_m2)
        dimensions.append(Dimension("", role, *ids, side.axis, high.offset_m - low.offset_m, sigma, low.at, high.at, line))
    return dimensions


def _sigma_m(a: int, b: int, covariance_m2: Array) -> float:
    """Of the distance between two planes. Bays share their ends, so the overall length is not as uncertain as their sigmas added."""
    return float(np.sqrt(max(covariance_m2[a, a] + covariance_m2[b, b] - 2 * covariance_m2[a, b], 0.0)))
