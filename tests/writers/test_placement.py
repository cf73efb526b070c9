"""No text on top of another: dimensions, stamps, walls."""

import itertools
from dataclasses import replace

import pytest

from floorplan.config import DrawingConfig
from floorplan.model.plan import Plan
from floorplan.writers.composition import Composition, compose
from floorplan.writers.occupancy import Rectangle
from floorplan.writers.stamp_layout import stamp_rectangle
from tests.sample_plan import sample_plan


def overlapping(a: Rectangle, b: Rectangle) -> bool:
    return a.x0 < b.x1 and b.x0 < a.x1 and a.y0 < b.y1 and b.y0 < a.y1


def boxes(composition: Composition) -> dict[str, Rectangle]:
    texts = {placed.dimension.id: placed.text_box for placed in composition.dimensions}
    stamps = {s.room.id: stamp_rectangle(s, composition.scale) for s in composition.stamps}
    return texts | stamps


@pytest.mark.parametrize(("sheet", "scale"), [("A3", "1:100"), ("A2", "1:50"), ("A4", "1:100"), ("A4", "1:200")])
def test_no_text_lies_on_another(sheet: str, scale: str) -> None:
    composition = compose(sample_plan(), DrawingConfig(sheet=sheet, scale=scale))
    found = [(a, b) for (a, p), (b, q) in itertools.combinations(boxes(composition).items(), 2) if overlapping(p, q)]
    assert len(boxes(composition)) == 24
    assert found == []


def test_dimension_text_of_one_place_twice_is_moved_aside() -> None:
    plan = sample_plan()
    twice = replace(plan, dimensions=(plan.dimensions[0], replace(plan.dimensions[0], id="D99")))
    first, second = compose(twice, DrawingConfig()).dimensions
    assert not overlapping(first.text_box, second.text_box)
    assert first.line != second.line


def test_a_dimension_line_keeps_its_faces_wherever_it_is_moved() -> None:
    for placed in compose(sample_plan(), DrawingConfig()).dimensions:
        axis = placed.dimension.axis
        assert placed.line[0][axis] == placed.dimension.start[axis]
        assert placed.line[1][axis] == placed.dimension.end[axis]
        assert placed.line[0][1 - axis] == placed.line[1][1 - axis]


def test_an_empty_plan_is_a_sheet_without_a_drawing() -> None:
    plan: Plan = replace(
        sample_plan(), walls=(), rooms=(), dimensions=(), openings=(), columns=(), glazing=(), free_lines=(), gross_outline=(), faces=()
    )
    composition = compose(plan, DrawingConfig())
    assert composition.dimensions == ()
    assert composition.stamps == ()
