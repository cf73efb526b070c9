"""The paper-space sheet: viewport at true scale, title block with attributes, schedule, notes, scale bar and north."""

from typing import TYPE_CHECKING

from floorplan.config import ProjectConfig
from floorplan.writers.composition import Composition
from floorplan.writers.dxf_blocks import draw_items, draw_label, free_name
from floorplan.writers.dxf_document import TEXT_STYLE, model_per_mm
from floorplan.writers.facts import SheetFacts
from floorplan.writers.layers import Layer
from floorplan.writers.scene import Label
from floorplan.writers.sheet_scene import frame_items, note_items, schedule_items, symbol_items, value_label
from floorplan.writers.title_block import TITLE_BLOCK, cells, values

if TYPE_CHECKING:
    from ezdxf.document import Drawing
    from ezdxf.layouts.layout import Paperspace

SCHEDULE_BLOCK = "ROOM_SCHEDULE"
SYMBOL_BLOCK = "SCALE_AND_NORTH"
LAYOUT_NAME = "Sheet"
EMPTY_LAYOUT = "Layout1"  # the one a new document has
ONE_SHEET = 2  # layouts of a document with one: the model's, and the sheet's
VIEWPORT_LAYER = "Defpoints"  # never plotted: no frame around the viewport
VIEWPORT_INSET_MM = 1.0


def draw_sheet(document: "Drawing", composition: Composition, project: ProjectConfig, facts: SheetFacts) -> None:
    """One layout of the sheet's size with everything on it."""
    sheet = composition.sheet
    paper = _layout(document)
    paper.page_setup(size=(sheet.width_mm, sheet.height_mm), margins=(0, 0, 0, 0), units="mm", name=sheet.name.replace(" ", "_"))
    _add_viewport(paper, composition)
    _add_title_block(document, paper, composition, project, facts)
    _add_block(document, paper, SCHEDULE_BLOCK, schedule_items(composition), composition.layers[Layer.TITLE_BLOCK].name)
    _add_block(document, paper, SYMBOL_BLOCK, symbol_items(composition, project), composition.layers[Layer.SYMBOL].name)
    for item in note_items(composition, facts):
        if isinstance(item, Label):
            draw_label(paper, item, composition.layers[Layer.NOTE].name)


def _layout(document: "Drawing") -> "Paperspace":
    """The layout of the sheet: ours is the empty document's first; a template keeps its own and gets one more."""
    if LAYOUT_NAME in document.layouts.names():
        if len(document.layouts) == ONE_SHEET:
            document.layouts.new(EMPTY_LAYOUT)  # a document keeps one sheet at least
        document.layouts.delete(LAYOUT_NAME)
    if document.layouts.names() == ["Model", EMPTY_LAYOUT]:
        document.layouts.rename(EMPTY_LAYOUT, LAYOUT_NAME)
    else:
        document.layouts.new(LAYOUT_NAME)
    document.layouts.set_active_layout(LAYOUT_NAME)
    return document.paperspace(LAYOUT_NAME)


def add_title_block(document: "Drawing", composition: Composition, worded: dict[str, str]) -> None:
    """The definition of our title block for this sheet; heights are chosen so that `worded` fits its cells."""
    block = document.blocks.new(TITLE_BLOCK)
    draw_items(block, frame_items(composition), "0")
    for cell in cells(composition.sheet.strip):
        label = value_label(cell, worded[cell.field.tag])
        definition = block.add_attdef(cell.field.tag, label.at, dxfattribs={"height": label.height_mm, "style": TEXT_STYLE})
        definition.dxf.prompt = cell.field.caption


def _add_viewport(paper: "Paperspace", composition: Composition) -> None:
    area = composition.sheet.drawing
    per_mm = model_per_mm(composition)
    x0, y0 = composition.paper_origin_mm
    width, height = area.width - 2 * VIEWPORT_INSET_MM, area.height - 2 * VIEWPORT_INSET_MM
    centre = area.centre
    viewport = paper.add_viewport(
        center=centre,
        size=(width, height),
        view_center_point=((centre[0] - x0) * per_mm, (centre[1] - y0) * per_mm),
        view_height=height * per_mm,
        dxfattribs={"layer": VIEWPORT_LAYER},
    )
    viewport.dxf.flags |= 16384  # locked: the scale cannot be changed by accident


def _add_title_block(document: "Drawing", paper: "Paperspace", composition: Composition, project: ProjectConfig, facts: SheetFacts) -> None:
    layer = composition.layers[Layer.TITLE_BLOCK].name
    worded = values(composition, project, facts)
    if TITLE_BLOCK not in document.blocks:
        add_title_block(document, composition, worded)
    insert = paper.add_blockref(TITLE_BLOCK, (0, 0), dxfattribs={"layer": layer})
    insert.add_auto_attribs(worded)
    for attribute in insert.attribs:
        attribute.dxf.layer = layer


def _add_block(document: "Drawing", paper: "Paperspace", name: str, items: list, layer: str) -> None:  # type: ignore[type-arg]
    if not items:
        return
    name = free_name(document, name)
    draw_items(document.blocks.new(name), items, "0")
    paper.add_blockref(name, (0, 0), dxfattribs={"layer": layer})
