"""The drawing of two surveys: each kind of change on its own layer."""

import io
import re
from dataclasses import replace

import ezdxf
import numpy as np
import pytest

from floorplan.compare import Comparison, Survey, compare_surveys
from floorplan.compare.survey import Rays
from floorplan.config import DrawingConfig
from floorplan.errors import UsageError
from floorplan.model.plan import Plan, Wall
from floorplan.writers.comparison import comparison_bytes
from tests.compare.test_changes import moved
from tests.laser.plans import two_rooms


def walled(plan: Plan) -> Plan:
    walls = tuple(Wall(f"W{k}", (face.id,), ((face.start, face.end),)) for k, face in enumerate(plan.faces))
    return replace(plan, walls=walls)


def compared() -> tuple[Plan, Comparison]:
    nothing = Rays(np.zeros((0, 3)), np.zeros((0, 3)))
    first, second = walled(two_rooms()), walled(moved(two_rooms(), 3, 0.15))
    return first, compare_surveys(Survey("before", first, nothing), Survey("after", second, nothing))


def test_the_dxf_is_clean_and_has_the_moved_wall_at_its_place_with_its_millimetres() -> None:
    first, comparison = compared()
    document = ezdxf.read(io.StringIO(comparison_bytes("dxf", first, comparison, DrawingConfig()).decode()))
    assert not document.audit().has_errors
    (line,) = document.modelspace().query('LWPOLYLINE[layer=="A-WALL-M"]')
    assert {round(x, 6) for x, *_ in line.get_points()} == {7.27}
    (text,) = document.modelspace().query('TEXT[layer=="A-WALL-M"]')
    assert re.fullmatch(r"\+150 ±\d+ mm", text.dxf.text)
    assert len(document.modelspace().query('LWPOLYLINE[layer=="A-WALL-E"]')) == 6
    assert len(document.modelspace().query('LINE LWPOLYLINE[layer=="A-ANNO-DIMS-M"]')) == 1


def test_svg_and_png_are_sheets_with_a_key_and_the_same_bytes_each_time() -> None:
    first, comparison = compared()
    svg = comparison_bytes("svg", first, comparison, DrawingConfig())
    assert svg == comparison_bytes("svg", first, comparison, DrawingConfig())
    text = svg.decode()
    assert 'width="420mm"' in text
    assert 'id="A-WALL-M"' in text
    assert "first: before" in text
    assert comparison_bytes("png", first, comparison, DrawingConfig()).startswith(b"\x89PNG")
    with pytest.raises(UsageError, match="pdf"):
        comparison_bytes("pdf", first, comparison, DrawingConfig())
