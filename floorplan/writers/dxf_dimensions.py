"""DIMENSION entities with their own style.

Their geometry blocks are drawn here, from the placed text: the same in every program, no font file asked, text clear of text.
"""

from typing import TYPE_CHECKING

from floorplan.model.plan import Point
from floorplan.writers.composition import Composition
from floorplan.writers.dimension_spots import TEXT_GAP_MM, TEXT_HEIGHT_MM, TICK_MM
from floorplan.writers.dxf_document import DIMENSION_STYLE, TEXT_STYLE, model_per_mm
from floorplan.writers.dxf_template import APPLICATION
from floorplan.writers.layers import Layer
from floorplan.writers.placed_dimension import PlacedDimension
from floorplan.writers.plan_scene import EXTENSION_GAP_MM, EXTENSION_OVER_MM, dimension_items
from floorplan.writers.scene import Label

if TYPE_CHECKING:
    from ezdxf.document import Drawing

ROTATED_WITH_BLOCK = 32  # dimtype: linear; the block belongs to this dimension alone
USER_TEXT_PLACE = 128  # dimtype: the text stands where we put it
MIDDLE_CENTRE = 5
LINEAR_UNITS = {"m": 2, "mm": 2, "ft": 4}  # DIMLUNIT: decimal, architectural
DECIMALS = {"m": 3, "mm": 0, "ft": 3}


def add_dimension_style(document: "Drawing", composition: Composition) -> None:
    """Oblique strokes, text above the line, sizes in paper millimetres times the scale."""
    if DIMENSION_STYLE in document.dimstyles:
        return
    style = document.dimstyles.new(DIMENSION_STYLE)
    values = {
        "dimscale": model_per_mm(composition),
        "dimtxt": TEXT_HEIGHT_MM,
        "dimgap": TEXT_GAP_MM,
        "dimtsz": TICK_MM / 2,
        "dimasz": TICK_MM,
        "dimexo": EXTENSION_GAP_MM,
        "dimexe": EXTENSION_OVER_MM,
        "dimtad": 1,
        "dimtih": 0,
        "dimtoh": 0,
        "dimlunit": LINEAR_UNITS[composition.units.name],
        "dimdec": DECIMALS[composition.units.name],
        "dimzin": 0,
        "dimtmove": 2,
        "dimtxsty": TEXT_STYLE,
    }
    for name, value in values.items():
        style.set_dxf_attrib(name, value)


def add_dimensions(document: "Drawing", composition: Composition) -> None:
    """One DIMENSION per placed dimension; its id is also in its extended data."""
    for placed in composition.dimensions:
        _add_dimension(document, composition, placed)


def _add_dimension(document: "Drawing", composition: Composition, placed: PlacedDimension) -> None:
    per_metre, layer = composition.units.per_metre, composition.layers[Layer.DIMENSION].name
    block = document.blocks.new_anonymous_block(type_char="D")
    entity = document.modelspace().new_entity(
        "DIMENSION",
        {
            "layer": layer,
            "dimstyle": DIMENSION_STYLE,
            "dimtype": ROTATED_WITH_BLOCK | USER_TEXT_PLACE,
            "geometry": block.name,
            "defpoint": _scaled(placed.line[1], per_metre),
            "defpoint2": _scaled(placed.dimension.start, per_metre),
            "defpoint3": _scaled(placed.dimension.end, per_metre),
            "text_midpoint": _scaled(placed.text_centre, per_metre),
            "angle": 90.0 * placed.dimension.axis,
            "attachment_point": MIDDLE_CENTRE,
            "text": placed.text,
        },
    )
    if placed.text_rotation_deg != 90.0 * placed.dimension.axis:
        entity.dxf.text_rotation = placed.text_rotation_deg
    entity.set_xdata(APPLICATION, [(1000, placed.dimension.id)])
    _draw_geometry(document, composition, placed, block)


def _draw_geometry(document: "Drawing", composition: Composition, placed: PlacedDimension, block: "object") -> None:
    from ezdxf.enums import TextEntityAlignment
    from ezdxf.layouts.blocklayout import BlockLayout

    if not isinstance(block, BlockLayout):
        raise TypeError("a dimension's geometry belongs into a block")
    per_mm, layer = model_per_mm(composition), composition.layers[Layer.DIMENSION].name
    for item in dimension_items(composition, placed):
        if isinstance(item, Label):
            continue
        points = [_model(composition, point) for point in item.points]  # type: ignore[union-attr]
        block.add_line(points[0], points[1], dxfattribs={"layer": layer})
    text = block.add_text(
        placed.text,
        height=TEXT_HEIGHT_MM * per_mm,
        rotation=placed.text_rotation_deg,
        dxfattribs={"style": TEXT_STYLE, "layer": layer},
    )
    text.set_placement(_scaled(placed.text_centre, composition.units.per_metre), align=TextEntityAlignment.MIDDLE_CENTER)
    for point in (*placed.line, placed.dimension.start, placed.dimension.end):
        block.add_point(_scaled(point, composition.units.per_metre), dxfattribs={"layer": "Defpoints"})


def _scaled(point: Point, per_metre: float) -> tuple[float, float, float]:
    return point[0] * per_metre, point[1] * per_metre, 0.0


def _model(composition: Composition, paper: Point) -> Point:
    """Paper millimetres back to drawing units."""
    x0, y0 = composition.paper_origin_mm
    per_mm = model_per_mm(composition)
    return (paper[0] - x0) * per_mm, (paper[1] - y0) * per_mm
