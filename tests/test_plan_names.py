"""Ids stay with the things they were given to."""

from dataclasses import replace

import numpy as np

from floorplan.plan_names import book_text, load_book, named
from tests.laser.plans import two_rooms
from tests.sample_plan import sample_plan


def test_a_first_plan_keeps_its_ids_and_fills_the_book() -> None:
    plan = sample_plan()
    result = named(plan, ())
    assert [room.id for room in result.plan.rooms] == [room.id for room in plan.rooms]
    assert result.plan.dimensions == plan.dimensions
    assert {one.id for one in result.book} >= {"P1", "R6", "O7", "W17", "D19"}


def test_the_same_plan_again_changes_neither_plan_nor_book() -> None:
    first = named(sample_plan(), ())
    again = named(sample_plan(), first.book)
    assert again.book == first.book
    assert again.plan.rooms == first.plan.rooms
    assert again.plan.dimensions == first.plan.dimensions


def test_renumbered_things_get_their_ids_back_wherever_the_plan_lies() -> None:
    plan = two_rooms()
    book = named(plan, ()).book
    order = [3, 1, 5, 0, 2, 4]
    shift = np.array([10.0, -3.0, 0.0])
    ids = {plan.planes[k].id: f"P{new + 1}" for new, k in enumerate(order)}
    moved = [
        replace(
            plan.planes[k],
            id=ids[plan.planes[k].id],
            extent_m=tuple((low + s, high + s) for (low, high), s in zip(plan.planes[k].extent_m, shift, strict=True)),
        )
        for k in order
    ]
    dimensions = [replace(d, id=f"D{9 - i}", from_plane=ids[d.from_plane], to_plane=ids[d.to_plane]) for i, d in enumerate(plan.dimensions)]
    other = replace(plan, planes=tuple(moved), faces=(), dimensions=tuple(dimensions), shift_m=shift)
    result = named(_boxed(other), named(_boxed(plan), ()).book)
    assert [p.id for p in result.plan.planes] == [plan.planes[k].id for k in order]
    assert [(d.id, d.from_plane, d.to_plane) for d in result.plan.dimensions] == [(d.id, d.from_plane, d.to_plane) for d in plan.dimensions]
    assert book


def _boxed(plan: "object") -> "object":
    """Planes whose box is thin along their axis, as a solution's are."""
    planes = []
    for plane in plan.planes:  # type: ignore[attr-defined]
        extent = list(plane.extent_m)
        shift = plan.shift_m[plane.axis]  # type: ignore[attr-defined]
        extent[plane.axis] = (plane.offset_m + shift, plane.offset_m + shift)
        planes.append(replace(plane, extent_m=tuple(extent)))
    return replace(plan, planes=tuple(planes))  # type: ignore[type-var]


def test_a_new_thing_takes_a_number_never_used_and_a_lost_one_comes_back() -> None:
    plan = sample_plan()
    book = named(plan, ()).book
    far = replace(plan.rooms[0], outline=((50.0, 50.0), (53.0, 50.0), (53.0, 54.0), (50.0, 54.0)))
    result = named(replace(plan, rooms=(far, *plan.rooms[2:])), book)
    assert [room.id for room in result.plan.rooms] == ["R7", "R3", "R4", "R5", "R6"]
    back = named(plan, result.book)
    assert [room.id for room in back.plan.rooms] == [room.id for room in plan.rooms]


def test_the_book_is_read_back_as_written(tmp_path: "object") -> None:
    book = named(sample_plan(), ()).book
    (tmp_path / "ids.json").write_text(book_text(book), "utf-8")  # type: ignore[operator]
    assert load_book(tmp_path) == book  # type: ignore[arg-type]
