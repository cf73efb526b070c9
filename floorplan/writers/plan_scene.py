"""The plan itself as strokes, fills and labels on paper."""

import itertools
import math
from collections.abc import Iterator

from floorplan.config import ProjectConfig
from floorplan.model.plan import OpeningKind, Point
from floorplan.writers.composition import Composition
from floorplan.writers.dimension_spots import TEXT_HEIGHT_MM, TICK_MM
from floorplan.writers.door_symbol import UNIT_LEAF, UNIT_LINE, DoorSymbol, unit_arc, window_lines
from floorplan.writers.facts import SheetFacts
from floorplan.writers.layers import DASHED, PATH_DASH_MM, Layer
from floorplan.writers.occupancy import TEXT_WEIGHT, Occupancy, Rectangle
from floorplan.writers.placed_dimension import PlacedDimension
from floorplan.writers.scene import Align, Fill, Item, Label, Scene, Stroke
from floorplan.writers.sheet_scene import frame_items, note_items, schedule_items, symbol_items, value_items
from floorplan.writers.stamp_layout import PlacedStamp, stamp_rectangle
from floorplan.writers.text_size import text_width

EXTENSION_GAP_MM = 0.8  # between the face and its extension line
EXTENSION_OVER_MM = 1.0  # beyond the dimension line
LINE_NOTE_MM = 1.6  # capital height of the words along free lines and glazing
OPEN_DOTS_MM = (0.5, 1.0)  # dotted: no wall, the end of what was seen
WORDED_SIDES = 6  # open sides that say so; the others are dotted alone
WORDED_LINES = 3  # more lines off the axes than these say their angle in the notes, not each by itself
TOUCHING_MM = 1.5  # a dimension line this close to its face needs no extension line
TICK_PEN_MM = 0.35  # twice the dimension line: the stroke must be found at once
ROOM_TINT = "#f6f8f6"


def sheet_scene(composition: Composition, project: ProjectConfig, facts: SheetFacts) -> Scene:
    """The whole sheet."""
    items = [
        *plan_items(composition),
        *frame_items(composition),
        *value_items(composition, project, facts),
        *schedule_items(composition),
        *note_items(composition, facts),
        *symbol_items(composition, project),
    ]
    return Scene(composition.sheet.width_mm, composition.sheet.height_mm, tuple(items))


def plan_items(composition: Composition) -> list[Item]:
    """Everything of the plan that is plotted, back to front."""
    return [
        *_fills(composition),
        *_lines(composition),
        *[item for door in composition.doors for item in _opening(composition, door)],
        *[item for placed in composition.dimensions for item in dimension_items(composition, placed)],
        *[item for stamp in composition.stamps for item in _stamp(composition, stamp)],
    ]


def _fills(composition: Composition) -> list[Item]:
    plan, ink = composition.plan, composition.layers[Layer.WALL_PATTERN].ink
    items: list[Item] = []
    for room in plan.rooms:
        rings = tuple(_on_paper(composition, ring) for ring in (room.outline, *room.holes))
        items.append(Fill(Layer.AREA, rings, ROOM_TINT))
    if not composition.strict:
        items += [Fill(Layer.WALL_PATTERN, (_on_paper(composition, wall.fill),), ink) for wall in plan.walls if wall.fill]
    items += [Fill(Layer.COLUMN, (_on_paper(composition, column.outline),), ink) for column in plan.columns]
    return items


def _lines(composition: Composition) -> list[Item]:
    plan = composition.plan
    items: list[Item] = []
    for wall in plan.walls:
        items += [_stroke(composition, Layer.WALL_INFERRED, line) for line in wall.inferred]
    for wall in plan.walls:
        items += [_stroke(composition, Layer.WALL, line) for line in wall.seen]
    items += [Stroke(Layer.COLUMN, _on_paper(composition, column.outline), closed=True) for column in plan.columns]
    for line in plan.free_lines:
        items.append(_stroke(composition, Layer.WALL, (line.start, line.end)))
    for glazing in plan.glazing:
        items.append(_stroke(composition, Layer.GLAZING, (glazing.start, glazing.end)))
    items += [Stroke(Layer.NOTE, _on_paper(composition, side), dash_mm=OPEN_DOTS_MM) for side in composition.open_sides]
    return [*items, *line_notes(composition)]


def line_notes(composition: Composition) -> list[Label]:
    """Words along free lines, glazing and open sides that have room for them; many lines carry their ids alone.

    Dimensions and room stamps come first: words that would lie on them, or on other words, move along their line or are left out.
    """
    plan = composition.plan
    few = len(plan.free_lines) <= WORDED_LINES
    worded = [(line.start, line.end, f"{line.id}  {line.off_axis_deg:.1f}° off axis" if few else line.id) for line in plan.free_lines]
    longest = sorted(plan.glazing, key=lambda pane: math.dist(pane.start, pane.end))[-1:]
    worded += [(pane.start, pane.end, "glazing") for pane in longest]
    for side in composition.open_sides[:WORDED_SIDES]:
        worded.append((*max(itertools.pairwise(side), key=lambda piece: math.dist(*piece)), "not seen"))
    taken, placed = Occupancy(), []
    for dimension in composition.dimensions:
        taken.add(_on_paper_box(composition, dimension.text_box), TEXT_WEIGHT)
    for stamp in composition.stamps:
        taken.add(_on_paper_box(composition, stamp_rectangle(stamp, composition.scale)), TEXT_WEIGHT)
    for start, end, text in worded:
        for label in _words_along(composition, start, end, text):
            box = _label_box(label)
            if taken.cost(box) == 0.0:
                taken.add(box, TEXT_WEIGHT)
                placed.append(label)
                break
    return placed


def _on_paper_box(composition: Composition, box: Rectangle) -> Rectangle:
    return Rectangle.around((composition.paper((box.x0, box.y0)), composition.paper((box.x1, box.y1))))


def _label_box(label: Label) -> Rectangle:
    """The upright box around words turned about the middle of their baseline."""
    angle, half = math.radians(label.rotation_deg), text_width(label.text, label.height_mm) / 2
    along, up = (math.cos(angle), math.sin(angle)), (-math.sin(angle), math.cos(angle))
    corners = [(side * half, height) for side in (-1, 1) for height in (0.0, label.height_mm)]
    return Rectangle.around((label.at[0] + a * along[0] + h * up[0], label.at[1] + a * along[1] + h * up[1]) for a, h in corners)


def _on_paper(composition: Composition, points: tuple[Point, ...]) -> tuple[Point, ...]:
    return tuple(composition.paper(point) for point in points)


def _stroke(composition: Composition, layer: Layer, points: tuple[Point, ...]) -> Stroke:
    closed = len(points) > 2 and points[0] == points[-1]
    dash = PATH_DASH_MM if composition.layers[layer].linetype == DASHED else ()
    return Stroke(layer, _on_paper(composition, points[:-1] if closed else points), closed, dash_mm=dash)


def _words_along(composition: Composition, start: Point, end: Point, text: str) -> Iterator[Label]:
    """Words along a line, never upside down: on its middle, then towards its ends; none where the line is shorter than its words."""
    a, b = composition.paper(start), composition.paper(end)
    free = math.dist(a, b) - text_width(text, LINE_NOTE_MM)
    if free < 0:
        return
    if (b[0], b[1]) < (a[0], a[1]):
        a, b = b, a
    angle = math.atan2(b[1] - a[1], b[0] - a[0])
    for slide in (0.0, -0.25, 0.25, -0.45, 0.45):
        x = (a[0] + b[0]) / 2 - math.sin(angle) * 1.0 + slide * free * math.cos(angle)
        y = (a[1] + b[1]) / 2 + math.cos(angle) * 1.0 + slide * free * math.sin(angle)
        yield Label(Layer.NOTE, text, (x, y), LINE_NOTE_MM, Align.MIDDLE, math.degrees(angle))


def _opening(composition: Composition, door: DoorSymbol) -> list[Item]:
    if door.opening.kind == OpeningKind.DOOR:
        return [
            Stroke(Layer.DOOR, _on_paper(composition, door.placed(UNIT_LEAF))),
            Stroke(Layer.DOOR, _on_paper(composition, door.placed(unit_arc())), pen_mm=0.13),
        ]
    if door.opening.kind == OpeningKind.PASSAGE:
        return [Stroke(Layer.DOOR, _on_paper(composition, door.placed(UNIT_LINE)), dash_mm=PATH_DASH_MM)]
    return [Stroke(Layer.GLAZING, _on_paper(composition, door.placed(line))) for line in window_lines(door.opening)]


def dimension_items(composition: Composition, placed: PlacedDimension) -> list[Item]:
    """Dimension line, extension lines, oblique strokes and text."""
    layer, axis = Layer.DIMENSION, placed.dimension.axis
    items: list[Item] = [Stroke(layer, _on_paper(composition, placed.line_reach))]
    if placed.leader is not None:
        items.append(Stroke(layer, _on_paper(composition, placed.leader)))
    for feature, end, extended in zip((placed.dimension.start, placed.dimension.end), placed.line, placed.extended, strict=True):
        foot, tip = composition.paper(feature), composition.paper(end)
        half = TICK_MM / 2
        items.append(Stroke(layer, ((tip[0] - half, tip[1] - half), (tip[0] + half, tip[1] + half)), pen_mm=TICK_PEN_MM))
        reach = tip[1 - axis] - foot[1 - axis]
        if extended and abs(reach) > TOUCHING_MM:
            sign = math.copysign(1.0, reach)
            start, stop = foot[1 - axis] + sign * EXTENSION_GAP_MM, tip[1 - axis] + sign * EXTENSION_OVER_MM
            ends = ((tip[0], start), (tip[0], stop)) if axis == 0 else ((start, tip[1]), (stop, tip[1]))
            items.append(Stroke(layer, ends))
    x, y = composition.paper(placed.text_centre)
    half = TEXT_HEIGHT_MM / 2
    at = (x, y - half) if placed.text_rotation_deg == 0.0 else (x + half, y)
    items.append(Label(layer, placed.text, at, TEXT_HEIGHT_MM, Align.MIDDLE, placed.text_rotation_deg))
    return items


def _stamp(composition: Composition, stamp: PlacedStamp) -> list[Item]:
    x, y = composition.paper(stamp.centre)
    return [
        Label(
            Layer.AREA_IDENTITY,
            line.text,
            (x, y + line.baseline_mm * stamp.size),
            line.height_mm * stamp.size,
            Align.MIDDLE,
            bold=line.tag == "NUMBER",
        )
        for line in stamp.shown
    ]
