"""Ids that stay: what was called R3 in one build of a scan is R3 in the next, as far as it is the same thing.

Every thing that ever had an id is kept in a book with the place it had, in the solution's own frame (the plan frame may shift).
A thing of a new plan takes the id of the known thing whose box overlaps its own most; what is new takes a number never used.
"""

import json
import re
from collections.abc import Iterable, Sequence
from dataclasses import asdict, dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np

from floorplan.geometry import rotation_about_z
from floorplan.model.checks import Array
from floorplan.model.plan import Dimension, Plan, PlanPlane, Point, Room

ROOM_TO_MOVE_M = 0.25  # boxes are widened by this: a face that another setting moves by less is the same one
SAME_SHARE = 0.3  # of two boxes' union that their intersection covers
NAME = "ids.json"


@dataclass(frozen=True)
class Known:
    """One thing: `group` it can be mistaken in, `low_m` and `high_m` corners of its box in the solution's frame."""

    id: str
    group: str
    low_m: tuple[float, ...]
    high_m: tuple[float, ...]


Book = tuple[Known, ...]


def load_book(work: Path) -> Book:
    """The book of a work folder; empty where there is none yet."""
    path = work / NAME
    if not path.exists():
        return ()
    rows: list[dict[str, Any]] = json.loads(path.read_text("utf-8"))
    return tuple(Known(row["id"], row["group"], tuple(row["low_m"]), tuple(row["high_m"])) for row in rows)


def book_text(book: Book) -> str:
    """The book as JSON, one thing a line."""
    return "[\n" + ",\n".join(json.dumps(asdict(one)) for one in book) + "\n]\n"


@dataclass(frozen=True)
class Named:
    """A plan under the ids of the book, and the book with what is new in the plan."""

    plan: Plan
    book: Book


def named(plan: Plan, book: Book) -> Named:
    """The plan with the ids that its things had before; unchanged when the book is empty. Ids are unique over all storeys."""
    done: list[Plan] = []
    for storey in plan.storeys:
        shared = {p.id: named.id for p, named in zip(storey.planes, done[0].planes, strict=True)} if done else None
        one = _named_storey(storey, book, shared)
        book = one.book
        done.append(one.plan)
    return Named(replace(done[0], upper_storeys=tuple(done[1:])), book)


def _named_storey(plan: Plan, book: Book, plane_ids: dict[str, str] | None) -> Named:
    """One storey; `plane_ids` are those that the planes, which all storeys share, have already."""
    frame = _Frame.of(plan)
    planes = [frame.thing(p.id, f"plane {_turned_axis(plan, p)}", *zip(*p.extent_m, strict=True)) for p in plan.planes]
    rooms = [frame.thing(r.id, "room", *_box(r.outline)) for r in plan.rooms]
    openings = [frame.thing(o.id, "opening", o.centre, o.centre) for o in plan.openings]
    faces = [frame.thing(f.id, "face", *_box((f.start, f.end))) for f in plan.faces]
    walls = [frame.thing(w.id, "wall", *_box([p for line in (*w.seen, *w.inferred) for p in line])) for w in plan.walls]
    lines = [frame.thing(f.id, "free line", *_box((f.start, f.end))) for f in plan.free_lines]
    things = [*([] if plane_ids else planes), *(_on_storey(one, plan) for one in (*rooms, *openings, *faces, *walls, *lines))]
    ids = _matched(things, book) | (plane_ids or {})
    book = _extended(book, [replace(one, id=ids[one.id]) for one in things])
    plan = _renamed(plan, ids)
    dimensions = [_on_storey(_dimension(d), plan) for d in plan.dimensions]
    ids = _matched(dimensions, book)
    book = _extended(book, [replace(one, id=ids[one.id]) for one in dimensions])
    ordered = sorted((replace(d, id=ids[d.id]) for d in plan.dimensions), key=lambda d: _number(d.id))
    return Named(replace(plan, dimensions=tuple(ordered)), book)


@dataclass(frozen=True)
class _Frame:
    """Plan to solution frame: `turn (3, 3)`, `shift_m (3,)`."""

    turn: Array
    shift_m: Array

    @classmethod
    def of(cls, plan: Plan) -> "_Frame":
        return cls(np.rint(rotation_about_z(np.array(-plan.rotation_quarters * np.pi / 2))), np.asarray(plan.shift_m))

    def thing(self, id: str, group: str, low: Sequence[float], high: Sequence[float]) -> Known:
        ends = [self.turn @ (np.array([*end, 0.0][:3]) - self.shift_m) for end in (low, high)]
        ends = [np.where(np.arange(3) < len(low), end, 0.0) for end in ends]
        return Known(id, group, _rounded(np.minimum(*ends)), _rounded(np.maximum(*ends)))


def _on_storey(thing: Known, plan: Plan) -> Known:
    """Things above each other are not the same one: those of upper storeys are known by the storey too."""
    return thing if plan.elevation_m == 0 else replace(thing, group=f"{thing.group}, {plan.level}")


def _rounded(values: Array) -> tuple[float, ...]:
    return tuple(round(float(value), 3) for value in values)


def _box(points: Sequence[Point]) -> tuple[tuple[float, ...], tuple[float, ...]]:
    table = np.array(points if len(points) else [(0.0, 0.0)], dtype=float)
    return tuple(table.min(axis=0)), tuple(table.max(axis=0))


def _turned_axis(plan: Plan, plane: PlanPlane) -> str:
    """Direction of the plane's normal in the solution's frame."""
    turned = _Frame.of(plan).turn @ (plane.facing * np.eye(3)[plane.axis])
    return f"{'xyz'[int(np.argmax(np.abs(turned)))]}{'+' if turned.sum() > 0 else '-'}"


def _dimension(dimension: Dimension) -> Known:
    """A dimension is the planes it runs between and the room it belongs to."""
    ends = "-".join(sorted((dimension.from_plane, dimension.to_plane)))
    return Known(dimension.id, f"dimension {dimension.role} {ends} {dimension.room}", (), ())


def _matched(things: Sequence[Known], book: Book) -> dict[str, str]:
    """The id of every thing: of its best match in the book, else a number above all used."""
    ids: dict[str, str] = {}
    taken: set[str] = set()
    for _, i, j in sorted(_alike(things, book), reverse=True):
        mine, known = things[-i].id, book[-j].id
        if mine not in ids and known not in taken:
            ids[mine] = known
            taken.add(known)
    for one in things:
        if one.id not in ids:
            ids[one.id] = _fresh(one.id, taken | {known.id for known in book})
            taken.add(ids[one.id])
    return ids


def _fresh(wanted: str, used: set[str]) -> str:
    """The wanted id where it is free, else the next number of its letter."""
    if wanted not in used:
        return wanted
    letter = re.sub(r"\d+$", "", wanted)
    return f"{letter}{max(_number(one) for one in used if re.sub(r'[0-9]+$', '', one) == letter) + 1}"


def _number(id: str) -> int:
    found = re.search(r"\d+$", id)
    return int(found[0]) if found else 0


def _alike(things: Sequence[Known], book: Book) -> list[tuple[float, int, int]]:
    """Likeness, -i and -j of every thing i that may be what the book calls j."""
    groups: dict[str, tuple[list[int], list[int]]] = {one.group: ([], []) for one in things}
    for side, known in ((0, things), (1, book)):
        for row, one in enumerate(known):
            if one.group in groups:
                groups[one.group][side].append(row)
    pairs = []
    for mine, old in groups.values():
        likeness = _likenesses([things[i] for i in mine], [book[j] for j in old])
        rows, columns = np.nonzero(likeness >= SAME_SHARE)
        pairs += [(float(likeness[r, c]), -mine[r], -old[c]) for r, c in zip(rows, columns, strict=True)]
    return pairs


def _likenesses(things: Sequence[Known], known: Sequence[Known]) -> Array:
    """Share (A, B) of the union of two widened boxes that both cover; 1 for things without a box."""
    if not things or not known or not things[0].low_m:
        return np.ones((len(things), len(known)))
    low_a, high_a = (np.array(corners)[:, None] for corners in ([one.low_m for one in things], [one.high_m for one in things]))
    low_b, high_b = (np.array(corners)[None] for corners in ([one.low_m for one in known], [one.high_m for one in known]))
    overlap = np.clip(np.minimum(high_a, high_b) - np.maximum(low_a, low_b) + 2 * ROOM_TO_MOVE_M, 0.0, None).prod(axis=2)
    size_a, size_b = ((high - low + 2 * ROOM_TO_MOVE_M).prod(axis=2) for low, high in ((low_a, high_a), (low_b, high_b)))
    return np.asarray(overlap / (size_a + size_b - overlap))


def _extended(book: Book, things: Iterable[Known]) -> Book:
    known = {one.id for one in book}
    return (*book, *(one for one in things if one.id not in known))


def _renamed_room(room: Room, id: str) -> Room:
    """A room that is called by its number changes its name too."""
    numbered = room.name.endswith(f" {_number(room.id)}")
    return replace(room, id=id, name=f"{room.name.rsplit(' ', 1)[0]} {_number(id)}" if numbered else room.name)


def _renamed(plan: Plan, ids: dict[str, str]) -> Plan:
    """Every id and every reference replaced, but for those of dimensions."""
    return replace(
        plan,
        notes=tuple(re.sub(r"\b[A-Z]\d+\b", lambda word: ids.get(word[0], word[0]), note) for note in plan.notes),
        planes=tuple(replace(p, id=ids[p.id]) for p in plan.planes),
        faces=tuple(replace(f, id=ids[f.id], plane=ids[f.plane]) for f in plan.faces),
        walls=tuple(replace(w, id=ids[w.id], faces=tuple(ids.get(f, f) for f in w.faces)) for w in plan.walls),
        openings=tuple(replace(o, id=ids[o.id], walls=tuple(ids.get(w, w) for w in o.walls)) for o in plan.openings),
        rooms=tuple(_renamed_room(r, ids[r.id]) for r in plan.rooms),
        free_lines=tuple(replace(f, id=ids[f.id]) for f in plan.free_lines),
        dimensions=tuple(
            replace(d, from_plane=ids[d.from_plane], to_plane=ids[d.to_plane], room=ids.get(d.room, d.room)) for d in plan.dimensions
        ),
    )
