"""Gravity from floor and ceiling against the truth of a room that the tests ray-cast themselves."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from floorplan.config import IngestConfig
from floorplan.errors import InputError
from floorplan.geometry import rotation_between
from floorplan.gravity import estimate_gravity
from floorplan.gravity.horizontal import up_in_frame
from floorplan.gravity.normals import oriented_points
from floorplan.ingest import ingest
from floorplan.model.checks import Array
from floorplan.model.scan import GravitySource
from floorplan.readers import open_scan
from floorplan.reporting import no_progress
from tests.gravity.rooms import CAMERA_LEVEL, BoxWalk, box_walk, down_error_deg

FRAMES = 40
Z_UP = np.tile(np.eye(3), (FRAMES, 1, 1))
FIRST_CAMERA = np.tile(CAMERA_LEVEL.T, (FRAMES, 1, 1))  # -y up, z ahead


def tilted(world: Array, axis: Array, degrees: Array) -> Array:
    """`world (N, 3, 3)` turned by `degrees (N,)` towards `axis (3,)`."""
    up = np.array([0.0, 0.0, 1.0])
    angles = np.deg2rad(np.broadcast_to(degrees, len(world)))
    return np.stack([w @ rotation_between(up, np.cos(a) * up + np.sin(a) * axis) for w, a in zip(world, angles, strict=True)])


def estimated(walk: BoxWalk) -> tuple[GravitySource, float]:
    """Source, and the worst error of the down direction in degrees; the sign must be right too."""
    recording = estimate_gravity(walk, np.arange(len(walk.recording)), no_progress)
    assert recording.problems == ()
    assert (np.einsum("ni,ni->n", recording.down_sensor, -walk.true_rotation[:, 2, :]) > 0).all()
    return recording.gravity_source, float(down_error_deg(walk, recording.down_sensor).max())


def test_a_world_whose_z_is_up_is_recognised_and_taken_exactly() -> None:
    source, error_deg = estimated(box_walk(Z_UP))
    assert source is GravitySource.WORLD
    assert error_deg < 1e-6


@pytest.mark.parametrize("pitch_rad", [-0.3, 0.0, 0.5])
def test_the_world_of_a_first_camera_gives_its_down_direction_from_floor_and_ceiling(pitch_rad: float) -> None:
    source, error_deg = estimated(box_walk(FIRST_CAMERA, pitch_rad=pitch_rad))
    assert source is GravitySource.ESTIMATED
    assert 0.0 < error_deg < 0.5


@pytest.mark.parametrize("tilt_deg", [8.0, 25.0])
def test_a_first_camera_that_was_tilted_is_no_obstacle(tilt_deg: float) -> None:
    source, error_deg = estimated(box_walk(tilted(FIRST_CAMERA, np.array([0.6, 0.8, 0.0]), np.array(tilt_deg))))
    assert source is GravitySource.ESTIMATED
    assert error_deg < 0.5


@pytest.mark.parametrize("roll_rad", [np.pi / 2, -np.pi / 2])
def test_a_phone_held_upright_is_told_by_its_images_sides(roll_rad: float) -> None:
    assert estimated(box_walk(Z_UP, roll_rad))[0] is GravitySource.WORLD
    source, error_deg = estimated(box_walk(tilted(Z_UP, np.array([1.0, 0.0, 0.0]), np.array(6.0)), roll_rad))
    assert source is GravitySource.ESTIMATED
    assert error_deg < 0.5


def test_an_odometry_that_bends_by_six_degrees_is_followed() -> None:
    bending = tilted(FIRST_CAMERA, np.array([0.0, 1.0, 0.0]), np.linspace(0.0, 6.0, FRAMES))
    source, error_deg = estimated(box_walk(bending))
    assert source is GravitySource.ESTIMATED
    assert error_deg < 1.0


def test_depth_that_bends_floors_and_ceilings_is_outvoted_by_upright_walls() -> None:
    walk = replace(box_walk(FIRST_CAMERA), range_bias_per_m=0.02, visible_z_m=(-1.0, 2.5))  # no ceiling to balance the floor
    floor_alone = up_in_frame(oriented_points(walk.frame_points(20)), walk.true_rotation[20][2], walk.recording.sensor.noise)
    assert floor_alone is not None
    assert 1.0 < np.rad2deg(np.arccos(floor_alone.up_sensor @ walk.true_rotation[20][2])) < 3.0
    assert estimated(walk)[1] < 0.9


def test_a_scan_that_shows_no_floor_and_no_ceiling_is_refused_with_the_remedy() -> None:
    walk = box_walk(Z_UP, visible_z_m=(0.1, 2.5))
    with pytest.raises(InputError, match=r"gravity-missing.*read\.world_up"):
        ingest(walk, IngestConfig())


def test_the_real_corridor_bends_by_several_degrees_and_is_level_afterwards(shared_data: Path) -> None:
    scan = ingest(open_scan(shared_data / "rgbd/corridor"), IngestConfig())
    up = -np.einsum("nij,nj->ni", scan.recording.odom_from_sensor, scan.recording.down_sensor)
    bend_deg = np.rad2deg(np.arccos(np.clip(up @ up.T, -1, 1)).max())
    assert scan.recording.gravity_source is GravitySource.ESTIMATED
    assert 2.0 < bend_deg < 9.0
    assert (up @ [0.0, -1.0, 0.0] > np.cos(np.deg2rad(12))).all()
