"""Edits of a plan made by hand."""

from dataclasses import replace

import numpy as np

from floorplan.edits.file import Edits, OpeningKindEdit, RoomName
from floorplan.edits.plans import edit_plan, furniture_notes, furniture_tracks, without_tracks
from floorplan.model.plan import OpeningKind, Wall
from floorplan.model.segment import NO_TRACK, Tracks
from tests.sample_plan import sample_plan


def test_names_kinds_and_deletions_are_applied_and_told() -> None:
    edits = Edits(room=(RoomName("R2", "Kitchen"),), opening=(OpeningKindEdit("O5", OpeningKind.DOOR),), delete=("W17", "L1"))
    plan, before = edit_plan(sample_plan(), edits), sample_plan()
    assert {room.id: room.name for room in plan.plan.rooms}["R2"] == "Kitchen"
    assert {opening.id: opening.kind for opening in plan.plan.openings}["O5"] is OpeningKind.DOOR
    assert len(plan.plan.walls) == len(before.walls) - 1
    assert plan.plan.free_lines == ()
    assert plan.notes == tuple(f"Edited by hand: {what}." for what in ("room R2", "opening O5", "delete W17", "delete L1"))


def test_a_deleted_wall_takes_its_faces_along_but_not_those_another_wall_shares() -> None:
    plan = sample_plan()
    plan = replace(plan, walls=(*plan.walls, Wall("W50", ("F1", "F2"), ()), Wall("W51", ("F1",), ())))
    assert [face.id for face in edit_plan(plan, Edits(delete=("W50",))).plan.faces] == ["F1"]
    assert [face.id for face in edit_plan(plan, Edits(delete=("W50", "W51"))).plan.faces] == []


def test_what_is_not_there_is_told_and_changes_nothing() -> None:
    edited = edit_plan(sample_plan(), Edits(room=(RoomName("R99", "x"),), delete=("W99",)))
    assert edited.plan.rooms == sample_plan().rooms
    assert all(note.startswith("Edit not applied") for note in edited.notes)
    assert furniture_notes(sample_plan(), Edits(furniture=("P99",)))[0].startswith("Edit not applied")


def test_furniture_is_named_by_plane_or_by_wall() -> None:
    plan = sample_plan()
    plan = replace(plan, walls=(*plan.walls, Wall("W50", ("F2",), ())))
    assert furniture_tracks(plan, Edits(furniture=("P2",))) == (2,)
    assert furniture_tracks(plan, Edits(furniture=("W50",))) == (2,)


def test_what_was_seen_of_furniture_becomes_clutter() -> None:
    tracks = Tracks(np.array([0, 1, 1, 2]), np.zeros(3), np.ones(3), np.zeros((3, 3, 2)))
    assert without_tracks(tracks, (1,)).track_of_segment.tolist() == [0, NO_TRACK, NO_TRACK, 2]


def test_a_room_whose_wall_is_taken_out_is_open_there_and_told() -> None:
    before = sample_plan()
    edited = edit_plan(before, Edits(delete=("W5",)))  # between R2 and R3
    opened = {room.id for room in edited.plan.rooms if room.partial} - {room.id for room in before.rooms if room.partial}
    assert opened == {room.id for room in before.rooms if _beside(room.outline, 8.5) or _beside(room.outline, 8.62)} & opened
    assert len(opened) == 2
    assert sum("is open where what was taken out stood" in note for note in edited.notes) == 2


def _beside(outline: tuple[tuple[float, float], ...], x: float) -> bool:
    return any(abs(point[0] - x) < 1e-6 for point in outline)
