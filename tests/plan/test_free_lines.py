"""Walls off the axes are drawn as they are; door leaves and errors of rotation are not."""

import dataclasses
from itertools import pairwise

import numpy as np
import pytest

from floorplan.model.checks import Array
from floorplan.model.plan import Plan
from floorplan.model.segment import NO_SEGMENT, EvidencePoints, FreePatches
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


def with_readings(scan: BoxScan, angle_deg: float, middle: tuple[float, float], length_m: float, top_m: float) -> EvidencePoints:
    """The evidence with readings of the same surface, 5 cm along and 20 cm up apart, in each of the five frames."""
    evidence = scan.segmented.evidence
    along = np.array([np.cos(np.deg2rad(angle_deg)), np.sin(np.deg2rad(angle_deg))])
    place, height = (grid.ravel() for grid in np.meshgrid(np.arange(-length_m / 2, length_m / 2, 0.05), np.arange(0.1, top_m, 0.2)))
    surface = np.column_stack((np.array(middle) + place[:, None] * along, height))
    parts, segments, counts = [], [], []
    for frame, (first, last) in enumerate(pairwise(evidence.start)):
        more = surface - scan.trajectory.position_m[frame] if frame < 5 else np.zeros((0, 3))
        parts += [evidence.point_sensor_m[first:last], more]
        segments += [evidence.segment[first:last], np.full(len(more), NO_SEGMENT)]
        counts.append(last - first + len(more))
    start = np.concatenate(([0], np.cumsum(counts)))
    return EvidencePoints(start, np.concatenate(parts), np.concatenate(segments), np.ones(start[-1]))


def plan_with(angle_deg: float, middle: tuple[float, float], length_m: float, top_m: float, *, readings: bool = True) -> Plan:
    scan = two_rooms()
    segmented = dataclasses.replace(scan.segmented, free_patches=patches(scan, angle_deg, middle, length_m, top_m))
    if readings:
        segmented = dataclasses.replace(segmented, evidence=with_readings(scan, angle_deg, middle, length_m, top_m))
    return dataclasses.replace(scan, segmented=segmented).plan()


def test_a_skewed_wall_is_one_line_with_its_angle() -> None:
    (line,) = plan_with(20.0, (2.5, 2.0), 2.0, 2.5).free_lines
    assert line.off_axis_deg == pytest.approx(20.0, abs=0.1)
    assert np.hypot(*np.subtract(line.end, line.start)) == pytest.approx(2.0, abs=0.01)
    assert "outside the Manhattan model" in plan_with(20.0, (2.5, 2.0), 2.0, 2.5).notes[0]


def test_a_line_without_readings_of_its_own_is_an_error_of_some_frames() -> None:
    assert plan_with(20.0, (2.5, 2.0), 2.0, 2.5, readings=False).free_lines == ()


def test_an_open_door_leaf_and_low_furniture_are_no_walls() -> None:
    assert plan_with(20.0, (2.5, 2.0), 0.9, 2.0).free_lines == ()
    assert plan_with(20.0, (2.5, 2.0), 2.0, 1.1).free_lines == ()


def test_a_drawn_wall_is_not_drawn_again_askew() -> None:
    assert plan_with(5.0, (2.5, 0.1), 2.0, 2.5).free_lines == ()
