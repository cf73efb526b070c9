"""Two surveys of one floor as lines and words in plan metres, each on its own layer (US NCS with status letters)."""

import math
from dataclasses import dataclass
from enum import StrEnum

from floorplan.compare.changes import Comparison, WallChange
from floorplan.compare.openings import OpeningChange
from floorplan.model.plan import Plan, Point
from floorplan.writers.layers import CONTINUOUS, DASHED, Layer, LayerStyle


class Change(StrEnum):
    """What a line of the comparison says; the value is its layer: status letters E existing, M moved, D demolished, N new."""

    FIRST = "A-WALL-E"
    SECOND = "A-WALL"
    MOVED = "A-WALL-M"
    GONE = "A-WALL-D"
    NEW = "A-WALL-N"
    OPENING = "A-DOOR-M"
    DISTANCE = "A-ANNO-DIMS-M"
    NOTE = "A-ANNO-NOTE"


@dataclass(frozen=True)
class ChangeLine:
    """A polyline in plan metres."""

    change: Change
    points: tuple[Point, ...]


@dataclass(frozen=True)
class ChangeText:
    """Words at a point in plan metres, centred, along x or upwards."""

    change: Change
    text: str
    at: Point
    upwards: bool = False


_BORROWED = {
    Change.FIRST: Layer.WALL_INFERRED,
    Change.SECOND: Layer.WALL,
    Change.MOVED: Layer.COLUMN,
    Change.GONE: Layer.DOOR,
    Change.NEW: Layer.GLAZING,
    Change.OPENING: Layer.SYMBOL,
    Change.DISTANCE: Layer.DIMENSION,
    Change.NOTE: Layer.NOTE,
}
_STYLES = {  # colour index on screen, ink on paper, pen in mm, linetype, what it is
    Change.FIRST: (9, "#b0b0b0", 0.70, CONTINUOUS, "Walls of the first survey"),
    Change.SECOND: (7, "#000000", 0.25, CONTINUOUS, "Walls of the second survey"),
    Change.MOVED: (30, "#d97800", 0.70, CONTINUOUS, "Walls that moved, as the second survey has them"),
    Change.GONE: (1, "#c00000", 0.50, DASHED, "Walls that are gone"),
    Change.NEW: (3, "#008a2e", 0.70, CONTINUOUS, "Walls that are new"),
    Change.OPENING: (6, "#a000a0", 0.50, CONTINUOUS, "Openings moved, closed or cut"),
    Change.DISTANCE: (5, "#1f4fb0", 0.25, CONTINUOUS, "Distances that changed, second minus first in mm"),
    Change.NOTE: (7, "#222222", 0.18, CONTINUOUS, "Notes"),
}


def borrowed_layer(change: Change) -> Layer:
    """The plan layer whose place the change takes in a scene: a scene's writers look styles up by those."""
    return _BORROWED[change]


def change_styles() -> dict[Layer, LayerStyle]:
    """The comparison's layers, in drawing order, under the places they take."""
    return {
        borrowed_layer(change): LayerStyle(borrowed_layer(change), change.value, aci, ink, pen, linetype, True, True, words)
        for change, (aci, ink, pen, linetype, words) in _STYLES.items()
    }


def comparison_items(first: Plan, comparison: Comparison) -> list[ChangeLine | ChangeText]:
    """Both surveys' walls, what moved with its millimetres, what came and went; back to front."""
    items: list[ChangeLine | ChangeText] = [ChangeLine(Change.FIRST, line) for wall in first.walls for line in wall.seen]
    items += [ChangeLine(Change.SECOND, line) for wall in comparison.second_plan.walls for line in wall.seen]
    items += [ChangeLine(Change.GONE, (piece.start, piece.end)) for piece in comparison.gone]
    items += [ChangeLine(Change.NEW, (piece.start, piece.end)) for piece in comparison.new]
    for wall in comparison.walls:
        items += _moved_wall(wall) if wall.moved else []
    for opening in comparison.openings:
        items += _opening(opening) if opening.moved else []
    for distance in comparison.distances:
        if distance.moved and not distance.is_height:
            middle = _middle(distance.start, distance.end)
            upwards = abs(distance.end[1] - distance.start[1]) > abs(distance.end[0] - distance.start[0])
            words = f"{distance.first}: {_millimetres(distance.difference_m, distance.interval_m)}"
            items += [ChangeLine(Change.DISTANCE, (distance.start, distance.end)), ChangeText(Change.DISTANCE, words, middle, upwards)]
    return items


def _moved_wall(wall: WallChange) -> list[ChangeLine | ChangeText]:
    longest = max(wall.stretches, key=lambda ends: math.dist(*ends))
    label = ChangeText(Change.MOVED, _millimetres(wall.moved_m, wall.interval_m), _middle(*longest), upwards=wall.axis == 0)
    return [*(ChangeLine(Change.MOVED, ends) for ends in wall.stretches), label]


def _opening(opening: OpeningChange) -> list[ChangeLine | ChangeText]:
    half = (opening.width_m / 2, 0.0) if opening.along_axis == 0 else (0.0, opening.width_m / 2)
    x, y = opening.centre
    ends = (x - half[0], y - half[1]), (x + half[0], y + half[1])
    words = f"{opening.first or opening.second} {opening.state}"
    return [ChangeLine(Change.OPENING, ends), ChangeText(Change.OPENING, words, opening.centre, opening.along_axis == 1)]


def _middle(start: Point, end: Point) -> Point:
    return (start[0] + end[0]) / 2, (start[1] + end[1]) / 2


def _millimetres(moved_m: float, interval_m: float) -> str:
    return f"{1000 * moved_m:+.0f} \u00b1{1000 * interval_m:.0f} mm"
