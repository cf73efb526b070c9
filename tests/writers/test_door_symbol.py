"""Which way door symbols are drawn."""

from dataclasses import replace

from floorplan.model.plan import Opening, OpeningKind, Plan, Point, Room, RoomKind
from floorplan.writers.door_symbol import door_symbols
from tests.sample_plan import sample_plan

CORRIDOR = Room("R1", RoomKind.CORRIDOR, "", ((0.0, 0.0), (8.0, 0.0), (8.0, 2.0), (0.0, 2.0)), 16.0, 0.0)
ROOM = Room("R2", RoomKind.ROOM, "", ((0.0, 2.1), (8.0, 2.1), (8.0, 9.0), (0.0, 9.0)), 55.2, 0.0)


def leaf_end(rooms: tuple[Room, ...], y: float) -> Point:
    """Where the open leaf of a door in a wall along x ends."""
    door = Opening("O1", OpeningKind.DOOR, (4.0, y), 0, 0.9, 0.01, (), depth_m=0.1)
    plan: Plan = replace(sample_plan(), rooms=rooms, openings=(door,))
    (symbol,) = door_symbols(plan)
    return symbol.placed(((-0.5, 1.0),))[0]


def test_a_door_between_corridor_and_room_is_drawn_into_the_room() -> None:
    assert leaf_end((CORRIDOR, ROOM), 2.05)[1] > 2.9


def test_a_door_from_a_corridor_to_a_room_that_was_not_seen_is_drawn_out_of_the_corridor() -> None:
    assert leaf_end((CORRIDOR,), 2.05)[1] > 2.9
    assert leaf_end((CORRIDOR,), -0.05)[1] < -0.9


def test_a_door_of_a_room_alone_is_drawn_into_it() -> None:
    assert leaf_end((ROOM,), 2.05)[1] > 2.9
