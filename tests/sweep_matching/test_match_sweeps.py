"""What matching learns about the wheels, against wheels made wrong on purpose."""

from collections.abc import Iterable, Iterator
from dataclasses import replace

import numpy as np
import pytest

from floorplan.config import IngestConfig
from floorplan.ingest import ingest
from floorplan.model.checks import Array
from floorplan.model.scan import Frame
from floorplan.reporting import no_steps
from floorplan.sweep_matching import match_sweeps
from floorplan.sweep_matching.refine import level_poses
from tests.sweep_matching.swept_room import SweptRoom, box, swept_room

HALL = np.concatenate((box(-7.0, -6.0, 7.0, 6.0), box(-1.0, -0.7, 0.8, 1.0), box(4.0, -6.0, 5.2, -4.9), box(-7.0, 2.0, -6.1, 3.7)))
ARM_M = (0.27, -0.06)


def round_the_hall(count: int = 420) -> Array:
    """Poses (N, 3) of the sensor on a winding way about the block in the hall's middle."""
    angle = np.linspace(0.0, 4.0 * np.pi, count)
    radius = 3.4 + 0.7 * np.sin(5.0 * angle)
    place = radius[:, None] * np.column_stack((np.cos(angle), np.sin(angle)))
    step = np.gradient(place, axis=0)
    return np.column_stack((place, np.unwrap(np.arctan2(step[:, 1], step[:, 0]))))


def of_the_wheels(sensor: Array, arm_m: tuple[float, float], rad_per_m: float, part: float) -> Array:
    """What wheels report `arm_m` behind the sensor, that lack `rad_per_m` of turn per metre and a `part` of each turn."""
    c, s = np.cos(sensor[:, 2]), np.sin(sensor[:, 2])
    axis = sensor[:, :2] - np.column_stack((c * arm_m[0] - s * arm_m[1], s * arm_m[0] + c * arm_m[1]))
    step = np.diff(axis, axis=0)
    ahead = c[:-1] * step[:, 0] + s[:-1] * step[:, 1]
    left = c[:-1] * step[:, 1] - s[:-1] * step[:, 0]
    yaw = np.concatenate(([0.0], np.cumsum((np.diff(sensor[:, 2]) - rad_per_m * ahead) / (1.0 + part))))
    c, s = np.cos(yaw[:-1]), np.sin(yaw[:-1])
    walked = np.column_stack((c * ahead - s * left, s * ahead + c * left))
    return np.column_stack((np.concatenate((np.zeros((1, 2)), np.cumsum(walked, axis=0))), yaw))


def driven(arm_m: tuple[float, float], deg_per_m: float, part: float) -> SweptRoom:
    sensor = round_the_hall()
    return swept_room(sensor, of_the_wheels(sensor, arm_m, np.radians(deg_per_m), part), HALL)


def test_a_sensor_ahead_of_wheels_that_turn_too_far_is_found_where_it_sits() -> None:
    wheels = match_sweeps(driven(ARM_M, 3.0, -0.05), driven(ARM_M, 3.0, -0.05).recording, no_steps).wheels
    assert wheels.lever_arm is not None
    assert wheels.turn is not None
    assert wheels.lever_arm.applied
    assert (wheels.lever_arm.forward_m, wheels.lever_arm.left_m) == pytest.approx(ARM_M, abs=0.02)
    assert 0.0002 < wheels.lever_arm.forward_sigma_m < 0.02
    assert wheels.lever_arm.turns > 30
    assert wheels.turn.applied
    assert np.degrees(wheels.turn.rad_per_m) == pytest.approx(3.0, abs=0.4)
    assert wheels.turn.part == pytest.approx(-0.05, abs=0.02)


def test_a_sensor_on_the_axis_of_good_wheels_is_left_there() -> None:
    wheels = match_sweeps(driven((0.0, 0.0), 0.0, 0.0), driven((0.0, 0.0), 0.0, 0.0).recording, no_steps).wheels
    assert wheels.lever_arm is not None
    assert wheels.turn is not None
    assert not wheels.lever_arm.applied
    assert not wheels.turn.applied
    assert np.hypot(wheels.lever_arm.forward_m, wheels.lever_arm.left_m) < 0.02


def test_along_corridors_with_few_turns_nothing_is_claimed() -> None:
    truth = np.column_stack((0.1 * np.arange(200), np.zeros(200), np.zeros(200)))
    corridor = np.array([(-30.0, -1.0, 60.0, -1.0), (60.0, 1.0, -30.0, 1.0)])
    wheels = match_sweeps(swept_room(truth, truth, corridor), swept_room(truth, truth, corridor).recording, no_steps).wheels
    assert wheels.lever_arm is None


def test_mended_wheels_carry_the_pose_through_sweeps_that_show_nothing() -> None:
    """Between the two halves of the way the laser sees nothing for two metres: only the odometry says how far it went on turning."""
    sensor = round_the_hall()
    room = swept_room(sensor, of_the_wheels(sensor, ARM_M, np.radians(6.0), 0.0), HALL)
    blind = Blindfolded(room.recording, room.pose, room.wall)
    scan = ingest(blind, IngestConfig(close_loops=False))
    assert scan.recorded_odometry is not None
    np.testing.assert_array_equal(scan.recorded_odometry.position_m, room.recording.position_m)
    found, recorded = level_poses(scan.recording)[[BLIND[0] - 1, BLIND[1] - 1]], level_poses(room.recording)[[BLIND[0] - 1, BLIND[1] - 1]]
    turned = sensor[BLIND[1] - 1, 2] - sensor[BLIND[0] - 1, 2]
    assert abs(np.degrees(np.diff(recorded[:, 2])[0] - turned)) > 10.0
    assert abs(np.degrees(np.diff(found[:, 2])[0] - turned)) < 2.0


BLIND = (200, 230)


class Blindfolded(SweptRoom):
    """Sweeps of which some came back empty."""

    def frames(self, indices: Iterable[int], stride: int = 1) -> Iterator[Frame]:
        for frame in super().frames(indices, stride):
            blind = BLIND[0] <= frame.index < BLIND[1]
            yield replace(frame, points=np.full_like(frame.points, np.nan)) if blind else frame
