"""Dimensions outside the plan: for each side a chain from corner to corner of the rooms along it, and the length over all.

No distance is drawn twice: a bay that is a size of the room beside it is that dimension, moved out into the chain.
"""

from dataclasses import dataclass, field, replace
from itertools import pairwise

import numpy as np
import shapely
from shapely.geometry import LineString, Polygon
from shapely.geometry.base import BaseGeometry

from floorplan.model.checks import Array
from floorplan.model.normal import NORMAL_95
from floorplan.model.plan import Dimension, DimensionRole, Point, Room
from floorplan.plan.corners import FaceRun
from floorplan.plan.room_facts import face_under

MIN_EDGE_M = 0.5  # shorter pieces of a room's outline, pilasters and rebates, begin no bay
SAME_LINE_M = 0.02  # corners nearer than this are one line in a drawing
MIN_JOG_M = 0.12  # surfaces of equal facing nearer than this, rebates and pilasters, begin no bay either
MAX_UNSURE_SHARE = 0.35  # of a bay that its 95 % interval may take up: a thin wall as unsure as this has no thickness worth a number
PROBE_M = 0.01  # how far inside its room an edge is looked along
CROSSED_M = 0.05  # more of a room than this in the way hides a corner from the side
CHAIN_OUT_M, OVERALL_OUT_M = 1.0, 1.6  # outside the rooms; a sheet spaces them by its own scale


@dataclass(frozen=True)
class Stop:
    """A corner that a chain stops at: plane (row) and facing, coordinate, the corner, length of the edge it ends, its rooms."""

    plane: int
    facing: int
    offset_m: float
    at: Point
    length_m: float
    rooms: frozenset[str]


@dataclass(frozen=True)
class Side:
    """A side of the building: the chain runs along `axis`; it lies below (-1) or above (+1) the rooms on the other axis."""

    axis: int
    outward: int


SIDES = (Side(0, -1), Side(1, -1), Side(0, 1), Side(1, 1))  # bottom and left first: the others only say what these do not


def outside_chains(
    faces: tuple[FaceRun, ...],
    rooms: tuple[Room, ...],
    sizes: tuple[Dimension, ...],
    covariance_m2: Array,
    plane_ids: tuple[str, ...],
) -> tuple[Dimension, ...]:
    """The `sizes` of rooms, those that a chain repeats moved into it, and the bays and lengths over all that they do not say."""
    if not rooms:
        return sizes
    shape = shapely.union_all([Polygon(room.outline, room.holes) for room in rooms])
    chains = _Chains(list(sizes))
    for side in SIDES:
        stops = side_stops(side, faces, rooms, shape)
        if len(stops) > 1 and not {plane_ids[stop.plane] for stop in stops} <= chains.told(side.axis):
            for role, low, high in _spans(stops):
                chains.add(_dimension(role, side, low, high, shape, covariance_m2, plane_ids), low.rooms & high.rooms, len(stops) == 2)
    return (*chains.sizes, *chains.found)


@dataclass
class _Chains:
    """What stands outside so far: `sizes` of rooms, some of them moved out, and `found`, what is dimensioned outside alone."""

    sizes: list[Dimension]
    found: list[Dimension] = field(default_factory=list)
    drawn: set[tuple[str, str]] = field(default_factory=set)

    def told(self, axis: int) -> set[str]:
        """The planes that chains along an axis stop at so far."""
        outside = [d for d in (*self.sizes, *self.found) if d.axis == axis and (d.from_plane, d.to_plane) in self.drawn]
        return {plane for d in outside for plane in (d.from_plane, d.to_plane)}

    def add(self, new: Dimension, rooms: frozenset[str], alone: bool) -> None:
        """A bay between corners of `rooms`, or a length over all; `alone` when that is all its side would have."""
        ends = new.from_plane, new.to_plane
        if ends in self.drawn or (new.role is DimensionRole.CHAIN and NORMAL_95 * new.sigma_m > MAX_UNSURE_SHARE * new.distance_m):
            return
        same = [k for k, d in enumerate(self.sizes) if (d.from_plane, d.to_plane) == ends]
        if new.role is DimensionRole.OVERALL and alone and same:
            return  # one room from end to end: its size says it
        self.drawn.add(ends)
        beside = [k for k in same if new.role is DimensionRole.OVERALL or self.sizes[k].room in rooms]
        if beside:
            self.sizes[beside[0]] = replace(self.sizes[beside[0]], start=new.start, end=new.end, line=new.line)
        else:
            self.found.append(new)


def side_stops(side: Side, faces: tuple[FaceRun, ...], rooms: tuple[Room, ...], shape: BaseGeometry) -> tuple[Stop, ...]:
    """Corners that can be seen from a side, in order along it: ends of room edges on seen faces with no room before them."""
    found = [stop for room in rooms for ring in (room.outline, *room.holes) for stop in _edges(side, room.id, ring, faces, shape)]
    kept: list[Stop] = []
    for stop in sorted(found, key=lambda stop: (stop.offset_m, -stop.length_m)):
        apart = stop.offset_m - kept[-1].offset_m if kept else np.inf
        if apart >= (MIN_JOG_M if kept and stop.facing == kept[-1].facing else SAME_LINE_M):
            kept.append(stop)
            continue
        longer = max(kept[-1], stop, key=lambda one: one.length_m)
        kept[-1] = replace(longer, rooms=kept[-1].rooms | stop.rooms) if apart < SAME_LINE_M else longer
    return tuple(kept)


def _edges(side: Side, room: str, ring: tuple[Point, ...], faces: tuple[FaceRun, ...], shape: BaseGeometry) -> list[Stop]:
    axis, across = side.axis, 1 - side.axis
    stops = []
    for a, b in zip(ring, (*ring[1:], ring[0]), strict=True):
        length = abs(a[across] - b[across])
        if abs(a[axis] - b[axis]) > PROBE_M or length < MIN_EDGE_M:
            continue
        face = face_under(a, b, axis, faces)
        outer = max(a, b, key=lambda point: side.outward * point[across])
        if face is not None and _in_sight(side, outer, face, shape):
            stops.append(Stop(face.run.plane, face.facing, float(face.offset_m), outer, length, frozenset((room,))))
    return stops


def _in_sight(side: Side, corner: Point, face: FaceRun, shape: BaseGeometry) -> bool:
    """Whether nothing but walls lies between a corner and the outside."""
    x0, y0, x1, y1 = shape.bounds
    far = (y1 if side.axis == 0 else x1) + 1.0 if side.outward > 0 else (y0 if side.axis == 0 else x0) - 1.0
    beside = corner[side.axis] + face.facing * PROBE_M
    start = corner[1 - side.axis] + side.outward * PROBE_M
    ends = [(beside, start), (beside, far)] if side.axis == 0 else [(start, beside), (far, beside)]
    return bool(LineString(ends).intersection(shape).length < CROSSED_M)


def _spans(stops: tuple[Stop, ...]) -> list[tuple[DimensionRole, Stop, Stop]]:
    """The bays between neighbouring stops, and first to last; one bay is the overall length itself."""
    bays = [(DimensionRole.CHAIN, low, high) for low, high in pairwise(stops)] if len(stops) > 2 else []
    return [*bays, (DimensionRole.OVERALL, stops[0], stops[-1])]


def _dimension(
    role: DimensionRole, side: Side, low: Stop, high: Stop, shape: BaseGeometry, covariance_m2: Array, plane_ids: tuple[str, ...]
) -> Dimension:
    edge = shape.bounds[(1 - side.axis) + (2 if side.outward > 0 else 0)]
    out = float(edge + side.outward * (CHAIN_OUT_M if role is DimensionRole.CHAIN else OVERALL_OUT_M))
    middle = (low.offset_m + high.offset_m) / 2
    line = (middle, out) if side.axis == 0 else (out, middle)
    ids = plane_ids[low.plane], plane_ids[high.plane]
    sigma = _sigma_m(low.plane, high.plane, covariance_m2)
    return Dimension("", role, *ids, side.axis, high.offset_m - low.offset_m, sigma, low.at, high.at, line)


def _sigma_m(a: int, b: int, covariance_m2: Array) -> float:
    """Of the distance between two planes. Bays share their ends, so the overall length is not as uncertain as their sigmas added."""
    return float(np.sqrt(max(covariance_m2[a, a] + covariance_m2[b, b] - 2 * covariance_m2[a, b], 0.0)))
