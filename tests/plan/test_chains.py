"""Chains outside the plan: corners of the rooms along a side, each distance from the joint covariance."""

from itertools import pairwise

import numpy as np
import pytest
import shapely

from floorplan.model.plan import Dimension, DimensionRole, Room, RoomKind
from floorplan.plan.chains import Side, outside_chains, side_stops
from floorplan.plan.corners import FaceRun
from floorplan.plan.faces import Run

WALL_M = 0.2
IDS = tuple(f"P{k + 1}" for k in range(6))


def face(plane: int, axis: int, facing: int, offset: float, start: float, end: float) -> FaceRun:
    run = Run(plane, start, end, ((start, end),), 0.0, 2.5, 100.0)
    return FaceRun(run, axis, facing, offset, 0.01)


def room(number: int, x0: float, y0: float, x1: float, y1: float) -> Room:
    outline = ((x0, y0), (x1, y0), (x1, y1), (x0, y1))
    return Room(f"R{number}", RoomKind.ROOM, "", outline, (x1 - x0) * (y1 - y0), 0.1, label=((x0 + x1) / 2, (y0 + y1) / 2))


def two_rooms() -> tuple[tuple[FaceRun, ...], tuple[Room, ...]]:
    """4 m and 3 m wide, 3 m deep, with a wall of 0.2 m between."""
    faces = (
        face(0, 0, 1, 0.0, 0.0, 3.0),
        face(1, 0, -1, 4.0, 0.0, 3.0),
        face(2, 0, 1, 4.2, 0.0, 3.0),
        face(3, 0, -1, 7.2, 0.0, 3.0),
        face(4, 1, 1, 0.0, 0.0, 7.2),
        face(5, 1, -1, 3.0, 0.0, 7.2),
    )
    return faces, (room(1, 0.0, 0.0, 4.0, 3.0), room(2, 4.2, 0.0, 7.2, 3.0))


def covariance() -> np.ndarray:
    """Errors that grow along x: a random walk, so that neighbours are nearly as wrong as each other."""
    steps = np.tril(np.ones((4, 4)))
    whole = np.zeros((6, 6))
    whole[:4, :4] = 0.01**2 * steps @ steps.T
    whole[4, 4] = whole[5, 5] = 0.01**2
    return whole


def test_a_side_has_its_bays_and_the_length_over_all_once() -> None:
    found = outside_chains(*two_rooms(), (), covariance(), IDS)
    assert [(d.role, d.axis, d.from_plane, d.to_plane, round(d.distance_m, 9)) for d in found] == [
        (DimensionRole.CHAIN, 0, "P1", "P2", 4.0),
        (DimensionRole.CHAIN, 0, "P2", "P3", 0.2),
        (DimensionRole.CHAIN, 0, "P3", "P4", 3.0),
        (DimensionRole.OVERALL, 0, "P1", "P4", 7.2),
        (DimensionRole.OVERALL, 1, "P5", "P6", 3.0),
    ]
    assert all(d.line[1] < -0.5 for d in found if d.axis == 0)


def test_the_overall_length_is_as_sure_as_the_joint_covariance_says() -> None:
    """A random walk of three steps: sqrt(3), where adding the sigmas of the bays would give 3."""
    found = {(d.from_plane, d.to_plane): d for d in outside_chains(*two_rooms(), (), covariance(), IDS)}
    bays = [found["P1", "P2"], found["P2", "P3"], found["P3", "P4"]]
    assert [bay.sigma_m for bay in bays] == pytest.approx([0.01] * 3)
    assert found["P1", "P4"].sigma_m == pytest.approx(0.01 * np.sqrt(3))
    assert sum(bay.distance_m for bay in bays) == pytest.approx(found["P1", "P4"].distance_m)


def test_a_corner_behind_another_room_is_no_stop() -> None:
    """A third room behind the two, its dividing wall not in sight from below; from above it is, and says something new."""
    faces, rooms = two_rooms()
    faces += (face(0, 0, 1, 0.0, 3.2, 6.0), face(1, 0, -1, 2.0, 3.2, 6.0))
    found = outside_chains(faces, (*rooms, room(3, 0.0, 3.2, 2.0, 6.0)), (), covariance(), IDS)
    below = [d for d in found if d.axis == 0 and d.line[1] < 0 and d.role is DimensionRole.CHAIN]
    assert [round(d.distance_m, 9) for d in below] == [4.0, 0.2, 3.0]


def test_no_rooms_no_chains() -> None:
    faces, _ = two_rooms()
    assert outside_chains(faces, (), (), covariance(), IDS) == ()


def size(axis: int, start: str, end: str, room_id: str, line: tuple[float, float]) -> Dimension:
    return Dimension("", DimensionRole.ROOM, start, end, axis, 4.0, 0.01, line, line, line, room_id)


def test_a_bay_that_is_the_size_of_the_room_beside_it_is_that_dimension_moved_out() -> None:
    inside = (size(0, "P1", "P2", "R1", (2.0, 1.0)), size(1, "P5", "P6", "R1", (1.0, 1.5)), size(0, "P3", "P4", "R9", (5.0, 1.0)))
    found = outside_chains(*two_rooms(), inside, covariance(), IDS)
    assert [(d.role, d.from_plane, d.to_plane, d.line[1] < 0) for d in found] == [
        (DimensionRole.ROOM, "P1", "P2", True),
        (DimensionRole.ROOM, "P5", "P6", False),  # its side would have this number alone
        (DimensionRole.ROOM, "P3", "P4", False),  # of a room that is not beside the chain
        (DimensionRole.CHAIN, "P2", "P3", True),
        (DimensionRole.CHAIN, "P3", "P4", True),
        (DimensionRole.OVERALL, "P1", "P4", True),
    ]


def test_rebates_and_walls_too_thin_to_measure_have_no_bay() -> None:
    faces, rooms = two_rooms()
    noisy = covariance() * 12.0**2
    assert ("P2", "P3") not in {(d.from_plane, d.to_plane) for d in outside_chains(faces, rooms, (), noisy, IDS)}
    rebate = (*faces, face(0, 0, 1, 0.08, 3.0, 6.0))
    above = (room(1, 0.0, 0.0, 4.0, 3.0), rooms[1], room(3, 0.08, 3.0, 4.0, 6.0))
    stops = side_stops(Side(0, 1), rebate, above, shapely.union_all([shapely.Polygon(one.outline) for one in above]))
    assert [round(stop.offset_m, 2) for stop in stops][:1] in ([0.0], [0.08])
    assert all(b.offset_m - a.offset_m > 0.12 for a, b in pairwise(stops))
