"""Block definitions: doors and passages, room stamps, and any scene items as a block."""

import math
from collections.abc import Iterable
from typing import TYPE_CHECKING

from floorplan.model.plan import OpeningKind
from floorplan.writers.door_symbol import UNIT_LEAF, UNIT_LINE
from floorplan.writers.dxf_document import TEXT_STYLE
from floorplan.writers.layers import DASHED
from floorplan.writers.scene import Align, Fill, Item, Label, Stroke
from floorplan.writers.stamp_layout import STAMP_BASELINES_MM, STAMP_HEIGHTS_MM

if TYPE_CHECKING:
    from ezdxf.document import Drawing
    from ezdxf.layouts.base import BaseLayout

OPENING_BLOCKS = {OpeningKind.DOOR: "DOOR", OpeningKind.PASSAGE: "PASSAGE"}
STAMP_BLOCK = "ROOM_STAMP"
WIDTH_TAG = "WIDTH"
WIDTH_TEXT = 0.15  # height of the (invisible) width attribute, in widths of the opening


def free_name(document: "Drawing", name: str) -> str:
    """`name`, or where a template owns a block of that name, the next one that is free: the office's symbol is never redefined."""
    tried = (name, *(f"{name}_{number}" for number in range(2, len(document.blocks) + 3)))
    return next(one for one in tried if one not in document.blocks)


def add_opening_blocks(document: "Drawing") -> dict[OpeningKind, str]:
    """Symbols in an opening one unit wide, along x, centred; on layer 0, so that they take the layer of their INSERT. Gives their names."""
    names = {kind: free_name(document, name) for kind, name in OPENING_BLOCKS.items()}
    door = document.blocks.new(names[OpeningKind.DOOR])
    door.add_line(*UNIT_LEAF)
    door.add_arc((-0.5, 0.0), radius=1.0, start_angle=0.0, end_angle=90.0)
    passage = document.blocks.new(names[OpeningKind.PASSAGE])
    passage.add_line(*UNIT_LINE, dxfattribs={"linetype": DASHED})
    for block in (door, passage):
        definition = block.add_attdef(WIDTH_TAG, (0.0, -2 * WIDTH_TEXT), dxfattribs={"height": WIDTH_TEXT, "style": TEXT_STYLE})
        definition.dxf.prompt = "Clear width, m"
        definition.is_invisible = True
    return names


def add_stamp_block(document: "Drawing") -> str:
    """The room stamp in paper millimetres: number, name, area, ceiling height, centred on its insertion point. Gives its name."""
    from ezdxf.enums import TextEntityAlignment

    block = document.blocks.new(free_name(document, STAMP_BLOCK))
    for tag, height in STAMP_HEIGHTS_MM.items():
        definition = block.add_attdef(tag, dxfattribs={"height": height, "style": TEXT_STYLE})
        definition.set_placement((0.0, STAMP_BASELINES_MM[tag]), align=TextEntityAlignment.CENTER)
        definition.dxf.prompt = tag.capitalize()
    return str(block.name)


def draw_items(target: "BaseLayout", items: Iterable[Item], layer: str) -> None:
    """Strokes, fills and labels as entities on one layer, in the target's own units (paper millimetres)."""
    for item in items:
        if isinstance(item, Label):
            draw_label(target, item, layer)
        elif isinstance(item, Fill):
            solid = target.add_solid([*item.rings[0][:2], *(item.rings[0][:1:-1])], dxfattribs={"layer": layer})
            solid.dxf.thickness = 0.0
        else:
            _draw_stroke(target, item, layer)


def _draw_stroke(target: "BaseLayout", stroke: Stroke, layer: str) -> None:
    line = target.add_lwpolyline(stroke.points, close=stroke.closed, dxfattribs={"layer": layer})
    if stroke.pen_mm is not None:
        line.dxf.lineweight = round(stroke.pen_mm * 100)


def draw_label(target: "BaseLayout", label: Label, layer: str) -> None:
    """One TEXT entity."""
    from ezdxf.enums import TextEntityAlignment

    align = {
        Align.START: TextEntityAlignment.LEFT,
        Align.MIDDLE: TextEntityAlignment.CENTER,
        Align.END: TextEntityAlignment.RIGHT,
    }[label.align]
    attributes = {"layer": layer, "style": TEXT_STYLE}
    text = target.add_text(label.text, height=label.height_mm, rotation=label.rotation_deg, dxfattribs=attributes)
    text.set_placement(label.at, align=align)


def turned(point: tuple[float, float], angle_deg: float) -> tuple[float, float]:
    cosine, sine = math.cos(math.radians(angle_deg)), math.sin(math.radians(angle_deg))
    return point[0] * cosine - point[1] * sine, point[0] * sine + point[1] * cosine
