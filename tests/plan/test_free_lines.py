"""Walls off the axes are drawn as they are; door leaves and errors of rotation are not."""

import dataclasses

import numpy as np
import pytest

from floorplan.model.checks import Array
from floorplan.model.plan import Plan
from floorplan.model.segment import FreePatches
from tests.plan.box_world import BoxScan, two_rooms


def patches(scan: BoxScan, angle_deg: float, middle: tuple[float, float], length_m: float, top_m: float) -> FreePatches:
    """One surface as every keyframe would see it: five frames, ends jittered by nothing."""
    frames = np.arange(5)
    along = np.array([np.cos(np.deg2rad(angle_deg)), np.sin(np.deg2rad(angle_deg))])
    at: Array = scan.trajectory.position_m[frames]
    start, end = np.array(middle) - along * length_m / 2 - at[:, :2], np.array(middle) + along * length_m / 2 - at[:, :2]
    heights = np.stack((0.1 - at[:, 2], top_m - at[:, 2]), axis=1)
    normal = np.full(5, np.deg2rad(angle_deg + 90))
    return FreePatches(frames, normal, start, end, heights, np.full(5, 0.01), np.full(5, 400))


def plan_with(angle_deg: float, middle: tuple[float, float], length_m: float, top_m: float) -> Plan:
    scan = two_rooms()
    segmented = dataclasses.replace(scan.segmented, free_patches=patches(scan, angle_deg, middle, length_m, top_m))
    return dataclasses.replace(scan, segmented=segmented).plan()


def test_a_skewed_wall_is_one_line_with_its_angle() -> None:
    (line,) = plan_with(20.0, (2.5, 2.0), 2.0, 2.5).free_lines
    assert line.off_axis_deg == pytest.approx(20.0, abs=0.1)
    assert np.hypot(*np.subtract(line.end, line.start)) == pytest.approx(2.0, abs=0.01)
    assert "outside the Manhattan model" in plan_with(20.0, (2.5, 2.0), 2.0, 2.5).notes[0]


def test_an_open_door_leaf_and_low_furniture_are_no_walls() -> None:
    assert plan_with(20.0, (2.5, 2.0), 0.9, 2.0).free_lines == ()
    assert plan_with(20.0, (2.5, 2.0), 2.0, 1.1).free_lines == ()


def test_a_drawn_wall_is_not_drawn_again_askew() -> None:
    assert plan_with(5.0, (2.5, 0.1), 2.0, 2.5).free_lines == ()
