"""Where a space ends although no wall was seen."""

import numpy as np
import pytest
from shapely.geometry import LineString, Polygon, box

from floorplan.config import PlanConfig
from floorplan.plan.closures import mouth_barriers, narrow_barriers, opening_barriers
from floorplan.plan.corners import FaceRun
from floorplan.plan.faces import Run
from floorplan.plan.gaps import Gap
from floorplan.plan.rooms import through_mouths, with_niches
from tests.plan.box_world import cast, wall_with_gap
from tests.plan.test_glazing_and_columns import SHELL

CONFIG = PlanConfig()


def face(axis: int, facing: int, offset_m: float, start_m: float, end_m: float) -> FaceRun:
    run = Run(0, start_m, end_m, ((start_m, end_m),), 0.0, 2.5, 100.0, open_start=True, open_end=True)
    return FaceRun(run, axis, facing, offset_m, 0.003)


def test_a_gap_of_door_width_between_walls_in_line_is_closed_and_a_wider_one_is_not() -> None:
    left = face(1, 1, 0.0, 0.0, 3.0)
    (barrier, *_) = narrow_barriers((left, face(1, 1, 0.02, 4.0, 7.0)), CONFIG)
    assert (barrier.axis, barrier.start_m, barrier.end_m, barrier.weak) == (1, 3.0, 4.0, True)
    assert narrow_barriers((left, face(1, 1, 0.0, 4.5, 7.0)), CONFIG) == ()


def test_the_other_side_of_a_wall_beyond_a_door_stops_the_gap_with_a_jog() -> None:
    barriers = narrow_barriers((face(1, 1, 0.0, 0.0, 3.0), face(1, -1, -0.15, 3.9, 7.0)), CONFIG)
    jogs = [b for b in barriers if b.axis == 0]
    assert jogs
    assert all((b.start_m, b.end_m) == pytest.approx((-0.15, 0.0)) for b in jogs)


def test_the_space_between_two_short_piers_and_a_recess_stay_open() -> None:
    piers = (face(1, 1, 0.0, 0.0, 0.3), face(1, 1, 0.0, 1.4, 1.7))
    assert narrow_barriers(piers, CONFIG) == ()
    walls = (face(1, 1, 0.0, 0.0, 3.0), face(1, 1, 0.0, 4.0, 7.0))
    assert narrow_barriers((*walls, face(1, 1, -0.3, 3.0, 4.0)), CONFIG) == ()


def test_an_unseen_gap_of_a_wall_is_closed_up_to_an_openings_width() -> None:
    faces = (face(1, 1, 0.0, 0.0, 3.0), face(1, 1, 0.0, 4.5, 7.0))
    unseen = Gap(0, 1, 3.0, 4.5, passed=0.2, lintel=None, head_m=None, sill_m=None)
    seen_above = Gap(0, 1, 3.0, 4.5, passed=1.0, lintel=False, head_m=None, sill_m=None)
    assert len(opening_barriers(faces, (unseen,), frozenset(), CONFIG)) == 1
    assert opening_barriers(faces, (seen_above,), frozenset(), CONFIG) == ()


def test_a_niche_belongs_to_the_room_before_it_unless_it_is_open_elsewhere() -> None:
    room, niche = box(0, 0, 4, 3), box(1, 3, 2, 3.5)
    mouth = LineString([(1, 3), (2, 3)])
    walls = room.boundary.union(niche.boundary)
    (joined,) = with_niches([room, niche], mouth, walls.buffer(1e-4))
    assert joined.area == pytest.approx(12.5)
    assert isinstance(joined, Polygon)
    open_behind = walls.difference(LineString([(1.01, 3.5), (1.99, 3.5)]).buffer(1e-3))
    assert len(with_niches([room, niche], mouth, open_behind.buffer(1e-4))) == 2


def test_a_wide_gap_in_a_wall_is_a_mouth_and_one_between_short_piers_is_not() -> None:
    left = face(1, 1, 0.0, 0.0, 3.0)
    (mouth,) = mouth_barriers((left, face(1, 1, 0.0, 6.0, 9.0)), CONFIG)
    assert (mouth.axis, mouth.start_m, mouth.end_m) == (1, 3.0, 6.0)
    assert mouth_barriers((left, face(1, 1, 0.0, 4.0, 9.0)), CONFIG) == ()
    assert mouth_barriers((face(1, 1, 0.0, 2.0, 3.0), face(1, 1, 0.0, 6.0, 6.5)), CONFIG) == ()


def test_what_is_glimpsed_through_a_mouth_is_no_part_of_the_corridor_but_an_entered_or_closed_space_is() -> None:
    corridor, beyond = box(0, 0, 9, 2), box(3, 2, 6, 4)
    mouth = LineString([(3, 2), (6, 2)])
    closed = corridor.boundary.union(beyond.boundary).difference(mouth).buffer(1e-4)
    far_side_open = closed.difference(LineString([(3.1, 4), (5.9, 4)]).buffer(1e-3))
    in_corridor, in_both = np.array([[1.0, 1.0]]), np.array([[1.0, 1.0], [4.0, 3.0]])
    assert len(through_mouths([corridor, beyond], mouth, closed, in_corridor)) == 1
    assert len(through_mouths([corridor, beyond], mouth, far_side_open, in_corridor)) == 2
    (joined,) = through_mouths([corridor, beyond], mouth, far_side_open, in_both)
    assert joined.area == pytest.approx(24.0)


def test_a_level_laser_tells_two_rooms_apart_at_a_door_beside_a_wall_that_was_not_seen_whole() -> None:
    wall = wall_with_gap(0, 5.0, 5.12, 0.0, 4.0, [(1.4, 2.5, 2.0)])
    plan = cast([*SHELL, *wall], [(x, 1.9) for x in (1.0, 2.0, 3.0, 4.0, 4.8, 5.3, 6.0, 7.0)], laser=True).plan()
    assert [room.area_m2 for room in plan.rooms] == pytest.approx([20.0, 11.52], rel=0.02)
