"""Openings of small worlds: width, heights, kind; nothing is invented."""

import numpy as np
import pytest

from floorplan.model.plan import OpeningKind, Plan
from tests.plan.box_world import CEILING_M, Box, BoxScan, cast, two_rooms, wall_with_gap


def room_with(south: list[Box], extra: list[Box] | None = None) -> BoxScan:
    """A room of 5 x 4 m whose south wall (y from -0.2 to 0) is given; ground goes on outside."""
    walls: list[Box] = [
        (-0.2, 5.2, 4.0, 4.2, 0.0, CEILING_M),
        (-0.2, 0.0, 0.0, 4.0, 0.0, CEILING_M),
        (5.0, 5.2, 0.0, 4.0, 0.0, CEILING_M),
        (-0.2, 5.2, -3.2, -3.0, 0.0, CEILING_M),
    ]
    path = [(x, y) for x in np.linspace(0.8, 4.2, 7) for y in (1.0, 2.5)]
    return cast([*walls, *south, *(extra or [])], path)


def test_a_door_has_its_width_its_head_and_was_walked_through() -> None:
    (door,) = two_rooms().plan().openings
    assert door.kind is OpeningKind.DOOR
    assert door.width_m == pytest.approx(0.9, abs=0.02)
    assert door.head_height_m == pytest.approx(2.0, abs=0.06)
    assert door.depth_m == pytest.approx(0.12, abs=0.002)
    assert door.walked_through
    assert len(door.walls) == 2


def test_a_gap_over_a_sill_is_a_window_and_closes_the_room() -> None:
    sill: Box = (1.5, 3.3, -0.2, 0.0, 0.0, 0.9)
    plan = room_with([*wall_with_gap(1, -0.2, 0.0, -0.2, 5.2, [(1.5, 3.3, 2.1)]), sill]).plan()
    (window,) = (opening for opening in plan.openings if opening.centre[1] > plan.rooms[-1].outline[0][1] - 4.5)
    assert window.kind is OpeningKind.WINDOW
    assert window.width_m == pytest.approx(1.8, abs=0.03)
    assert window.sill_height_m == pytest.approx(0.9, abs=0.11)
    assert max(room.area_m2 for room in plan.rooms) == pytest.approx(20.0, abs=0.1)


def test_a_closed_wall_has_no_opening() -> None:
    plan = room_with(wall_with_gap(1, -0.2, 0.0, -0.2, 5.2, [])).plan()
    assert plan.openings == ()
    assert [round(room.area_m2, 1) for room in plan.rooms] == [20.0]


def test_piers_and_a_beam_across_a_room_are_no_door() -> None:
    pier: Box = (2.4, 2.7, 0.0, 0.4, 0.0, CEILING_M)
    other: Box = (2.4, 2.7, 3.6, 4.0, 0.0, CEILING_M)
    beam: Box = (2.4, 2.7, 0.0, 4.0, 2.4, CEILING_M)
    plan = room_with(wall_with_gap(1, -0.2, 0.0, -0.2, 5.2, []), [pier, other, beam]).plan()
    assert plan.openings == ()
    assert len([room for room in plan.rooms if room.area_m2 > 5]) == 1
    assert not any(abs(a[0] - b[0]) < 1e-6 and abs(a[1] - b[1]) > 0.6 for wall in plan.walls for a, b in wall.seen if _off_sides(plan, a))


def _off_sides(plan: Plan, point: tuple[float, float]) -> bool:
    """Whether a point lies off the left and right side of the room."""
    sides = [x for x, _ in plan.rooms[0].outline]
    return min(sides) + 0.5 < point[0] < max(sides) - 0.5


def test_the_space_between_two_piers_before_a_wall_is_no_opening() -> None:
    piers: list[Box] = [(1.0, 2.0, 0.0, 0.2, 0.0, CEILING_M), (2.7, 3.7, 0.0, 0.2, 0.0, CEILING_M)]
    plan = room_with(wall_with_gap(1, -0.2, 0.0, -0.2, 5.2, []), piers).plan()
    assert plan.openings == ()


def test_a_window_whose_sill_a_cabinet_hides_is_a_window_without_a_sill_height() -> None:
    sill: Box = (1.5, 2.7, -0.2, 0.0, 0.0, 0.9)
    cabinet: Box = (1.2, 3.0, 0.05, 0.5, 0.0, 1.0)
    plan = room_with([*wall_with_gap(1, -0.2, 0.0, -0.2, 5.2, [(1.5, 2.7, 2.1)]), sill], [cabinet]).plan()
    windows = [opening for opening in plan.openings if opening.kind is OpeningKind.WINDOW]
    assert [round(window.width_m, 1) for window in windows] == [1.2]
    assert windows[0].sill_height_m is None


def test_where_two_corridors_cross_there_is_no_passage() -> None:
    """A corridor along x, one along y that begins at it, and walls of rooms about both."""
    east: Box = (3.6, 6.0, -3.0, 0.0, 0.0, CEILING_M)
    west: Box = (-2.0, 2.0, -3.0, 0.0, 0.0, CEILING_M)
    north: Box = (-2.0, 6.0, 1.5, 3.0, 0.0, CEILING_M)
    ends: list[Box] = [(-2.2, -2.0, 0.0, 1.5, 0.0, CEILING_M), (6.0, 6.2, 0.0, 1.5, 0.0, CEILING_M), (2.0, 3.6, -3.2, -3.0, 0.0, CEILING_M)]
    path = [(x, 0.7) for x in np.linspace(-1, 5, 7)] + [(2.8, y) for y in (-0.5, -1.5, -2.5)]
    assert cast([east, west, north, *ends], path).plan().openings == ()


def test_the_width_of_an_opening_is_known_as_well_as_rays_passed_close_to_its_jambs() -> None:
    (walked,) = two_rooms().plan().openings
    assert 0.012 <= walked.width_sigma_m < 0.03
