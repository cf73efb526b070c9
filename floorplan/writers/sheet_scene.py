"""Frame, title block, schedule, notes, scale bar and north arrow as strokes and labels on paper."""

import math

from floorplan.config import ProjectConfig
from floorplan.model.plan import Point
from floorplan.writers.composition import Composition
from floorplan.writers.facts import SheetFacts
from floorplan.writers.layers import Layer
from floorplan.writers.scene import Align, Fill, Item, Label, Stroke
from floorplan.writers.sheet_size import Box
from floorplan.writers.sheet_words import SCHEDULE_HEADINGS, area_unit, notes, schedule
from floorplan.writers.text_size import LINE_SPACING, shortened, text_width, wrapped
from floorplan.writers.title_block import CAPTION_MM, PAD_MM, TITLE_BLOCK, Cell, block_height_mm, cells, values

__all__ = ["TITLE_BLOCK", "frame_items", "note_items", "schedule_items", "symbol_items", "value_label"]

HEADING_MM = 2.2
WORDS_MM = 1.6
FRAME_PEN_MM = 0.7  # ISO 5457
THIN_PEN_MM = 0.18
SYMBOL_ROOM_MM = 24.0  # strip kept above the title block for scale bar and north
SCHEDULE_SHARE = 0.55  # of the strip's free height, at most, when there are notes too
COLUMN_SHARES = (0.0, 0.13, 0.58, 0.74, 1.0)  # right or left edges of the schedule's columns
BAR_DIVISIONS = 4
BAR_MM = 1.6
NORTH_RADIUS_MM = 7.0
MINIMUM_VALUE_MM = 1.2
RULE_ROOM_MM = 0.8  # extra space below a rule of the schedule


def rectangle(box: Box) -> tuple[Point, ...]:
    return (box.left, box.bottom), (box.right, box.bottom), (box.right, box.top), (box.left, box.top)


def frame_items(composition: Composition) -> list[Item]:
    """The frame, the strip's edge, the cells and captions of the title block: all that is the same for every plan."""
    sheet, layer = composition.sheet, Layer.TITLE_BLOCK
    strip, top = sheet.strip, sheet.strip.bottom + block_height_mm()
    items: list[Item] = [
        Stroke(layer, rectangle(sheet.frame), closed=True, pen_mm=FRAME_PEN_MM),
        Stroke(layer, ((strip.left, strip.bottom), (strip.left, strip.top))),
        Stroke(layer, ((strip.left, top), (strip.right, top))),
    ]
    for cell in cells(strip):
        box = cell.box
        if box.bottom > strip.bottom:
            items.append(Stroke(layer, ((box.left, box.bottom), (box.right, box.bottom)), pen_mm=THIN_PEN_MM))
        if box.left > strip.left:
            items.append(Stroke(layer, ((box.left, box.bottom), (box.left, box.top)), pen_mm=THIN_PEN_MM))
        items.append(Label(layer, cell.field.caption, (box.left + PAD_MM, box.top - PAD_MM - CAPTION_MM), CAPTION_MM))
    return items


def value_label(cell: Cell, text: str) -> Label:
    """A field's value in its cell, made smaller and then shortened until it fits."""
    room, height = cell.box.width - 2 * PAD_MM, cell.field.height_mm
    wide = text_width(text, height)
    if wide > room:
        height = max(MINIMUM_VALUE_MM, height * room / wide)
    return Label(Layer.TITLE_BLOCK, shortened(text, room, height), (cell.box.left + PAD_MM, cell.box.bottom + PAD_MM + 0.4), height)


def value_items(composition: Composition, project: ProjectConfig, facts: SheetFacts) -> list[Item]:
    """The values of the title block's fields."""
    worded = values(composition, project, facts)
    return [value_label(cell, worded[cell.field.tag]) for cell in cells(composition.sheet.strip) if worded[cell.field.tag]]


def _words_box(composition: Composition) -> Box:
    strip = composition.sheet.strip
    return Box(strip.left + 3, strip.bottom + block_height_mm() + SYMBOL_ROOM_MM, strip.right - 3, strip.top - 3)


def schedule_items(composition: Composition) -> list[Item]:
    """The room schedule at the top of the strip; rooms that do not fit are counted in its last line."""
    rows, area = schedule(composition.plan, composition.units), _words_box(composition)
    if not rows:
        return []
    step = WORDS_MM * LINE_SPACING
    shown = rows[:-1][: max(1, int((area.height * SCHEDULE_SHARE - HEADING_MM * 2) / step) - 2)]
    headings = tuple(f"{word} {area_unit(composition.units)}" if word == "Area" else word for word in SCHEDULE_HEADINGS)
    table = [headings, *(row.cells for row in shown)]
    if len(shown) < len(rows) - 1:
        table.append(("", f"and {len(rows) - 1 - len(shown)} more", "", "", ""))
    table.append(rows[-1].cells)
    layer, baseline = Layer.NOTE, area.top - HEADING_MM
    items: list[Item] = [Label(layer, "ROOMS", (area.left, baseline), HEADING_MM, bold=True)]
    for index, row in enumerate(table):
        baseline -= step if index else HEADING_MM * 1.8
        baseline -= RULE_ROOM_MM if index in (1, len(table) - 1) else 0.0
        items += _schedule_row(row, area, baseline, bold=index in (0, len(table) - 1))
        if index in (0, len(table) - 2):
            rule = baseline - WORDS_MM * (LINE_SPACING - 1) / 2
            items.append(Stroke(Layer.TITLE_BLOCK, ((area.left, rule), (area.right, rule)), pen_mm=THIN_PEN_MM))
    return items


def _schedule_row(row: tuple[str, ...], area: Box, baseline: float, bold: bool) -> list[Item]:
    items: list[Item] = []
    for column, text in enumerate(row):
        x = area.left + COLUMN_SHARES[column] * area.width
        align = Align.START if column < 2 else Align.END
        room = (COLUMN_SHARES[2] - COLUMN_SHARES[1]) * area.width - text_width("000.00", WORDS_MM)
        fitted = shortened(text, room, WORDS_MM) if column == 1 and row[2] else text
        if fitted:
            items.append(Label(Layer.NOTE, fitted, (x, baseline), WORDS_MM, align, bold=bold))
    return items


def note_items(composition: Composition, facts: SheetFacts) -> list[Item]:
    """Numbered notes below the schedule, wrapped to the strip; what does not fit is said to be in the report."""
    area = _words_box(composition)
    lowest = [item.at[1] for item in schedule_items(composition) if isinstance(item, Label)]
    baseline = (min(lowest) - 3 * HEADING_MM) if lowest else area.top - HEADING_MM
    items: list[Item] = [Label(Layer.NOTE, "NOTES", (area.left, baseline), HEADING_MM, bold=True)]
    baseline -= HEADING_MM * 0.4
    step, indent = WORDS_MM * LINE_SPACING, 2.2 * WORDS_MM
    said = notes(composition, facts)
    for number, note in enumerate(said, 1):
        lines = wrapped(note, area.width - indent, WORDS_MM)
        if baseline - len(lines) * step < area.bottom + (step if number < len(said) else 0):
            more = f"{len(said) - number + 1} more notes are in the report."
            items.append(Label(Layer.NOTE, more, (area.left, baseline - step), WORDS_MM))
            break
        items.append(Label(Layer.NOTE, f"{number}", (area.left, baseline - step), WORDS_MM))
        for line in lines:
            baseline -= step
            items.append(Label(Layer.NOTE, line, (area.left + indent, baseline), WORDS_MM))
        baseline -= step * 0.25
    return items


def symbol_items(composition: Composition, project: ProjectConfig) -> list[Item]:
    """Scale bar, and north when it is known, between notes and title block."""
    strip = composition.sheet.strip
    base = strip.bottom + block_height_mm()
    items = _scale_bar(composition, (strip.left + 5, base + 6))
    if project.north_deg is not None:
        items += _north((strip.right - NORTH_RADIUS_MM - 4, base + SYMBOL_ROOM_MM / 2), project.north_deg)
    return items


def _scale_bar(composition: Composition, at: Point) -> list[Item]:
    """A bar of four fields: the longest round length that leaves room for the north arrow."""
    units, scale = composition.units, composition.scale
    room = composition.sheet.strip_mm - 2 * NORTH_RADIUS_MM - 24
    one = 1.0 if units.metric else 0.3048
    step = max((s for s in (0.1, 0.2, 0.5, 1, 2, 5, 10, 20, 50, 100) if scale.paper_mm(s * one) * BAR_DIVISIONS <= room), default=0.1)
    field = scale.paper_mm(step * one)
    layer, (x, y) = Layer.SYMBOL, at
    items: list[Item] = [Stroke(layer, rectangle(Box(x, y, x + BAR_DIVISIONS * field, y + BAR_MM)), closed=True, pen_mm=THIN_PEN_MM)]
    for index in range(BAR_DIVISIONS + 1):
        left = x + index * field
        if index % 2 == 0 and index < BAR_DIVISIONS:
            items.append(Fill(layer, (rectangle(Box(left, y, left + field, y + BAR_MM)),), "#222222"))
        unit = (" m" if units.metric else " ft") if index == BAR_DIVISIONS else ""
        if index % 2 == 0:
            items.append(Label(layer, f"{index * step:g}{unit}", (left, y + BAR_MM + 1.2), WORDS_MM, Align.MIDDLE))
    items.append(Label(layer, f"Scale {scale.label} on {composition.sheet.name}", (x, y - 3.4), WORDS_MM))
    return items


def _north(centre: Point, north_deg: float) -> list[Item]:
    """A circle with a needle; `north_deg` counter-clockwise from the plan's +y."""
    turn = math.radians(north_deg)
    along, aside = (-math.sin(turn), math.cos(turn)), (math.cos(turn), math.sin(turn))

    def at(u: float, v: float) -> Point:
        return centre[0] + u * aside[0] + v * along[0], centre[1] + u * aside[1] + v * along[1]

    radius, layer = NORTH_RADIUS_MM * 0.75, Layer.SYMBOL
    circle = tuple(at(radius * math.cos(a), radius * math.sin(a)) for a in (math.tau * step / 48 for step in range(48)))
    tip, left, right, tail = at(0, radius), at(-radius * 0.35, -radius * 0.7), at(radius * 0.35, -radius * 0.7), at(0, -radius * 0.4)
    letter = at(0, radius + 2.6)
    return [
        Stroke(layer, circle, closed=True, pen_mm=THIN_PEN_MM),
        Fill(layer, ((tip, left, tail),), "#222222"),
        Stroke(layer, (tip, right, tail), closed=True, pen_mm=THIN_PEN_MM),
        Label(layer, "N", (letter[0], letter[1] - 1.0), 2.0, Align.MIDDLE, bold=True),
    ]
