"""No text on top of another: dimensions, stamps, walls."""

import itertools
from dataclasses import replace

import pytest

from floorplan.config import DrawingConfig
from floorplan.model.plan import DimensionRole, Plan
from floorplan.writers.composition import Composition, compose, plan_extents
from floorplan.writers.facts import SheetFacts
from floorplan.writers.occupancy import Rectangle
from floorplan.writers.sheet_words import notes
from floorplan.writers.stamp_layout import stamp_rectangle
from tests.sample_plan import sample_plan


def overlapping(a: Rectangle, b: Rectangle) -> bool:
    return a.x0 < b.x1 and b.x0 < a.x1 and a.y0 < b.y1 and b.y0 < a.y1


def boxes(composition: Composition) -> dict[str, Rectangle]:
    texts = {placed.dimension.id: placed.text_box for placed in composition.dimensions}
    stamps = {s.room.id: stamp_rectangle(s, composition.scale) for s in composition.stamps}
    return texts | stamps


@pytest.mark.parametrize(("sheet", "scale", "left_off"), [("A3", "1:100", 0), ("A2", "1:50", 0), ("A4", "1:100", 0), ("A4", "1:200", 4)])
def test_no_text_lies_on_another(sheet: str, scale: str, left_off: int) -> None:
    composition = compose(sample_plan(), DrawingConfig(sheet=sheet, scale=scale))
    found = [(a, b) for (a, p), (b, q) in itertools.combinations(boxes(composition).items(), 2) if overlapping(p, q)]
    assert len(composition.left_off) <= left_off
    assert len(boxes(composition)) == 24 - len(composition.left_off)
    assert found == []


def test_what_finds_no_place_is_named_in_the_notes() -> None:
    composition = compose(sample_plan(), DrawingConfig(sheet="A4", scale="1:200"))
    said = [note for note in notes(composition, SheetFacts()) if note.startswith("No room at 1:200 for ")]
    assert len(said) == bool(composition.left_off)
    assert all(identity in said[0] for identity in composition.left_off)


def test_chains_stand_outside_on_one_line_per_side_and_the_overall_length_beyond_them() -> None:
    composition = compose(sample_plan(), DrawingConfig(sheet="A2", scale="1:50"))
    extents = plan_extents(composition.plan)
    lines: dict[tuple[int, DimensionRole], set[float]] = {}
    for placed in composition.dimensions:
        role, axis = placed.dimension.role, placed.dimension.axis
        if role in (DimensionRole.CHAIN, DimensionRole.OVERALL):
            lines.setdefault((axis, role), set()).add(round(placed.line[0][1 - axis], 6))
            assert not overlapping(placed.text_box, extents)
    assert {key: len(across) for key, across in lines.items()} == dict.fromkeys(lines, 1)
    for axis in (0, 1):
        (chain,), (overall,) = lines[axis, DimensionRole.CHAIN], lines[axis, DimensionRole.OVERALL]
        assert overall < chain < (extents.y0, extents.x0)[axis]


def test_words_that_do_not_fit_their_bay_have_a_leader_that_crosses_no_words() -> None:
    composition = compose(sample_plan(), DrawingConfig(sheet="A2", scale="1:50"))
    led = [placed for placed in composition.dimensions if placed.leader is not None]
    assert "D14" in {placed.dimension.id for placed in led}
    for placed in led:
        leader = Rectangle.around(placed.leader or ())
        assert not any(overlapping(leader, other.text_box) for other in composition.dimensions if other is not placed)


def test_no_line_of_a_size_runs_along_a_wall() -> None:
    for placed in compose(sample_plan(), DrawingConfig(sheet="A2", scale="1:50")).dimensions:
        axis = placed.dimension.axis
        walls = [line for wall in sample_plan().walls for points in wall.seen for line in itertools.pairwise(points)]
        for start, end in walls:
            along = abs(end[axis] - start[axis]) > 0.3 and abs(start[1 - axis] - end[1 - axis]) < 1e-9
            low, high = sorted((start[axis], end[axis]))
            beside = abs(start[1 - axis] - placed.line[0][1 - axis]) < 0.01
            overlap = min(high, max(p[axis] for p in placed.line)) - max(low, min(p[axis] for p in placed.line))
            assert not (along and beside and overlap > 0.3)


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
