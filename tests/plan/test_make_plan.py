"""The plan of two rooms whose truth is known to the millimetre."""

import itertools

import numpy as np
import pytest

from floorplan.model.plan import DimensionRole, Plan
from tests.plan.box_world import two_rooms


@pytest.fixture(scope="module")
def plan() -> Plan:
    return two_rooms().plan()


def drawn_length_m(plan: Plan) -> float:
    lines = [line for wall in plan.walls for line in wall.seen]
    return sum(float(np.hypot(*np.subtract(a, b))) for line in lines for a, b in itertools.pairwise(line))


def test_the_wall_between_two_rooms_has_its_thickness_and_its_door_stays_open(plan: Plan) -> None:
    thick = [wall for wall in plan.walls if wall.thickness_m is not None]
    assert [round(wall.thickness_m or 0, 3) for wall in thick] == [0.12, 0.12]
    ends = sorted(round(y, 2) for wall in thick for line in wall.seen for _, y in line)
    assert ends[0] == 0.0
    assert ends[-1] == 4.0
    assert not [y for y in ends if 1.52 < y < 2.38]
    assert max(y for y in ends if y < 2) == pytest.approx(1.5, abs=0.015)
    assert min(y for y in ends if y > 2) == pytest.approx(2.4, abs=0.015)


def test_exactly_the_faces_of_the_rooms_are_drawn(plan: Plan) -> None:
    around = 2 * (5 + 4) + 2 * (3 + 4)
    assert drawn_length_m(plan) == pytest.approx(around - 2 * 0.9 + 2 * 0.12, abs=0.05)


def test_a_cabinet_seen_over_the_top_is_counted_and_not_drawn(plan: Plan) -> None:
    reasons = {rejection.reason: rejection for rejection in plan.rejections}
    assert reasons["seen over the top"].length_m == pytest.approx(1.5, abs=0.15)


def test_dimensions_are_the_distances_between_the_faces_and_numbered(plan: Plan) -> None:
    rooms = sorted(round(d.distance_m, 3) for d in plan.dimensions if d.role is DimensionRole.ROOM)
    assert {3.0, 4.0, 5.0} <= set(rooms)
    assert [d.id for d in plan.dimensions] == [f"D{k + 1}" for k in range(len(plan.dimensions))]
    assert [d.distance_m for d in plan.dimensions if d.role is DimensionRole.HEIGHT] == [pytest.approx(2.6)]
