"""The rigid motion from plan to site grid: least squares over the control points, or a north angle alone."""

from dataclasses import replace
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
from floorplan.site.fit import LOUD_M, Fit, OddPoint, fit_points, odd_point

SNAP_M = 0.30  # a point given by eye belongs to a corner this near
POINT_SIGMA_M = 0.01  # of a control point where too few are there to tell: a total station on a wall corner
LEAST_SIGMA_M = 0.002  # ... and at least: points that fit by chance promise nothing better
SCALE_SIGMAS = 3.0  # a scale further from 1 than this is told
SWAPPED_GAIN = 5.0  # east and north exchanged fit this many times better
LEFT_OUT_M = 0.30  # a point that the others place further away is mistyped, or another corner: it must not turn the plan
REFUSED_M, REFUSED_SHARE = 1.0, 0.02  # points that miss by more, and by more of their distance, are not those of this plan
SAME_NORTH_DEG = 1.0  # a north angle this near that of the control points says the same


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
    _check_units(here, there)
    odd = odd_point(here, there)
    used = np.array([odd is None or odd.miss_m <= LEFT_OUT_M or row != odd.row for row in range(len(rows))])
    fit = fit_points(here[used], there[used], None if len(rows) > 1 else -np.radians(north_deg or 0.0))
    _check_swapped(here, there, fit_points(here, there) if len(rows) > 1 else fit)
    _check_fit(rows, used, fit.missed_m(here, there), float(np.ptp(there, axis=0).max()))
    site = Site(float(np.degrees(fit.angle_rad)), float(fit.shift_m[0]), float(fit.shift_m[1]))
    points = []
    for row, (plan_point, at_corner) in zip(rows, snapped, strict=True):
        east, north = site.to_site(plan_point)
        points.append(ControlPoint(row.name, plan_point, row.site, at_corner, (east - row.site[0], north - row.site[1])))
    scale, sigma = _scale(here[used], there[used], fit)
    warnings = (*_odd_words(odd, rows), *_north_words(site, north_deg, len(rows)), *_scale_words(scale, sigma))
    return replace(site, points=tuple(points), scale=scale, scale_sigma=sigma, warnings=warnings)


def _scale(here: Array, there: Array, fit: Fit) -> tuple[float | None, float | None]:
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


def _check_swapped(here: Array, there: Array, fit: Fit) -> None:
    """Raise InputError where north stands in the column of east."""
    if len(here) > 2 and fit.rms_m > LOUD_M and fit_points(here, there[:, ::-1]).rms_m * SWAPPED_GAIN < fit.rms_m:
        raise InputError(
            f"control points: missed by {fit.rms_m:.2f} m as they stand, hardly with east and north exchanged; is 'east' the easting?"
        )


def _check_fit(rows: tuple[ControlRow, ...], used: Array, miss_m: Array, across_m: float) -> None:
    """Raise InputError where the points that place the plan miss by metres."""
    worst = float(miss_m[used].max())
    if worst > max(REFUSED_M, REFUSED_SHARE * across_m):
        told = ", ".join(f"{row.name} {miss:.2f} m" for row, miss in zip(rows, miss_m, strict=True))
        raise InputError(f"control points: missed by up to {worst:.2f} m ({told}): mistyped, mixed up, or not of this plan; check them")


def _odd_words(odd: OddPoint | None, rows: tuple[ControlRow, ...]) -> tuple[str, ...]:
    """The one point that the others contradict."""
    if odd is None:
        return ()
    left_out = "; it is left out" if odd.miss_m > LEFT_OUT_M else ""
    miss = f"is missed by {odd.miss_m:.3f} m from where the others put it, and they agree: mistyped, or another corner?"
    return (f"control point {rows[odd.row].name} {miss}{left_out}",)


def _north_words(site: Site, north_deg: float | None, points: int) -> tuple[str, ...]:
    """A north angle beside control points, which know better."""
    if north_deg is None or points < 2:
        return ()
    apart = (north_deg - site.north_deg + 180.0) % 360.0 - 180.0
    if abs(apart) <= SAME_NORTH_DEG:
        return ()
    found = f"the control points have north at {round(site.north_deg, 2) % 360.0:.2f} degrees"
    return (f"north at {north_deg:g} degrees is not used: {found}, {abs(apart):.1f} away; leave one of the two out",)


def _scale_words(scale: float | None, sigma: float | None) -> tuple[str, ...]:
    """A scale that the points ask for, where it is sure."""
    if scale is None or sigma is None or abs(scale - 1) <= SCALE_SIGMAS * sigma:
        return ()
    half = 100 * NORMAL_95 * sigma
    return (
        f"lengths on the site grid are {100 * (scale - 1):+.3f} % (+-{half:.3f}) of the plan's: the grid's own scale factor "
        "(a map projection's is within 0.05 %), or a scale error of the scan, which --laser finds; the plan keeps its lengths",
    )


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
