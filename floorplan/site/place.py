"""The rigid motion from plan to site grid: least squares over the control points, or a north angle alone."""

from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from floorplan.config import SiteConfig
from floorplan.errors import InputError
from floorplan.laser.spans import unit_mix_up
from floorplan.model.checks import Array
from floorplan.model.normal import NORMAL_95
from floorplan.model.plan import Plan, Point
from floorplan.model.site import ControlPoint, Site
from floorplan.site.control import ControlRow, read_control

SNAP_M = 0.30  # a point given by eye belongs to a corner this near
POINT_SIGMA_M = 0.01  # of a control point where too few are there to tell: a total station on a wall corner
LEAST_SIGMA_M = 0.002  # ... and at least: points that fit by chance promise nothing better
SCALE_SIGMAS = 3.0  # a scale further from 1 than this is told
SWAPPED_GAIN = 5.0  # east and north exchanged fit this many times better
LOUD_M = 0.05  # a point that is missed by more, and ...
LOUD_RATIO = 3.0  # ... by this many times the median of the others, is told


def on_site(plan: Plan, config: SiteConfig) -> Plan:
    """The plan, and each storey, with its place on the site grid; as it is where none was asked for.

    Raises InputError where the control points cannot be meant.
    """
    site = site_of(plan, config)
    if site is None:
        return plan
    return replace(plan, site=site, upper_storeys=tuple(replace(storey, site=site) for storey in plan.upper_storeys))


def site_of(plan: Plan, config: SiteConfig) -> Site | None:
    """By the control points where there are any, else by the north angle."""
    if config.control_file:
        return placed_by(plan, read_control(Path(config.control_file)), config.north_deg)
    return None if config.north_deg is None else Site(-config.north_deg, 0.0, 0.0)


def placed_by(plan: Plan, rows: tuple[ControlRow, ...], north_deg: float | None = None) -> Site:
    """The site by control points: two and more, or one and the north angle."""
    corners = _corners(plan)
    snapped = [_snapped(row, corners) for row in rows]
    here, there = np.array([point for point, _ in snapped]), np.array([row.site for row in rows])
    if len(rows) == 1 and north_deg is None:
        raise InputError("one control point says where, not which way: give another one, or --north DEG as well")
    fit = _fit(here, there, None if len(rows) > 1 else -np.radians(north_deg or 0.0))
    _check_units(here, there)
    _check_swapped(here, there, fit)
    site = Site(float(np.degrees(fit.angle_rad)), float(fit.shift_m[0]), float(fit.shift_m[1]))
    points = []
    for row, (plan_point, at_corner) in zip(rows, snapped, strict=True):
        east, north = site.to_site(plan_point)
        points.append(ControlPoint(row.name, plan_point, row.site, at_corner, (east - row.site[0], north - row.site[1])))
    scale, sigma = _scale(here, there, fit)
    return replace(site, points=tuple(points), scale=scale, scale_sigma=sigma, warnings=_warnings(points, scale, sigma))


@dataclass(frozen=True)
class _Fit:
    angle_rad: float
    shift_m: Array
    rms_m: float


def _fit(here: Array, there: Array, angle_rad: float | None = None) -> _Fit:
    """Turn and shift with the least squares of misses (N, 2); only the shift where the angle is given."""
    a, b = here - here.mean(axis=0), there - there.mean(axis=0)
    if angle_rad is None:
        angle_rad = float(np.arctan2((a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0]).sum(), (a * b).sum()))
    cos, sin = np.cos(angle_rad), np.sin(angle_rad)
    turn = np.array([[cos, -sin], [sin, cos]])
    shift = there.mean(axis=0) - turn @ here.mean(axis=0)
    miss = a @ turn.T - b
    return _Fit(angle_rad, shift, float(np.sqrt((miss**2).sum(axis=1).mean())))


def _scale(here: Array, there: Array, fit: _Fit) -> tuple[float | None, float | None]:
    """Site length over plan length and its standard deviation."""
    a, b = here - here.mean(axis=0), there - there.mean(axis=0)
    spread = float((a**2).sum())
    if len(here) < 2 or spread == 0:
        return None, None
    cos, sin = np.cos(fit.angle_rad), np.sin(fit.angle_rad)
    turned = a @ np.array([[cos, -sin], [sin, cos]]).T
    scale = float((turned * b).sum() / spread)
    free = 2 * len(here) - 4
    sigma = float(np.sqrt(((scale * turned - b) ** 2).sum() / free)) if free > 0 else POINT_SIGMA_M
    return scale, max(sigma, LEAST_SIGMA_M) / float(np.sqrt(spread))


def _check_units(here: Array, there: Array) -> None:
    """Raise InputError where the grid's distances are in other units than metres, or all the same."""
    if len(here) < 2:
        return
    plan_m, site_m = (float(np.linalg.norm(points - points.mean(axis=0), axis=1).max()) for points in (here, there))
    if plan_m < SNAP_M or site_m < SNAP_M:
        raise InputError("the control points lie all at one place; take corners that are far apart")
    if mixed_up := unit_mix_up(site_m, plan_m):
        raise InputError(f"control points: the distance between them {mixed_up}")


def _check_swapped(here: Array, there: Array, fit: _Fit) -> None:
    """Raise InputError where north stands in the column of east."""
    if len(here) > 2 and fit.rms_m > LOUD_M and _fit(here, there[:, ::-1]).rms_m * SWAPPED_GAIN < fit.rms_m:
        raise InputError(
            f"control points: missed by {fit.rms_m:.2f} m as they stand, hardly with east and north exchanged; is 'east' the easting?"
        )


def _warnings(points: list[ControlPoint], scale: float | None, sigma: float | None) -> tuple[str, ...]:
    found = []
    for point in points:
        others = [other.miss_m for other in points if other is not point]
        if len(points) > 2 and point.miss_m > LOUD_M and point.miss_m > LOUD_RATIO * float(np.median(others)):
            miss = f"is missed by {point.miss_m:.3f} m, far more than the others: mistyped, or another corner?"
            found.append(f"control point {point.name} {miss}")
    if scale is not None and sigma is not None and abs(scale - 1) > SCALE_SIGMAS * sigma:
        half = 100 * NORMAL_95 * sigma
        found.append(
            f"lengths on the site grid are {100 * (scale - 1):+.3f} % (+-{half:.3f}) of the plan's: the grid's own scale factor "
            "(a map projection's is within 0.05 %), or a scale error of the scan, which --laser finds; the plan keeps its lengths"
        )
    return tuple(found)


def _corners(plan: Plan) -> Array:
    """Every corner (N, 2) of rooms, columns and walls."""
    rings = [ring for storey in plan.storeys for room in storey.rooms for ring in (room.outline, *room.holes)]
    rings += [column.outline for storey in plan.storeys for column in storey.columns]
    rings += [line for storey in plan.storeys for wall in storey.walls for line in wall.seen if len(line) > 2]
    return np.array([point for ring in rings for point in ring], dtype=float).reshape(-1, 2)


def _snapped(row: ControlRow, corners: Array) -> tuple[Point, bool]:
    """The point at the nearest corner, where it is to be at one and one is near."""
    if not row.snap or not len(corners):
        return row.plan, False
    apart = np.linalg.norm(corners - np.array(row.plan), axis=1)
    nearest = int(np.argmin(apart))
    near = bool(apart[nearest] <= SNAP_M)
    return ((float(corners[nearest, 0]), float(corners[nearest, 1])), True) if near else (row.plan, False)
