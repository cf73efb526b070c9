"""Floors at distinct heights are storeys when somebody walked on them."""

from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest

from floorplan.model.checks import Array
from floorplan.model.scan import Trajectory
from floorplan.model.segment import AXIS_X, AXIS_Y, AXIS_Z, FreePatches
from floorplan.plan.plan_frame import PlanWorld
from floorplan.plan.storeys import floor_heights_m, frames_of_storeys, patches_of, stacked, storeys
from tests.sample_plan import sample_plan

CARRIED_M = 1.5


def level_points(z_m: float, side_m: float, rng: np.random.Generator) -> Array:
    xy = rng.uniform(0.0, side_m, size=(2000, 2))
    return np.column_stack((xy, np.full(len(xy), z_m)))


def world(floors: tuple[float, ...], walked: tuple[float, ...], side_m: float = 4.0) -> PlanWorld:
    """Floors (and a ceiling 2.6 m above each) of a square shaft of `side_m`, walked 4 m at each of the heights `walked`, stairs between."""
    rng = np.random.default_rng(5)
    surfaces = [(z, 1) for z in floors] + [(z + 2.6, -1) for z in floors]
    offsets = np.array([*(z for z, _ in surfaces), 0.0, side_m])
    axis = np.array([AXIS_Z] * len(surfaces) + [AXIS_X, AXIS_X])
    facing = np.array([*(f for _, f in surfaces), 1, -1])
    level = [np.column_stack((np.linspace(0.2, 3.8, 20), np.full(20, 2.0), np.full(20, z + CARRIED_M))) for z in walked]
    stairs = [np.linspace(a[-1], b[0], 10)[1:-1] for a, b in pairwise(level)]
    path = np.concatenate([part for pair in zip(level, [*stairs, np.zeros((0, 3))], strict=True) for part in pair])
    points = np.concatenate([level_points(z, side_m, rng) for z, _ in surfaces])
    plane = np.repeat(np.arange(len(surfaces)), 2000)
    frame = np.array([int(np.argmin(np.abs(path[:, 2] - z))) for z in np.clip(points[:, 2], path[:, 2].min(), path[:, 2].max())])
    n = len(points)
    return PlanWorld(
        Trajectory(np.arange(len(path)), path, np.tile(np.eye(3), (len(path), 1, 1))),
        axis,
        facing,
        offsets,
        np.full(len(axis), 0.005),
        np.tile(np.array([[0.0, side_m], [0.0, side_m], [0.0, max(floors) + 2.6]]), (len(axis), 1, 1)),
        np.full(len(axis), 5),
        points,
        frame,
        plane,
        np.ones(n),
        np.full(n, 0.01),
        heights=True,
    )


def test_two_walked_floors_are_two_storeys_each_on_its_own_zero() -> None:
    lower, upper = storeys(world((0.0, 2.9), (0.0, 2.9)))
    assert floor_heights_m(world((0.0, 2.9), (0.0, 2.9))) == (0.0, 2.9)
    assert lower.shift_m[2] - upper.shift_m[2] == pytest.approx(2.9)
    for part in (lower, upper):
        assert part.floor_seen
        assert np.sum(np.abs(part.trajectory.position_m[:, 2] - CARRIED_M) < 1e-9) == 20
        assert part.point_m[:, 2].max() < 2.7
        assert part.point_m[:, 2].min() > -0.31
    assert len(lower.trajectory.stamp_ns) + len(upper.trajectory.stamp_ns) == 20 + 8 + 20


def test_a_floor_nobody_walked_on_is_no_storey() -> None:
    """A gallery or the roof of a kiosk, seen from below or from a stair."""
    whole = world((0.0, 2.9), (0.0,))
    assert floor_heights_m(whole) == (0.0,)
    assert storeys(whole) == (whole,)


def test_half_landings_and_steps_are_no_storeys() -> None:
    assert floor_heights_m(world((0.0, 1.45, 2.9), (0.0, 1.45, 2.9))) == (0.0, 2.9)
    assert floor_heights_m(world((0.0, 0.5), (0.0, 0.5))) == (0.0,)
    assert floor_heights_m(world((0.0, 2.9), (0.0, 2.9), side_m=1.2)) == ()


def test_a_level_sweep_has_no_storeys() -> None:
    flat = replace(world((0.0, 2.9), (0.0, 2.9)), heights=False)
    assert storeys(flat) == (flat,)


def test_walls_count_where_their_points_are() -> None:
    whole = world((0.0, 2.9), (0.0, 2.9))
    assert AXIS_Y not in whole.plane_axis
    lower, upper = storeys(whole)
    assert lower.plane_frames[0] > 0 == upper.plane_frames[0]


def test_patches_go_with_their_frames_also_where_stamps_repeat() -> None:
    """Joined scans keep their own stamps, which may overlap."""
    whole = world((0.0, 2.9), (0.0, 2.9))
    path = whole.trajectory
    whole = replace(whole, trajectory=replace(path, stamp_ns=np.arange(len(path.stamp_ns)) % 24))
    count = len(path.stamp_ns)
    number, pairs = np.arange(count), np.zeros((count, 2))
    patches = FreePatches(number, number.astype(float), pairs, pairs, pairs, np.zeros(count), np.ones(count))
    parts = [patches_of(patches, whole, rows) for rows in frames_of_storeys(whole, floor_heights_m(whole))]
    assert np.array_equal(np.concatenate([part.normal_yaw_rad for part in parts]), number)
    for part, storey in zip(parts, storeys(whole), strict=True):
        assert np.array_equal(part.frame, np.arange(len(storey.trajectory.stamp_ns)))


def test_stacked_plans_know_their_level_and_their_height() -> None:
    plan = sample_plan()
    whole = stacked((plan, replace(plan, shift_m=np.array([0.0, 0.0, -2.95]))))
    assert [(one.level, one.elevation_m) for one in whole.storeys] == [("Storey 1", 0.0), ("Storey 2", 2.95)]
    assert all(not one.upper_storeys for one in whole.storeys)
    assert plan.storeys == (plan,)
