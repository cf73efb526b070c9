"""Segments, rotations and tracks of a rendered box room against its truth."""

from collections.abc import Callable
from dataclasses import replace
from functools import cache

import numpy as np
import pytest

from floorplan.compass import CompassPrior, survey
from floorplan.config import CompassConfig, SegmentsConfig, TrackingConfig
from floorplan.model.segment import SegmentedScan
from floorplan.segments import frame_picture, grid_stride, join, segment_chunk, segment_frame, without_points
from floorplan.segments.rotation import small_rotation
from floorplan.tracking import dead_reckoning, track
from tests.box_room import ROOM_M, BoxScan, camera_scan, laser_scan, with_heading, yaw_error_rad


def _segmented(box: BoxScan, config: SegmentsConfig, chunk: int = 10, backwards: bool = False) -> tuple[CompassPrior, SegmentedScan]:
    scan, compass = box.scan, CompassConfig()
    prior = survey(scan, box, compass)
    stride = grid_stride(scan.recording.sensor, config)
    starts = range(0, len(scan.keyframe), chunk)
    chunks = [segment_chunk(scan, prior, box.frames(scan.keyframe[a : a + chunk], stride), config) for a in starts]
    return prior, join(scan, prior, chunks[::-1] if backwards else chunks)


@cache
def _camera(method: str = "normals") -> tuple[BoxScan, CompassPrior, SegmentedScan]:
    box = camera_scan()
    return box, *_segmented(box, SegmentsConfig(method=method, pixel_stride=1))


@cache
def _laser() -> tuple[BoxScan, CompassPrior, SegmentedScan]:
    box = laser_scan()
    return box, *_segmented(box, SegmentsConfig())


def _true_distances(box: BoxScan, segmented: SegmentedScan) -> np.ndarray:
    """Distance from the frame to the wall each segment's axis and facing name, under the quarter turn the estimate chose."""
    segments = segmented.segments
    turn = np.median(segmented.frames.world_from_sensor @ np.swapaxes(box.world_from_sensor, 1, 2), axis=0).round()
    normal = np.eye(3)[segments.axis.astype(int)] * segments.facing[:, None] @ turn  # in the room's own axes
    axis = np.abs(normal).argmax(axis=1)
    facing = np.sign(normal[np.arange(len(axis)), axis])
    wall = np.array(ROOM_M)[axis, (facing < 0).astype(int)]
    along = (wall - box.position_m[segments.frame, axis]) * facing
    return np.asarray(along * segments.facing)


def test_the_rotations_of_a_camera_are_right_to_a_twentieth_of_a_degree() -> None:
    box, _, segmented = _camera()
    rms = np.degrees(np.sqrt((yaw_error_rad(segmented.frames.world_from_sensor, box.world_from_sensor) ** 2).mean()))
    assert 1e-6 < rms < 0.05
    assert segmented.frames.measured.all()


def test_clutter_at_random_angles_over_a_third_of_the_view_costs_a_tenth_of_a_degree_at_most() -> None:
    box = replace(camera_scan(), clutter_share=0.3)
    _, segmented = _segmented(box, SegmentsConfig(pixel_stride=1))
    rms = np.degrees(np.sqrt((yaw_error_rad(segmented.frames.world_from_sensor, box.world_from_sensor) ** 2).mean()))
    assert 1e-6 < rms < 0.1


@pytest.mark.parametrize("slip_deg", [-20.0, 20.0])
def test_no_quarter_turn_is_lost_where_the_heading_slips_by_20_degrees_while_no_wall_is_in_sight(slip_deg: float) -> None:
    box = replace(camera_scan(48, turn_deg=4.0), no_wall=(18, 30))
    slip = np.interp(np.arange(48), (18, 29), (0.0, slip_deg))
    _, segmented = _segmented(with_heading(box, slip), SegmentsConfig(pixel_stride=1))
    error = np.degrees(yaw_error_rad(segmented.frames.world_from_sensor, box.world_from_sensor))
    seen = np.r_[0:18, 30:48]
    assert not segmented.frames.measured[19:29].any()
    assert np.sqrt((error[seen] ** 2).mean()) < 0.2
    assert np.abs(error).max() < abs(slip_deg)


def test_the_heading_is_held_through_a_stretch_without_walls_and_the_sigma_grows() -> None:
    box = replace(camera_scan(48, turn_deg=4.0), no_wall=(18, 30))
    _, segmented = _segmented(box, SegmentsConfig(pixel_stride=1))
    error = np.degrees(yaw_error_rad(segmented.frames.world_from_sensor, box.world_from_sensor))
    assert np.abs(error).max() < 0.7  # the odometry's own 0.1 degrees a frame
    assert np.median(segmented.frames.yaw_sigma_rad[22:26]) > 2 * np.median(segmented.frames.yaw_sigma_rad[:18])


def test_gravity_that_is_off_by_half_a_degree_is_mended_by_the_segments() -> None:
    box = camera_scan()
    tilted = small_rotation(np.tile(np.radians((0.4, -0.3, 0.0)), (24, 1))) @ box.world_from_sensor
    box = replace(box, recording=replace(box.recording, down_sensor=-tilted[:, 2, :]))
    prior, segmented = _segmented(box, SegmentsConfig(pixel_stride=1))

    def tilt_deg(rotation: np.ndarray) -> float:
        return float(np.degrees(np.sqrt(((rotation @ np.swapaxes(box.world_from_sensor, 1, 2))[:, 2, :2] ** 2).sum(axis=1).mean())))

    assert tilt_deg(prior.level_from_sensor) == pytest.approx(0.5, abs=0.02)
    assert tilt_deg(segmented.frames.world_from_sensor) < 0.05


def test_the_yaw_sigma_tells_the_size_of_the_yaw_error() -> None:
    box, _, segmented = _camera()
    z = yaw_error_rad(segmented.frames.world_from_sensor, box.world_from_sensor) / segmented.frames.yaw_sigma_rad
    assert 0.1 < np.sqrt((z**2).mean()) < 2.0


@pytest.mark.parametrize("method", ["normals", "vote"])
def test_segment_distances_are_those_of_the_walls(method: str) -> None:
    box, _, segmented = _camera(method)
    error = segmented.segments.distance_m - _true_distances(box, segmented)
    assert len(error) > 3 * len(box.recording)
    assert np.abs(error).max() < 0.03
    assert np.sqrt((error**2).mean()) < 0.005


def test_segment_sigmas_are_neither_boasting_nor_shy() -> None:
    box, _, segmented = _camera()
    z = (segmented.segments.distance_m - _true_distances(box, segmented)) / segmented.segments.sigma_m
    assert 0.01 < (z**2).mean() < 2.0


def test_extents_stay_inside_the_room_and_reach_its_corners() -> None:
    _, _, segmented = _camera()
    height = segmented.segments.extent_m[segmented.segments.axis < 2, 2]
    assert height.min() > ROOM_M[2][0] - 0.05
    assert height.max() < ROOM_M[2][1] + 0.05
    assert height.max() > ROOM_M[2][1] - 0.15


def test_every_wall_of_the_room_is_one_track_while_it_is_in_sight() -> None:
    box, _, segmented = _camera()
    tracks = track(box.scan, segmented, TrackingConfig())
    truth = _true_distances(box, segmented)
    assert 6 <= len(tracks.axis) <= 14
    for number in range(len(tracks.axis)):
        rows = tracks.track_of_segment == number
        assert len(set(segmented.segments.axis[rows])) == 1
        assert len(set(np.sign(truth[rows]))) == 1


def test_dead_reckoning_undoes_the_headings_drift() -> None:
    box, _, segmented = _camera()
    turn = np.median(segmented.frames.world_from_sensor @ np.swapaxes(box.world_from_sensor, 1, 2), axis=0).round()
    truth = (box.position_m - box.position_m[0]) @ turn.T
    assert np.abs(dead_reckoning(box.scan, segmented.frames.world_from_sensor) - truth).max() < 0.01


def test_a_sweep_gives_walls_on_two_axes_and_no_heights() -> None:
    box, _, segmented = _laser()
    assert set(segmented.segments.axis) == {0, 1}
    error = segmented.segments.distance_m - _true_distances(box, segmented)
    assert np.sqrt((error**2).mean()) < 0.006
    rms = np.degrees(np.sqrt((yaw_error_rad(segmented.frames.world_from_sensor, box.world_from_sensor) ** 2).mean()))
    assert rms < 0.15


def test_the_result_does_not_depend_on_the_order_of_the_chunks() -> None:
    box, _, segmented = _camera()
    again = _segmented(box, SegmentsConfig(pixel_stride=1), chunk=10, backwards=True)[1]
    np.testing.assert_array_equal(again.segments.distance_m, segmented.segments.distance_m)
    np.testing.assert_array_equal(again.evidence.segment, segmented.evidence.segment)
    np.testing.assert_array_equal(again.frames.world_from_sensor, segmented.frames.world_from_sensor)


def test_evidence_left_on_disk_and_read_chunk_by_chunk_is_the_same() -> None:
    box, prior, segmented = _camera()
    config, rows = SegmentsConfig(pixel_stride=1), box.scan.keyframe
    chunks = [segment_chunk(box.scan, prior, box.frames(rows[a : a + 10], 1), config) for a in range(0, len(rows), 10)]
    kept = {int(chunk.frame[0]): chunk.evidence for chunk in chunks}
    light = [without_points(chunk) for chunk in chunks]
    assert sum(len(chunk.evidence.weight) for chunk in light) == 0
    again = join(box.scan, prior, light, lambda chunk: kept[int(chunk.frame[0])])
    for name in ("start", "point_sensor_m", "segment", "weight"):
        np.testing.assert_array_equal(getattr(again.evidence, name), getattr(segmented.evidence, name))


@pytest.mark.parametrize("scan", [camera_scan, laser_scan])
def test_a_recording_too_long_for_memory_keeps_fewer_points_of_each_frame_that_stand_for_more_pixels(scan: Callable[[], BoxScan]) -> None:
    box = scan()
    most = 50 * len(box.scan.keyframe)
    _, few = _segmented(box, SegmentsConfig(max_evidence_points=most))
    _, all_kept = _segmented(box, SegmentsConfig())
    assert 0.5 * most < len(few.evidence.weight) < 1.3 * most < len(all_kept.evidence.weight)
    assert few.evidence.weight.sum() == pytest.approx(all_kept.evidence.weight.sum(), rel=0.1)
    np.testing.assert_array_equal(few.segments.distance_m, all_kept.segments.distance_m)


def test_evidence_points_lie_on_the_segments_they_name() -> None:
    _, _, segmented = _camera()
    evidence, segments = segmented.evidence, segmented.segments
    frame = np.repeat(np.arange(len(evidence.start) - 1), np.diff(evidence.start))
    on = evidence.segment >= 0
    assert on.mean() > 0.7
    assert (segments.frame[evidence.segment[on]] == frame[on]).all()
    world = np.einsum("pij,pj->pi", segmented.frames.world_from_sensor[frame[on]], evidence.point_sensor_m[on].astype(float))
    off = world[np.arange(len(world)), segments.axis[evidence.segment[on]]] - segments.distance_m[evidence.segment[on]]
    assert np.abs(off).max() < 0.06


def test_the_picture_of_a_frame_shows_the_axes_in_the_papers_colours() -> None:
    box, prior, _ = _camera()
    frame = next(iter(box.frames([0])))
    segmented = segment_frame(frame, 0, prior, box.recording.sensor, SegmentsConfig())
    picture = frame_picture(frame.points, segmented)
    height, width = frame.points.shape[:2]
    assert picture.shape == (height, 2 * width, 3)
    colours = {tuple(int(c) for c in colour) for colour in picture[:, width:].reshape(-1, 3)}
    assert {(255, 0, 0), (0, 255, 0), (0, 0, 255)} <= colours
    assert (picture[:, width:][segmented.labels // 2 == 2] != (255, 0, 0)).any(axis=1).all()
