"""`plan.json` is the plan: exact, versioned, never NaN."""

import dataclasses
import json

import pytest

from floorplan.errors import InputError
from floorplan.plan.plan_json import plan_from_json, plan_to_json
from tests.plan.box_world import two_rooms


def test_a_plan_reads_back_exactly() -> None:
    plan = two_rooms().plan()
    text = plan_to_json(plan)
    back = plan_from_json(text)
    assert plan_to_json(back) == text
    assert back.walls == plan.walls
    assert back.openings == plan.openings
    assert back.dimensions == plan.dimensions
    assert (back.trajectory.world_from_sensor == plan.trajectory.world_from_sensor).all()
    assert json.loads(text)["units"] == "m"


def test_nan_is_refused() -> None:
    plan = two_rooms().plan()
    with pytest.raises(ValueError, match="JSON compliant"):
        plan_to_json(dataclasses.replace(plan, planes=(dataclasses.replace(plan.planes[0], offset_m=float("nan")),)))


def test_another_schema_version_is_named() -> None:
    with pytest.raises(InputError, match="schema version 99"):
        plan_from_json('{"schema_version": 99}')
    with pytest.raises(InputError, match="not JSON"):
        plan_from_json("<html>")
