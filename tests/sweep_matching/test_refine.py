"""Refined odometry against the poses the sweeps were rendered from."""

import numpy as np
import pytest

from floorplan.config import IngestConfig
from floorplan.errors import UsageError
from floorplan.ingest import ingest
from floorplan.model.checks import Array
from floorplan.model.scan import SensorKind
from floorplan.sweep_matching import refine_odometry
from floorplan.sweep_matching.refine import level_poses
from tests.box_room import camera_scan
from tests.sweep_matching.swept_room import SweptRoom, box, swept_room

ROOM = np.concatenate((box(-4.0, -3.0, 6.0, 5.0), box(1.0, 1.0, 1.6, 1.8), box(-2.0, 3.0, -1.2, 3.4)))
CORRIDOR = np.array([(-30.0, -1.0, 60.0, -1.0), (60.0, 1.0, -30.0, 1.0)])


def curve(count: int = 120) -> Array:
    """A walk round the pillar: 5 cm and 3 degrees a step."""
    yaw = np.radians(3.0) * np.arange(count)
    heading = yaw[:-1] + np.radians(1.5)
    step = 0.08 * np.column_stack((np.cos(heading), np.sin(heading)))
    return np.column_stack((np.concatenate((np.zeros((1, 2)), np.cumsum(step, axis=0))), yaw))


def driven(pose: Array, scale: float, turn_scale: float) -> Array:
    """What wheels say that make the steps `scale` and the turns `turn_scale` times as long."""
    yaw = turn_scale * pose[:, 2]
    step = scale * np.diff(pose[:, :2], axis=0)
    off = (yaw - pose[:, 2])[:-1]
    turned = np.column_stack((np.cos(off) * step[:, 0] - np.sin(off) * step[:, 1], np.sin(off) * step[:, 0] + np.cos(off) * step[:, 1]))
    return np.column_stack((np.concatenate((np.zeros((1, 2)), np.cumsum(turned, axis=0))), yaw))


def worst(found: Array, truth: Array) -> tuple[float, float]:
    """Largest distance in metres and largest turn in degrees between two trajectories that start together."""
    return float(np.linalg.norm((found - truth)[:, :2], axis=1).max()), float(np.degrees(np.abs(found - truth)[:, 2].max()))


def test_a_walk_round_a_pillar_is_followed_where_wheels_turn_a_tenth_too_far() -> None:
    truth = curve()
    source = swept_room(truth, driven(truth, 1.05, 1.1), ROOM)
    recorded = worst(level_poses(source.recording), truth)
    refined = refine_odometry(source, source.recording)
    found = worst(refined.pose, truth)
    assert recorded[0] > 0.2
    assert recorded[1] > 20.0
    assert found[0] < 0.08
    assert found[1] < 1.0  # of 9.5 m walked
    assert np.median(refined.matched[1:]) > 0.9


def test_driving_backwards_is_seen_though_the_wheels_count_it_as_forwards() -> None:
    along = np.concatenate((np.linspace(0.0, 2.0, 26), np.linspace(1.92, 0.0, 25)))
    truth = np.column_stack((along, np.zeros(51), np.zeros(51)))
    counted = np.column_stack((np.concatenate(([0.0], np.cumsum(np.abs(np.diff(along))))), np.zeros(51), np.zeros(51)))
    source = swept_room(truth, counted, ROOM)
    assert worst(counted, truth)[0] > 3.9
    assert worst(refine_odometry(source, source.recording).pose, truth)[0] < 0.04


def test_along_a_bare_corridor_the_odometry_stands_and_across_it_the_walls_do() -> None:
    truth = np.column_stack((0.1 * np.arange(60), np.zeros(60), np.zeros(60)))
    counted = np.column_stack((0.97 * truth[:, 0], 0.002 * np.arange(60) ** 1.2, np.zeros(60)))
    source = swept_room(truth, counted, CORRIDOR)
    found = refine_odometry(source, source.recording).pose
    assert abs(found[-1, 0] - counted[-1, 0]) < 0.05
    assert abs(counted[-1, 1]) > 0.2
    assert np.abs(found[:, 1]).max() < 0.02


def test_ingest_refines_lasers_and_keeps_what_was_recorded(room: SweptRoom) -> None:
    scan = ingest(room, IngestConfig())
    assert scan.recorded_odometry is not None
    np.testing.assert_array_equal(scan.recorded_odometry.position_m, room.recording.position_m)
    assert np.linalg.norm(scan.recording.position_m - room.recording.position_m, axis=1).max() > 0.1
    assert ingest(room, IngestConfig(odometry="recorded")).recorded_odometry is None


def test_matching_sweeps_of_a_camera_is_refused() -> None:
    camera = camera_scan()
    assert camera.recording.sensor.kind is SensorKind.CAMERA
    with pytest.raises(UsageError, match="level laser sweeps"):
        ingest(camera, IngestConfig(odometry="refine"))


@pytest.fixture
def room() -> SweptRoom:
    truth = curve(40)
    return swept_room(truth, driven(truth, 1.05, 1.1), ROOM)
