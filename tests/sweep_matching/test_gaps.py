"""Gaps of the recording in which the odometry lost its heading: found again where the same room is seen, told where it is not."""

from dataclasses import replace

import numpy as np
import pytest

from floorplan.matching_problems import matching_problems
from floorplan.model.checks import Array
from floorplan.reporting import no_steps
from floorplan.sweep_matching import MatchedSweeps, match_sweeps
from tests.sweep_matching.swept_room import SweptRoom, box, swept_room

ROOM = np.concatenate((box(-4.0, -3.0, 6.0, 5.0), box(1.0, 1.0, 1.6, 1.8), box(-2.0, 3.0, -1.2, 3.4), box(4.0, -3.0, 4.7, -1.6)))
SQUARE = box(-4.0, -4.0, 4.0, 4.0)
ELSEWHERE = np.concatenate((box(36.0, -3.0, 44.0, 3.0), box(40.0, 1.2, 40.9, 2.0)))
BEFORE, AFTER = 24, 24


def walk(start: tuple[float, float], count: int) -> Array:
    """Poses (N, 3) ahead along x with a slight turn, 20 cm a sweep."""
    along = 0.1 * np.arange(count)
    return np.column_stack((start[0] + along, np.full(count, start[1]), np.radians(0.8) * np.arange(count)))


def with_gap(after: Array, lost_deg: float, wall: Array, before: Array | None = None) -> SweptRoom:
    """Two walks with eight seconds between, over which the odometry turned `lost_deg` too far."""
    truth = np.concatenate((walk((-2.5, -0.5), BEFORE) if before is None else before, after))
    turn = np.radians(lost_deg)
    c, s = np.cos(turn), np.sin(turn)
    told, pivot = truth.copy(), truth[BEFORE, :2]
    rest = truth[BEFORE:, :2] - pivot
    told[BEFORE:, :2] = pivot + np.column_stack((c * rest[:, 0] - s * rest[:, 1], s * rest[:, 0] + c * rest[:, 1]))
    told[BEFORE:, 2] += turn
    room = swept_room(truth, told, wall)
    stamp = room.recording.stamp_ns + np.where(np.arange(len(truth)) < BEFORE, 0, 8_000_000_000)
    return SweptRoom(replace(room.recording, stamp_ns=stamp), truth, wall)


def matched(room: SweptRoom) -> MatchedSweeps:
    return match_sweeps(room, room.recording, no_steps)


def codes(room: SweptRoom) -> list[str]:
    return [problem.code for problem in matching_problems(room.recording, matched(room), None)]


@pytest.mark.parametrize("lost_deg", [0.0, 30.0, -45.0, 60.0, 90.0, 150.0])
def test_in_a_room_that_looks_otherwise_from_every_side_the_heading_is_found_again(lost_deg: float) -> None:
    room = with_gap(walk((-1.0, 0.5), AFTER), lost_deg, ROOM)
    off = (matched(room).refined.pose - room.pose)[:, 2]
    assert np.degrees(np.abs(off)).max() < 1.5
    assert "heading-lost" not in codes(room)


@pytest.mark.parametrize("lost_deg", [30.0, 45.0, 60.0])
def test_where_nothing_seen_before_is_seen_again_walls_askew_are_told(lost_deg: float) -> None:
    wall = np.concatenate((ROOM, ELSEWHERE))
    room = with_gap(walk((37.0, -0.5), AFTER), lost_deg, wall)
    (problem,) = [p for p in matching_problems(room.recording, matched(room), None) if p.code == "heading-lost"]
    assert (problem.where, problem.count) == (f"sweep {BEFORE}", 1)
    assert f"{(lost_deg + 45) % 90 - 45:+.0f} degrees" in problem.message


def test_another_room_whose_walls_stand_square_to_the_first_is_no_problem() -> None:
    assert "heading-lost" not in codes(with_gap(walk((37.0, -0.5), AFTER), 0.0, np.concatenate((ROOM, ELSEWHERE))))


def test_in_a_square_room_no_quarter_turn_is_guessed_and_the_loss_is_told() -> None:
    spin = np.column_stack((np.zeros((BEFORE, 2)), np.radians(15.0) * np.arange(BEFORE)))
    room = with_gap(walk((0.0, 0.0), AFTER) + np.array((0.0, 0.0, 2 * np.pi)), 44.0, SQUARE, spin)
    off = np.degrees((matched(room).refined.pose - room.pose)[BEFORE:, 2])
    assert np.abs(off - 44.0).max() < 20.0
    assert "heading-lost" in codes(room)
