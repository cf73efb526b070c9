"""Loops closed, and not closed, against the poses the sweeps were rendered from."""

import numpy as np
import pytest

from floorplan.config import IngestConfig
from floorplan.ingest import ingest
from floorplan.loop_closing import close_loops
from floorplan.model.checks import Array
from floorplan.sweep_matching import RefinedOdometry, refine_odometry
from tests.sweep_matching.swept_room import box, swept_room

# A ring of corridors about a court, with niches of several sizes so that no stretch looks like the next.
RING = np.concatenate((box(-1.5, -1.5, 17.5, 13.5), box(1.5, 1.5, 14.5, 10.5), box(4.0, -1.5, 4.6, -0.9), box(10.2, -1.5, 10.5, -1.1)))
RING = np.concatenate((RING, box(17.0, 4.0, 17.5, 5.2), box(12.0, 12.9, 13.3, 13.5), box(5.5, 13.1, 6.0, 13.5), box(-1.5, 7.0, -1.0, 7.4)))
SKEW = np.array([(-1.5, 3.0, -0.6, 5.0), (14.5, 4.0, 13.9, 7.0), (8.0, 10.5, 9.0, 11.0), (9.0, 11.0, 11.0, 10.5)])


def round_the_ring(laps: float, step_m: float = 0.25) -> Array:
    """Poses (N, 3) along the middle of the corridors, turning on the spot at the corners."""
    corners = np.array([(0.0, 0.0), (16.0, 0.0), (16.0, 12.0), (0.0, 12.0)])
    poses: list[Array] = []
    for side in range(round(4 * laps)):
        start, end = corners[side % 4], corners[(side + 1) % 4]
        count = int(np.hypot(*(end - start)) / step_m)
        along = start + (end - start) * (np.arange(count) / count)[:, None]
        poses.append(np.column_stack((along, np.full(count, side * np.pi / 2))))
        turn = side * np.pi / 2 + np.radians(np.arange(10.0, 90.0, 10.0))
        poses.append(np.column_stack((np.tile(end, (len(turn), 1)), turn)))
    return np.concatenate(poses)


def bent(truth: Array, degrees_per_m: float) -> Array:
    """What a trajectory becomes that turns a little too far with every metre."""
    step = np.diff(truth[:, :2], axis=0)
    extra = np.concatenate(([0.0], np.cumsum(np.hypot(step[:, 0], step[:, 1])))) * np.radians(degrees_per_m)
    c, s = np.cos(extra[:-1]), np.sin(extra[:-1])
    turned = np.column_stack((c * step[:, 0] - s * step[:, 1], s * step[:, 0] + c * step[:, 1]))
    return np.column_stack((np.concatenate((np.zeros((1, 2)), np.cumsum(turned, axis=0))), truth[:, 2] + extra))


def drifting(truth: Array, wall: Array, degrees_per_m: float) -> RefinedOdometry:
    """Sweeps among `wall` as matching would hand them on if it bent the trajectory so."""
    refined = refine_odometry(swept_room(truth, truth, wall), swept_room(truth, truth, wall).recording)
    wrong = bent(truth, degrees_per_m)
    covariance = np.tile(np.diag((0.01, 0.01, np.radians(0.3))) ** 2, (len(truth), 1, 1))
    return RefinedOdometry(wrong, refined.matched, covariance, refined.information, refined.node, refined.surfaces)


def as_the_truth_lies(found: Array, truth: Array) -> Array:
    """The trajectory turned about its start as a whole: which way its world lies is nobody's business."""
    yaw = float(np.median((truth - found)[:, 2]))
    c, s = np.cos(yaw), np.sin(yaw)
    x, y = (found[:, :2] - found[0, :2]).T
    return np.column_stack((c * x - s * y, s * x + c * y, found[:, 2] + yaw))


def worst_m(found: Array, truth: Array) -> float:
    return float(np.hypot(*(as_the_truth_lies(found, truth) - truth)[:, :2].T).max())


def worst_deg(found: Array, truth: Array) -> float:
    return float(np.degrees(np.abs(as_the_truth_lies(found, truth) - truth)[:, 2]).max())


@pytest.mark.parametrize("wall", [RING, np.concatenate((RING, SKEW))], ids=["square walls", "and skewed ones"])
def test_a_second_lap_straightens_a_trajectory_that_bends(wall: Array) -> None:
    truth = round_the_ring(1.5)
    refined = drifting(truth, wall, 0.12)
    closed = close_loops(refined)
    assert worst_m(refined.pose, truth) > 0.8
    assert closed.joined > 10
    assert worst_m(closed.pose, truth) < 0.15
    assert worst_deg(closed.pose, truth) < 1.0
    assert 0.015 < np.median(closed.sigma_m) < 0.15


def test_an_open_way_has_no_loops_and_places_known_no_better_than_that() -> None:
    truth = round_the_ring(0.75)
    closed = close_loops(drifting(truth, RING, 0.0))
    assert closed.joined == 0
    assert closed.sigma_m.min() > 10.0
    assert worst_m(closed.pose, truth) < 0.1


def test_walls_at_right_angles_hold_the_heading_where_no_loop_does() -> None:
    truth = round_the_ring(0.75)
    refined = drifting(truth, RING, 0.2)
    closed = close_loops(refined)
    assert worst_deg(refined.pose, truth) > 3.0
    assert worst_deg(closed.pose, truth) < 1.0
    assert worst_m(closed.pose, truth) < 0.35 < 0.5 * worst_m(refined.pose, truth)


def test_corridors_that_look_alike_are_not_taken_for_one() -> None:
    """Two bare corridors 8 m apart: nothing tells the second from the first, but that it is elsewhere."""
    wall = np.concatenate((box(-1.0, -1.0, 31.0, 1.0), box(-1.0, 7.0, 31.0, 9.0)))
    ahead = np.column_stack((np.arange(0.0, 30.0, 0.25), np.zeros(120), np.zeros(120)))
    over = ahead + np.array((0.0, 8.0, 0.0))
    truth = np.concatenate((ahead, over[::-1]))
    closed = close_loops(drifting(truth, wall, 0.0))
    assert closed.joined == 0
    assert abs(closed.pose[-1, 1] - 8.0) < 0.2


def test_ingest_closes_loops_unless_told_not_to() -> None:
    truth = round_the_ring(1.25, 0.5)
    room = swept_room(truth, bent(truth, 1.0), RING)
    scan = ingest(room, IngestConfig())
    assert scan.mapped
    assert scan.map_sigma_m is not None
    assert len(scan.map_sigma_m) == len(truth)
    assert not ingest(room, IngestConfig(close_loops=False)).mapped
    found = scan.recording.position_m[:, :2]
    assert np.hypot(*(found[-1] - found[0] - (truth[-1] - truth[0])[:2])) < 0.1
