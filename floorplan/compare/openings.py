"""Doors, passages and windows of two aligned plans: the same, moved, closed, or cut since."""

import math
from collections.abc import Mapping
from dataclasses import dataclass
from enum import StrEnum

from floorplan.compare.faces import seen_faces
from floorplan.model.normal import NORMAL_95
from floorplan.model.plan import Opening, OpeningKind, Plan, Point

SAME_PLACE_M = 0.60  # between centres: half of a door
ACROSS_M = 0.50  # of the wall: the thickest one's half, and what walls may have moved by
CLOSED_SHARE = 0.5  # of an opening's width that the other survey saw wall in


class OpeningState(StrEnum):
    SAME = "same"
    CHANGED = "changed"  # a window that is a way through now, or the other way round
    MOVED = "moved"  # its place or its width
    CLOSED = "closed"  # wall now
    NEW = "new"  # wall then


@dataclass(frozen=True)
class OpeningChange:
    """One opening, ids and kinds in both surveys (empty in one for closed and new); second minus first along the wall, and of the width."""

    state: OpeningState
    first: str
    second: str
    first_kind: str
    second_kind: str
    centre: Point
    along_axis: int
    width_m: float
    moved_m: float
    moved_interval_m: float
    width_difference_m: float
    width_interval_m: float

    @property
    def moved(self) -> bool:
        return self.state is not OpeningState.SAME


def compare_openings(first: Plan, second: Plan, place_sigma_m: Mapping[int, float]) -> tuple[OpeningChange, ...]:
    """Openings of both plans in one frame, but for those that one survey cannot know of.

    `place_sigma_m`: how well places along each axis compare.
    """
    pairs = _paired(first, second)
    taken = {id(opening) for pair in pairs for opening in pair}
    changes = [_change(a, b, place_sigma_m) for a, b in pairs]
    closed = [o for o in first.openings if id(o) not in taken and _is_wall_in(second, o)]
    cut = [o for o in second.openings if id(o) not in taken and _is_wall_in(first, o)]
    changes += [_single(o, OpeningState.CLOSED) for o in closed]
    changes += [_single(o, OpeningState.NEW) for o in cut]
    return tuple(changes)


def _paired(first: Plan, second: Plan) -> list[tuple[Opening, Opening]]:
    near = sorted(
        (math.dist(a.centre, b.centre), i, j)
        for i, a in enumerate(first.openings)
        for j, b in enumerate(second.openings)
        if a.along_axis == b.along_axis
        and abs(a.centre[a.along_axis] - b.centre[a.along_axis]) < SAME_PLACE_M
        and abs(a.centre[1 - a.along_axis] - b.centre[1 - a.along_axis]) < ACROSS_M
    )
    pairs, used_first, used_second = [], set(), set()
    for _, i, j in near:
        if i not in used_first and j not in used_second:
            used_first.add(i)
            used_second.add(j)
            pairs.append((first.openings[i], second.openings[j]))
    return pairs


def _change(a: Opening, b: Opening, place_sigma_m: Mapping[int, float]) -> OpeningChange:
    along = a.along_axis
    width_sigma = math.hypot(a.width_sigma_m, b.width_sigma_m)
    place = NORMAL_95 * math.hypot(width_sigma / 2, place_sigma_m[along])  # the centre is the mean of two jambs, the width their difference
    moved, wider = b.centre[along] - a.centre[along], b.width_m - a.width_m
    state = OpeningState.MOVED if abs(moved) > place or abs(wider) > NORMAL_95 * width_sigma else OpeningState.SAME
    if (a.kind is OpeningKind.WINDOW) != (b.kind is OpeningKind.WINDOW):  # doors and passages differ by a leaf that stood open or shut
        state = OpeningState.CHANGED
    return OpeningChange(
        state, a.id, b.id, a.kind.value, b.kind.value, b.centre, along, b.width_m, moved, place, wider, NORMAL_95 * width_sigma
    )


def _single(opening: Opening, state: OpeningState) -> OpeningChange:
    names = (opening.id, "", opening.kind.value, "") if state is OpeningState.CLOSED else ("", opening.id, "", opening.kind.value)
    return OpeningChange(state, *names, opening.centre, opening.along_axis, opening.width_m, 0.0, 0.0, 0.0, 0.0)


def _is_wall_in(plan: Plan, opening: Opening) -> bool:
    """Whether most of the opening's width is seen wall in the other plan."""
    faces, across = seen_faces(plan), 1 - opening.along_axis
    low = opening.centre[opening.along_axis] - opening.width_m / 2
    shared = faces.high_m.clip(low, low + opening.width_m) - faces.low_m.clip(low, low + opening.width_m)
    beside = (faces.axis == across) & (abs(faces.offset_m - opening.centre[across]) < ACROSS_M)
    return bool((shared[beside] > CLOSED_SHARE * opening.width_m).any())
