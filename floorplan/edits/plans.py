"""Edits of the plan: furniture, kinds of openings, names of rooms, deleted walls. Things go by the ids that stay."""

from dataclasses import dataclass, replace

import numpy as np

from floorplan.edits.file import Edits
from floorplan.model.plan import Plan
from floorplan.model.segment import NO_TRACK, Tracks


@dataclass(frozen=True)
class Edited:
    """An edited plan and a sentence for every edit, done or not."""

    plan: Plan
    notes: tuple[str, ...]


def furniture_tracks(plan: Plan, edits: Edits) -> tuple[int, ...]:
    """The tracks of all planes that are called furniture, themselves or by a wall that lies on them."""
    planes = {face.id: face.plane for storey in plan.storeys for face in storey.faces}
    walls = {wall.id: {planes[face] for face in wall.faces if face in planes} for storey in plan.storeys for wall in storey.walls}
    meant = {plane for name in edits.furniture for plane in walls.get(name, {name})}
    return tuple(sorted(track for plane in plan.planes if plane.id in meant for track in plane.tracks))


def without_tracks(tracks: Tracks, gone: tuple[int, ...]) -> Tracks:
    """The tracks with no segment on those of `gone`: what was seen there counts as clutter."""
    return replace(tracks, track_of_segment=np.where(np.isin(tracks.track_of_segment, gone), NO_TRACK, tracks.track_of_segment))


def edit_plan(plan: Plan, edits: Edits) -> Edited:
    """Names, kinds and deletions, on whichever storey the thing is."""
    known = {
        "room": {room.id for storey in plan.storeys for room in storey.rooms},
        "opening": {opening.id for storey in plan.storeys for opening in storey.openings},
        "delete": {wall.id for storey in plan.storeys for wall in storey.walls}
        | {line.id for storey in plan.storeys for line in storey.free_lines},
    }
    asked = [("room", edit.id) for edit in edits.room] + [("opening", edit.id) for edit in edits.opening]
    asked += [("delete", id) for id in edits.delete]
    edited = replace(_edited_storey(plan, edits), upper_storeys=tuple(_edited_storey(storey, edits) for storey in plan.upper_storeys))
    notes = [_note(what, id, id in known[what]) for what, id in asked]
    notes += [_opened_note(id) for one, other in zip(plan.storeys, edited.storeys, strict=True) for id in _newly_partial(one, other)]
    return Edited(edited, tuple(notes))


def _edited_storey(plan: Plan, edits: Edits) -> Plan:
    from floorplan.edits.opened import opened_rooms  # shapely comes with it

    names, kinds = {e.id: e.name for e in edits.room}, {e.id: e.kind for e in edits.opening}
    unwanted = {*edits.delete, *edits.furniture}  # furniture without segments of its own comes back as a wall: deleted all the same
    walls = tuple(wall for wall in plan.walls if wall.id not in unwanted)
    standing = {face for wall in walls for face in wall.faces}
    gone = {face for wall in plan.walls if wall.id in unwanted for face in wall.faces} - standing
    lines = tuple(line for line in plan.free_lines if line.id not in edits.delete)
    named = tuple(replace(room, name=names.get(room.id, room.name)) for room in plan.rooms)
    return replace(
        plan,
        rooms=opened_rooms(named, plan, replace(plan, walls=walls, free_lines=lines)),
        openings=tuple(replace(opening, kind=kinds.get(opening.id, opening.kind)) for opening in plan.openings),
        walls=walls,
        faces=tuple(face for face in plan.faces if face.id not in gone),
        free_lines=lines,
    )


def _newly_partial(before: Plan, after: Plan) -> tuple[str, ...]:
    was = {room.id: room.partial for room in before.rooms}
    return tuple(room.id for room in after.rooms if room.partial and not was[room.id])


def _opened_note(id: str) -> str:
    return f"Edited by hand: room {id} is open where what was taken out stood; its area is that of what was seen."


def furniture_notes(plan: Plan, edits: Edits) -> tuple[str, ...]:
    """A sentence for every piece of furniture; `plan` is the one without the edits."""
    known = {plane.id for plane in plan.planes} | {wall.id for storey in plan.storeys for wall in storey.walls}
    return tuple(_note("furniture", id, id in known) for id in edits.furniture)


def _note(what: str, id: str, done: bool) -> str:
    return f"Edited by hand: {what} {id}." if done else f"Edit not applied: {what} {id}: there is no {id} in this build."
