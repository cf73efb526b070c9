"""What nobody saw is marked as such."""

from dataclasses import replace

import pytest
from shapely import LineString

from floorplan.config import DrawingConfig
from floorplan.model.plan import Wall
from floorplan.writers.composition import compose
from floorplan.writers.open_sides import open_sides
from floorplan.writers.plan_scene import line_notes
from tests.sample_plan import sample_plan


def test_a_closed_plan_has_no_open_side() -> None:
    plan = sample_plan()
    assert open_sides(replace(plan, rooms=tuple(replace(room, partial=False) for room in plan.rooms))) == ()


def test_the_missing_wall_of_a_partly_seen_room_is_its_open_side() -> None:
    """Room R6 without its right wall, W17: 2.08 m seen and half a metre inferred."""
    plan = sample_plan()
    lacking = replace(plan, walls=tuple(wall for wall in plan.walls if wall.id != "W17"))
    before, after = open_sides(plan), open_sides(lacking)
    gained = sum(LineString(line).length for line in after) - sum(LineString(line).length for line in before)
    assert gained == pytest.approx(10.6 - 8.02, abs=0.3)


def test_open_sides_are_worded_where_the_words_fit() -> None:
    plan = sample_plan()
    lacking = replace(plan, walls=tuple(wall for wall in plan.walls if wall.id != "W17"))
    notes = line_notes(compose(lacking, DrawingConfig(scale="1:50", sheet="A2")))
    assert len([label for label in notes if label.rotation_deg and label.text == "not seen"]) == 1
    assert isinstance(plan.walls[0], Wall)
