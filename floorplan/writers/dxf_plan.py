"""The plan in DXF model space: true size, z = 0, one kind of entity per layer."""

import math
from collections.abc import Iterable
from typing import TYPE_CHECKING

import numpy as np

from floorplan.model.plan import OpeningKind, Point
from floorplan.writers.area_ring import slit_ring
from floorplan.writers.composition import Composition
from floorplan.writers.door_symbol import DoorSymbol, window_lines
from floorplan.writers.dxf_blocks import WIDTH_TAG, add_opening_blocks, add_stamp_block, draw_label
from floorplan.writers.dxf_dimensions import add_dimension_style, add_dimensions
from floorplan.writers.dxf_document import SCREEN_ASPECT, VIEW_MARGIN, model_per_mm
from floorplan.writers.dxf_template import APPLICATION
from floorplan.writers.layers import Layer
from floorplan.writers.plan_scene import line_notes
from floorplan.writers.scene import Label
from floorplan.writers.stamp_layout import PlacedStamp

if TYPE_CHECKING:
    from ezdxf.document import Drawing
    from ezdxf.entities.dxfgfx import DXFGraphic

LEAP_M = 2.0  # keyframes are never so far apart: another scan begins, or tracking was lost
EVIDENCE_POINTS = 2000  # POINT entities at most: enough to see what a wall rests on, cheap to open
GREY = (212, 212, 212)  # wall fill


class ModelSpace:
    """Draws plan metres into the model space of a document in its units; adds the blocks it needs."""

    def __init__(self, document: "Drawing", composition: Composition) -> None:
        self.document = document
        self.composition = composition
        self.space = document.modelspace()
        self.per_metre = composition.units.per_metre
        self.opening_blocks = add_opening_blocks(document)
        self.stamp_block = add_stamp_block(document)

    def attributes(self, layer: Layer) -> dict[str, str]:
        return {"layer": self.composition.layers[layer].name}

    def points(self, points: Iterable[Point]) -> list[Point]:
        return [(x * self.per_metre, y * self.per_metre) for x, y in points]

    def line(self, layer: Layer, points: tuple[Point, ...], identity: str, closed: bool = False) -> None:
        """A polyline that carries its id; one that ends where it began is closed instead of repeating the point."""
        if len(points) > 2 and points[0] == points[-1]:
            points, closed = points[:-1], True
        entity = self.space.add_lwpolyline(self.points(points), close=closed, dxfattribs=self.attributes(layer))
        _identify(entity, identity)


def _identify(entity: "DXFGraphic", identity: str) -> None:
    entity.set_xdata(APPLICATION, [(1000, identity)])


def draw_plan(document: "Drawing", composition: Composition) -> None:
    """Everything in model space, and the blocks it needs."""
    space = ModelSpace(document, composition)
    add_dimension_style(document, composition)
    if not composition.strict:
        _draw_fills(space)
    _draw_areas(space)
    _draw_walls(space)
    for door in composition.doors:
        _draw_opening(space, door)
    for stamp in composition.stamps:
        _draw_stamp(space, stamp)
    add_dimensions(document, composition)
    _draw_evidence(space)
    _set_view(space)


def _draw_fills(space: ModelSpace) -> None:
    from ezdxf.colors import RGB

    true_colour = space.document.dxfversion > "AC1015"  # R2000 knows indexed colours only
    for wall in space.composition.plan.walls:
        if wall.fill:
            hatch = space.space.add_hatch(dxfattribs=space.attributes(Layer.WALL_PATTERN))
            hatch.set_solid_fill(rgb=RGB(*GREY) if true_colour else None)
            ring = wall.fill[:-1] if wall.fill[0] == wall.fill[-1] else wall.fill
            hatch.paths.add_polyline_path(space.points(ring), is_closed=True)
            _identify(hatch, wall.id)


def _draw_walls(space: ModelSpace) -> None:
    plan = space.composition.plan
    for wall in plan.walls:
        for line in wall.seen:
            space.line(Layer.WALL, line, wall.id)
        for line in wall.inferred:
            space.line(Layer.WALL_INFERRED, line, wall.id)
    for free in plan.free_lines:
        space.line(Layer.WALL, (free.start, free.end), free.id)
    for glazing in plan.glazing:
        space.line(Layer.GLAZING, (glazing.start, glazing.end), glazing.id)
    for note in line_notes(space.composition):
        _draw_note(space, note)
    for column in plan.columns:
        space.line(Layer.COLUMN, column.outline, column.id, closed=True)


def _draw_note(space: ModelSpace, note: Label) -> None:
    """A label made for paper, at its place in the model."""
    x0, y0 = space.composition.paper_origin_mm
    per_mm = model_per_mm(space.composition)
    at = ((note.at[0] - x0) * per_mm, (note.at[1] - y0) * per_mm)
    label = Label(note.layer, note.text, at, note.height_mm * per_mm, note.align, note.rotation_deg)
    draw_label(space.space, label, space.composition.layers[note.layer].name)


def _draw_areas(space: ModelSpace) -> None:
    plan = space.composition.plan
    for room in plan.rooms:
        space.line(Layer.AREA, slit_ring(room.outline, room.holes), room.id, closed=True)
    for number, ring in enumerate(plan.gross_outline, 1):
        space.line(Layer.AREA_GROSS, ring, f"G{number}", closed=True)


def _draw_opening(space: ModelSpace, door: DoorSymbol) -> None:
    opening = door.opening
    if opening.kind == OpeningKind.WINDOW:
        for line in window_lines(opening):
            space.line(Layer.GLAZING, door.placed(line), opening.id)
        return
    insert = space.space.add_blockref(
        space.opening_blocks[opening.kind],
        space.points([opening.centre])[0],
        dxfattribs={**space.attributes(Layer.DOOR), "rotation": door.rotation_deg % 360.0},
    )
    insert.set_scale(opening.width_m * space.per_metre)
    insert.add_auto_attribs({WIDTH_TAG: f"{opening.width_m:.3f}"})
    for attribute in insert.attribs:
        attribute.dxf.layer = insert.dxf.layer
    _identify(insert, opening.id)


def _draw_stamp(space: ModelSpace, stamp: PlacedStamp) -> None:
    insert = space.space.add_blockref(space.stamp_block, space.points([stamp.centre])[0], dxfattribs=space.attributes(Layer.AREA_IDENTITY))
    insert.set_scale(model_per_mm(space.composition) * stamp.size)
    insert.add_auto_attribs({line.tag: line.text for line in stamp.lines})
    shown = {line.tag for line in stamp.shown}
    for attribute in insert.attribs:
        attribute.dxf.layer = insert.dxf.layer
        attribute.is_invisible = attribute.dxf.tag not in shown
    _identify(insert, stamp.room.id)


def _draw_evidence(space: ModelSpace) -> None:
    plan = space.composition.plan
    walked = plan.trajectory.position_m[:, :2]
    leaps = np.linalg.norm(np.diff(walked, axis=0), axis=1) > LEAP_M
    for piece in np.split(walked, np.flatnonzero(leaps | (np.diff(plan.trajectory.stamp_ns) < 0)) + 1):
        path = [(float(x), float(y)) for x, y in piece]
        if len(path) > 1:
            space.space.add_lwpolyline(space.points(path), dxfattribs=space.attributes(Layer.PATH))
    every = max(1, math.ceil(len(plan.evidence_xy_m) / EVIDENCE_POINTS))
    for point in space.points((float(x), float(y)) for x, y in plan.evidence_xy_m[::every]):
        space.space.add_point(point, dxfattribs=space.attributes(Layer.POINTS))


def _set_view(space: ModelSpace) -> None:
    """Extents, and a start view on the whole plan with its dimensions."""
    box, per = space.composition.extents, space.per_metre
    width, height = (box.x1 - box.x0) * per, (box.y1 - box.y0) * per
    centre = ((box.x0 + box.x1) / 2 * per, (box.y0 + box.y1) / 2 * per)
    space.space.reset_extents((box.x0 * per, box.y0 * per, 0), (box.x1 * per, box.y1 * per, 0))
    space.document.set_modelspace_vport(max(height, width / SCREEN_ASPECT) * VIEW_MARGIN, centre)
