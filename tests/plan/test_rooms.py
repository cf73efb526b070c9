"""Rooms on the inner faces, with their areas, heights and what is not known of them."""

import pytest

from floorplan.model.plan import RoomKind
from tests.plan.box_world import two_rooms


def test_two_rooms_have_their_net_areas_and_ceiling_and_are_closed() -> None:
    rooms = two_rooms().plan().rooms
    assert [room.area_m2 for room in rooms] == pytest.approx([20.0, 12.0], abs=0.01)
    assert [room.ceiling_height_m for room in rooms] == pytest.approx([2.6, 2.6])
    assert not any(room.partial for room in rooms)
    assert all(room.visited and room.kind is RoomKind.ROOM for room in rooms)


def test_the_area_sigma_follows_from_the_planes() -> None:
    """Four independent planes of 2 mm: sigma_A = 2 mm * sqrt(2 * 5^2 + 2 * 4^2) for a room of 5 x 4 m."""
    big = two_rooms().plan().rooms[0]
    assert big.area_sigma_m2 == pytest.approx(0.002 * (2 * 25 + 2 * 16) ** 0.5, rel=0.02)
