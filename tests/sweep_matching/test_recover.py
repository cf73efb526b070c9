"""Sweeps that lie far from where the odometry has them, and pictures that bound what lies in them."""

import numpy as np

from floorplan.sweep_matching import refine_odometry
from floorplan.sweep_matching.refine import level_poses
from floorplan.sweep_matching.search_kernels import LEVELS, best_pose, place_picture
from tests.sweep_matching.swept_room import box, swept_room

ROOM = np.concatenate((box(-4.0, -3.0, 6.0, 5.0), box(1.0, 1.0, 1.6, 1.8), box(-2.0, 3.0, -1.2, 3.4)))
NOWHERE = np.zeros(5)


def test_a_slip_of_thirty_degrees_between_two_sweeps_is_found_again() -> None:
    truth = np.column_stack((0.05 * np.arange(60) - 1.0, np.zeros(60), np.radians(1.0) * np.arange(60)))
    told = truth.copy()
    told[30:, 2] -= np.radians(30.0)
    told[30:, :2] += (0.3, -0.2)
    source = swept_room(truth, told, ROOM)
    assert np.degrees(np.abs(level_poses(source.recording) - truth)[:, 2]).max() > 29.0
    found = refine_odometry(source, source.recording)
    assert np.degrees(np.abs(found.pose - truth)[:, 2]).max() < 1.0
    assert np.hypot(*(found.pose - truth)[:, :2].T).max() < 0.06
    assert found.matched[30:].min() > 0.8


def test_the_search_finds_the_pose_and_says_nothing_where_the_place_is_another() -> None:
    random = np.random.default_rng(2)
    wall = np.concatenate([np.column_stack((np.linspace(a, c, 120), np.linspace(b, d, 120))) for a, b, c, d in ROOM])
    picture, origin = place_picture(wall)
    assert picture.shape[0] == LEVELS
    assert (np.diff(picture, axis=0) >= 0).all()  # wider windows bound narrower ones
    yaw = np.radians(17.0)
    turn = np.array(((np.cos(yaw), np.sin(yaw)), (-np.sin(yaw), np.cos(yaw))))
    seen = ((wall[::6] - (0.8, -0.5)) @ turn.T).copy()
    window = np.array((2.0, np.radians(25.0), np.radians(1.0)))
    found = best_pose(picture, origin, seen, np.zeros(3), window, 0.5, NOWHERE)
    assert np.abs(found[:2] - (0.8, -0.5)).max() < 0.12
    assert abs(np.degrees(found[2]) - 17.0) < 1.1
    assert found[3] > 0.7
    elsewhere = random.uniform(-4.0, 4.0, (len(seen), 2))
    assert best_pose(picture, origin, elsewhere, np.zeros(3), window, 0.5, NOWHERE)[3] == 0.0
    rival = best_pose(picture, origin, seen, np.zeros(3), window, 0.5, np.array((*found[:3], 1.0, np.radians(10.0))))
    assert rival[3] == 0.0
