"""Where a measured distance lies in the plan: which two planes it runs between, and what the plan says of it."""

import math
from dataclasses import dataclass
from itertools import product

import numpy as np

from floorplan.laser.table import LaserRow
from floorplan.model.plan import Dimension, Face, Plan, PlanPlane, Point

LASER_SIGMA_M = 0.002  # a hand-held laser meter's data sheet, +-1.5 to 3 mm, on a plastered wall
SNAP_M = 0.5  # a point given by hand belongs to a face this near
MAX_CANDIDATES = 3  # surfaces named where no wall is
HEAD_START_M = 0.05  # half of a thin partition: faces that look at each other win over the wall's other sides by this much
MAX_SLANT = math.tan(math.radians(10.0))  # a distance is along an axis; two points placed by eye are this slanted at most
UNIT_FACTORS = ((1000.0, "millimetres"), (100.0, "centimetres"), (1 / 0.3048, "feet"), (1 / 0.0254, "inches"))
UNIT_SLACK = 0.05  # a plan is better than this, so a ratio this near a unit's is the unit
HEIGHT_AXIS = 2


@dataclass(frozen=True)
class Span:
    """One row found in the plan: from the plane at the smaller coordinate, `lower`, to `upper` (indices of `plan.planes`).

    `distance_m` and `sigma_m` are the plan's; `laser_sigma_m` the meter's; `start`, `end` points on the two faces.
    """

    row: LaserRow
    lower: int
    upper: int
    axis: int
    distance_m: float
    sigma_m: float
    laser_sigma_m: float
    start: Point
    end: Point
    room: str = ""


def find_span(plan: Plan, row: LaserRow) -> Span | str:
    """The row in the plan, or the sentence that says why it is not there or cannot be meant."""
    plan = next((storey for storey in plan.storeys if any(row.id == d.id.upper() for d in storey.dimensions)), plan)
    found = _by_id(plan, row) if row.start is None or row.end is None else _by_points(plan, row, row.start, row.end)
    if isinstance(found, str):
        return f"line {row.line}: {found}"
    mixed_up = unit_mix_up(row.measured_m, found.distance_m)
    return f"line {row.line}: {row.name} {mixed_up}" if mixed_up else found


def unit_mix_up(measured_m: float, plan_m: float) -> str:
    """The sentence for a value in other units than metres, empty for one that may be metres."""
    ratio = measured_m / plan_m if plan_m > 0 else 1.0
    for factor, unit in UNIT_FACTORS:
        if abs(ratio / factor - 1) < UNIT_SLACK:
            return f"is {measured_m:g}, about {factor:.4g} times the plan's {plan_m:.3f} m: {unit}? The column is in metres"
        if abs(ratio * factor - 1) < UNIT_SLACK:
            return f"is {measured_m:g}, about 1/{factor:.4g} of the plan's {plan_m:.3f} m: metres taken for {unit} and converted?"
    return ""


def distance_sigma_m(plan: Plan, first: int, second: int) -> float:
    """Standard deviation of the distance between two planes from their joint covariance; as if independent without one."""
    covariance = plan.plane_covariance_m2
    if covariance is None:
        return math.hypot(plan.planes[first].sigma_m, plan.planes[second].sigma_m)
    variance = covariance[first, first] + covariance[second, second] - 2 * covariance[first, second]
    return float(np.sqrt(max(variance, 0.0)))


def _by_id(plan: Plan, row: LaserRow) -> Span | str:
    dimension = next((d for d in plan.dimensions if d.id.upper() == row.id), None)
    if dimension is None:
        last = plan.dimensions[-1].id if plan.dimensions else "none"
        return f"no dimension {row.id} in the plan (its dimensions run from D1 to {last}); give two points instead"
    index = {plane.id: k for k, plane in enumerate(plan.planes)}
    return _span(plan, row, (index[dimension.from_plane], index[dimension.to_plane]), dimension)


def _span(plan: Plan, row: LaserRow, ends: tuple[int, int], dimension: Dimension) -> Span:
    first, second = sorted(ends, key=lambda k: plan.planes[k].offset_m)
    sigma = row.sigma_m or LASER_SIGMA_M
    points = dimension.start, dimension.end
    return Span(row, first, second, dimension.axis, dimension.distance_m, dimension.sigma_m, sigma, *points, dimension.room)


def _by_points(plan: Plan, row: LaserRow, first_point: Point, second_point: Point) -> Span | str:
    run = (second_point[0] - first_point[0], second_point[1] - first_point[1])
    axis = 0 if abs(run[0]) >= abs(run[1]) else 1
    if abs(run[1 - axis]) > MAX_SLANT * abs(run[axis]):
        return f"{_at(first_point)} to {_at(second_point)} is not along an axis of the plan; distances are measured square to walls"
    low, high = sorted((first_point, second_point), key=lambda point: point[axis])
    planes = {plane.id: k for k, plane in enumerate(plan.planes)}
    found = []
    for point in (low, high):
        near = _faces_near(plan, planes, point, axis)
        if not near:
            return f"no wall square to {'xy'[axis]} within {SNAP_M:g} m of {_at(point)}" + _undrawn_near(plan, point, axis)
        found.append(near)
    first, second = min(product(*found), key=lambda pair: _badness(plan, planes, pair, (low, high)))
    lower, upper = planes[first.plane], planes[second.plane]
    if lower == upper:
        return f"{_at(low)} and {_at(high)} lie on one wall"
    distance = plan.planes[upper].offset_m - plan.planes[lower].offset_m
    sigma = distance_sigma_m(plan, lower, upper)
    start, end = _on_plane(low, plan.planes[lower]), _on_plane(high, plan.planes[upper])
    return Span(row, lower, upper, axis, distance, sigma, row.sigma_m or LASER_SIGMA_M, start, end)


def _undrawn_near(plan: Plan, point: Point, axis: int) -> str:
    """Words for the surfaces that were seen near a point and are not drawn there as wall; empty where there are none."""
    along = point[1 - axis]
    seen = [p for p in plan.planes if p.axis == axis and p.extent_m[1 - axis][0] - SNAP_M <= along <= p.extent_m[1 - axis][1] + SNAP_M]
    near = sorted((p for p in seen if abs(p.offset_m - point[axis]) <= SNAP_M), key=lambda p: abs(p.offset_m - point[axis]))
    if not near:
        return ""
    told = ", ".join(f"{p.id} at {'xy'[axis]} = {p.offset_m:.3f}" for p in near[:MAX_CANDIDATES])
    return f"; seen there, but not drawn as wall: {told}"


def _faces_near(plan: Plan, planes: dict[str, int], point: Point, axis: int) -> list[Face]:
    across = [face for face in plan.faces if plan.planes[planes[face.plane]].axis == axis]
    return [face for face in across if _distance_m(face, point) <= SNAP_M]


def _distance_m(face: Face, point: Point) -> float:
    """From the point to the straight piece."""
    a, b, p = np.array(face.start), np.array(face.end), np.array(point)
    run = b - a
    share = float(np.clip((p - a) @ run / max(float(run @ run), 1e-12), 0.0, 1.0))
    return float(np.linalg.norm(p - a - share * run))


def _badness(plan: Plan, planes: dict[str, int], pair: tuple[Face, ...], points: tuple[Point, Point]) -> float:
    """How far the two faces lie from the points, plus the head start where they do not look at each other."""
    facing = [plan.planes[planes[face.plane]].facing for face in pair]
    apart = sum(_distance_m(face, point) for face, point in zip(pair, points, strict=True))
    return apart + HEAD_START_M * ((facing[0] < 0) + (facing[1] > 0))


def _on_plane(point: Point, plane: PlanPlane) -> Point:
    return (plane.offset_m, point[1]) if plane.axis == 0 else (point[0], plane.offset_m)


def _at(point: Point) -> str:
    return f"({point[0]:.2f}, {point[1]:.2f})"
