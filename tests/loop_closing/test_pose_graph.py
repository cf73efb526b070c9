"""The pose graph against poses its joints were made from."""

import numpy as np

from floorplan.loop_closing.bearings import Bearings
from floorplan.loop_closing.pose_graph import Joints, relative_poses, solve_poses, squared_errors
from floorplan.model.checks import Array

NONE = Bearings(np.zeros(0, dtype=np.int64), np.zeros(0))


def ring(count: int = 40) -> Array:
    """Poses round a circle of 5 m, looking along it."""
    angle = np.linspace(0.0, 2 * np.pi, count)
    return np.column_stack((5 * np.sin(angle), 5 - 5 * np.cos(angle), angle))


def chain(pose: Array, noise: Array, sigma: tuple[float, float, float]) -> Joints:
    first = np.arange(len(pose) - 1)
    information = np.tile(np.diag(np.array(sigma) ** -2.0), (len(first), 1, 1))
    return Joints(first, first + 1, relative_poses(pose[:-1], pose[1:]) + noise, information)


def loop(pose: Array, first: int, second: int, off: Array, information: Array) -> Joints:
    told = relative_poses(pose[first][None], pose[second][None]) + off
    return Joints(np.array([first]), np.array([second]), told, information[None])


def dead_reckoned(start: Array, joints: Joints) -> Array:
    pose = [start]
    for step in joints.relative:
        c, s = np.cos(pose[-1][2]), np.sin(pose[-1][2])
        pose.append(pose[-1] + (c * step[0] - s * step[1], s * step[0] + c * step[1], step[2]))
    return np.array(pose)


def test_one_loop_spreads_the_error_and_a_wrong_one_beside_it_changes_nothing() -> None:
    truth = ring()
    sigma = (0.02, 0.02, 0.01)
    links = chain(truth, np.random.default_rng(1).normal(size=(39, 3)) * sigma + (0.0, 0.0, 0.004), sigma)
    start = dead_reckoned(truth[0], links)
    sure = np.diag((2500.0, 2500.0, 10000.0))
    good = links.joined(loop(truth, 0, 39, np.zeros(3), sure)).joined(loop(truth, 5, 30, np.zeros(3), sure))
    found = solve_poses(start, good, NONE)
    assert np.abs(start - truth)[-1, :2].max() > 0.3
    assert np.abs(found - truth)[:, :2].max() < 0.2
    wrong = good.joined(loop(truth, 2, 20, np.array((3.0, -2.0, 0.5)), sure))
    both = solve_poses(found, wrong, NONE)
    assert np.abs(both - found)[:, :2].max() < 0.1
    error = squared_errors(both, wrong)
    assert error[-1] > 1000.0
    assert np.median(error[:-1]) < 5.0


def test_a_loop_that_says_nothing_along_a_corridor_moves_nothing_along_it() -> None:
    truth = np.column_stack((np.arange(20.0), np.zeros(20), np.zeros(20)))
    links = chain(truth, np.zeros((19, 3)), (0.05, 0.05, 0.01))
    across = np.diag((0.0, 1e4, 1e4))
    found = solve_poses(truth, links.joined(loop(truth, 0, 19, np.array((2.0, 0.3, 0.0)), across)), NONE)
    assert abs(found[-1, 0] - 19.0) < 0.02
    assert 0.2 < found[-1, 1] < 0.31


def test_a_slip_of_the_chain_is_outvoted_by_the_loops_beside_it() -> None:
    truth = np.column_stack((np.arange(20.0), np.zeros(20), np.zeros(20)))
    slip = np.zeros((19, 3))
    slip[9] = (0.5, 0.0, 0.1)
    links = chain(truth, slip, (0.02, 0.02, 0.005))
    sure = np.diag((2500.0, 2500.0, 10000.0))
    joints = links
    for k in range(0, 8, 2):
        joints = joints.joined(loop(truth, k, 19 - k, np.zeros(3), sure))
    found = solve_poses(dead_reckoned(truth[0], links), joints, NONE)
    outside = np.r_[0:7, 13:20]  # which of the links between slipped the loops cannot tell
    assert np.abs(found - truth)[outside, :2].max() < 0.05
    assert np.abs(found - truth)[outside, 2].max() < 0.02


def test_bearings_turn_the_poses_and_one_that_is_wrong_does_not() -> None:
    truth = np.column_stack((np.arange(30.0), np.zeros(30), np.zeros(30)))
    links = chain(truth, np.tile((0.0, 0.0, 0.01), (29, 1)), (0.02, 0.02, 0.01))
    told = np.zeros(30)
    told[15] = 0.2
    found = solve_poses(dead_reckoned(truth[0], links), links, Bearings(np.arange(30), told))
    assert np.abs(found - truth)[:, 2].max() < 0.02
    assert np.abs(found - truth)[:, 1].max() < 0.3
