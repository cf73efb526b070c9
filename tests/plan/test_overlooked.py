"""Surfaces without segments: found again as lines in the readings, at the place they were cast at."""

from dataclasses import replace

import numpy as np
import pytest

from floorplan.config import PlanConfig
from floorplan.model.plan import Face, Plan
from floorplan.model.segment import NO_SEGMENT, NO_TRACK
from tests.plan.box_world import CEILING_M, Box, BoxScan, cast, two_rooms

EAST = (0, -1, 8.12)  # the far wall of the second room: axis, facing, offset


def without_plane(scan: BoxScan, axis: int, facing: int, offset_m: float) -> BoxScan:
    """The scan as if no segment had been found on one plane: its readings are loose and the solution does not know it."""
    old = scan.solution
    gone = int(np.flatnonzero((old.plane_axis == axis) & (old.plane_facing == facing) & np.isclose(old.plane_offset_m, offset_m))[0])
    kept = np.delete(np.arange(len(old.plane_axis)), gone)
    owner = scan.tracks.track_of_segment
    evidence = scan.segmented.evidence
    on_it = (evidence.segment != NO_SEGMENT) & (owner[evidence.segment] == gone)
    tracks = replace(
        scan.tracks,
        track_of_segment=np.where(owner == gone, NO_TRACK, owner - (owner > gone)),
        axis=scan.tracks.axis[kept],
        facing=scan.tracks.facing[kept],
        extent_m=scan.tracks.extent_m[kept],
    )
    solution = replace(
        old,
        plane_of_track=np.arange(len(kept)),
        plane_axis=old.plane_axis[kept],
        plane_facing=old.plane_facing[kept],
        plane_offset_m=old.plane_offset_m[kept],
        plane_sigma_m=old.plane_sigma_m[kept],
        plane_extent_m=old.plane_extent_m[kept],
        plane_covariance_m2=None if old.plane_covariance_m2 is None else old.plane_covariance_m2[np.ix_(kept, kept)],
    )
    segmented = replace(scan.segmented, evidence=replace(evidence, segment=np.where(on_it, NO_SEGMENT, evidence.segment)))
    return replace(scan, segmented=segmented, tracks=tracks, solution=solution)


def faces_on(plan: Plan, axis: int, facing: int, offset_m: float) -> list[Face]:
    planes = {plane.id: plane for plane in plan.planes}
    shift = plan.shift_m[axis]
    return [
        face
        for face in plan.faces
        if (planes[face.plane].axis, planes[face.plane].facing) == (axis, facing)
        and abs(planes[face.plane].offset_m - shift - offset_m) < 0.02
    ]


def test_a_wall_without_segments_is_drawn_where_it_stands_and_closes_the_room() -> None:
    whole, plan = two_rooms().plan(), without_plane(two_rooms(), *EAST).plan()
    drawn = faces_on(plan, *EAST)
    assert sum(np.hypot(*np.subtract(face.end, face.start)) for face in drawn) == pytest.approx(4.0, abs=0.05)
    assert [round(room.area_m2, 1) for room in plan.rooms] == [round(room.area_m2, 1) for room in whole.rooms]


def test_its_plane_has_no_tracks_and_its_own_variance() -> None:
    plan = without_plane(two_rooms(), *EAST).plan()
    (found,) = {face.plane for face in faces_on(plan, *EAST)}
    row = next(k for k, plane in enumerate(plan.planes) if plane.id == found)
    assert plan.planes[row].tracks == ()
    assert plan.plane_covariance_m2 is not None
    assert plan.plane_covariance_m2.shape == (len(plan.planes),) * 2
    assert plan.plane_covariance_m2[row, row] == pytest.approx(plan.planes[row].sigma_m ** 2)
    assert 0.001 < plan.planes[row].sigma_m < 0.02


def test_too_few_frames_make_no_wall() -> None:
    scan = without_plane(two_rooms(), *EAST)
    assert not faces_on(scan.plan(replace(PlanConfig(), min_frames=len(scan.trajectory.position_m) + 1)), *EAST)


def test_scattered_readings_make_no_wall() -> None:
    scan = without_plane(two_rooms(), *EAST)
    evidence = scan.segmented.evidence
    loose = evidence.segment == NO_SEGMENT
    point = np.array(evidence.point_sensor_m)
    point[loose] *= 1 - np.random.default_rng(3).uniform(0, 0.15, loose.sum())[:, None]  # like leaves of a plant
    scattered = replace(scan, segmented=replace(scan.segmented, evidence=replace(evidence, point_sensor_m=point)))
    assert not faces_on(scattered.plan(), *EAST)


def test_a_pane_in_a_window_is_no_wall() -> None:
    boxes: list[Box] = [
        (-0.3, 5.3, -0.3, 0.0, 0.0, CEILING_M),
        (-0.3, 0.0, 0.0, 4.0, 0.0, CEILING_M),
        (5.0, 5.3, 0.0, 4.0, 0.0, CEILING_M),
        (-0.3, 1.5, 4.0, 4.3, 0.0, CEILING_M),
        (3.0, 5.3, 4.0, 4.3, 0.0, CEILING_M),
        (1.5, 3.0, 4.0, 4.3, 0.0, 0.9),
        (1.5, 3.0, 4.0, 4.3, 2.1, CEILING_M),
        (1.5, 3.0, 4.14, 4.15, 0.9, 2.1),  # the pane
    ]
    path = [(x, y) for x in np.linspace(0.8, 4.2, 8) for y in (1.0, 2.0)]
    plan = cast(boxes, path).plan()
    assert not faces_on(plan, 1, -1, 4.14)
    assert any(rejection.reason == "pane of a window" for rejection in plan.rejections)
    assert len(faces_on(plan, 1, -1, 4.0)) == 2
