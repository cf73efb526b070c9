"""The drawing of a comparison: DXF in model metres, SVG and PNG as a sheet at true scale."""

from pathlib import Path

from floorplan.compare.changes import Comparison
from floorplan.config import DrawingConfig
from floorplan.errors import UsageError
from floorplan.model.plan import Plan, Point
from floorplan.writers.comparison_items import Change, ChangeLine, ChangeText, borrowed_layer, change_styles, comparison_items
from floorplan.writers.composition import plan_extents
from floorplan.writers.layers import CONTINUOUS, DASHED, PATH_DASH_MM
from floorplan.writers.occupancy import Rectangle
from floorplan.writers.scale import Scale, choose_scale
from floorplan.writers.scene import Align, Item, Label, Scene, Stroke
from floorplan.writers.sheet_size import Sheet, sheet_named

TEXT_MM = 2.0
TEXT_ABOVE_MM = 0.8
TITLE_MM = 3.5
ROW_MM = 6.0
KEY_MM = 14.0  # length of a line in the key
INSUNITS_METRES = 6


def comparison_bytes(kind: str, first: Plan, comparison: Comparison, drawing: DrawingConfig) -> bytes:
    """The drawing as `dxf`, `svg` or `png`. Raises UsageError for another kind, ConfigError for a sheet it does not fit."""
    items = comparison_items(first, comparison)
    extents = _both(plan_extents(first), plan_extents(comparison.second_plan))
    sheet = sheet_named(drawing.sheet)
    scale = choose_scale(drawing.scale, lambda _: extents, sheet.drawing, True)
    if kind == "dxf":
        return _dxf(items, scale)
    scene, title = _scene(items, comparison, sheet, scale, extents), f"{comparison.first} and {comparison.second}"
    if kind == "svg":
        from floorplan.writers.svg import write_svg

        return write_svg(scene, change_styles(), title)
    if kind == "png":
        from floorplan.writers.figure import png_bytes

        return png_bytes(scene, change_styles())
    raise UsageError(f"a comparison is drawn as dxf, svg or png, not {kind}")


def write_comparison(path: Path, kind: str, first: Plan, comparison: Comparison, drawing: DrawingConfig) -> None:
    """Write the drawing; the file appears whole or not at all."""
    from floorplan.writers import write_atomically

    write_atomically(path, comparison_bytes(kind, first, comparison, drawing))


def _both(a: Rectangle, b: Rectangle) -> Rectangle:
    return Rectangle(min(a.x0, b.x0), min(a.y0, b.y0), max(a.x1, b.x1), max(a.y1, b.y1))


def _scene(items: list[ChangeLine | ChangeText], comparison: Comparison, sheet: Sheet, scale: Scale, extents: Rectangle) -> Scene:
    centre, middle = sheet.drawing.centre, ((extents.x0 + extents.x1) / 2, (extents.y0 + extents.y1) / 2)

    def paper(at: Point) -> Point:
        return centre[0] + scale.paper_mm(at[0] - middle[0]), centre[1] + scale.paper_mm(at[1] - middle[1])

    styles = change_styles()
    drawn: list[Item] = []
    for item in items:
        layer = borrowed_layer(item.change)
        if isinstance(item, ChangeLine):
            dash = PATH_DASH_MM if styles[layer].linetype == DASHED else ()
            drawn.append(Stroke(layer, tuple(paper(at) for at in item.points), dash_mm=dash))
        else:
            x, y = paper(item.at)
            at = (x - TEXT_ABOVE_MM, y) if item.upwards else (x, y + TEXT_ABOVE_MM)
            drawn.append(Label(layer, item.text, at, TEXT_MM, Align.MIDDLE, 90.0 if item.upwards else 0.0))
    return Scene(sheet.width_mm, sheet.height_mm, (*drawn, *_key(comparison, sheet, scale)))


def _key(comparison: Comparison, sheet: Sheet, scale: Scale) -> list[Item]:
    """Title, scale and the meaning of each colour, in the strip beside the drawing."""
    note, left, y = borrowed_layer(Change.NOTE), sheet.strip.left + 4.0, sheet.strip.top - ROW_MM
    items: list[Item] = [Label(note, "Two surveys compared", (left, y), TITLE_MM, bold=True)]
    for text in (f"first: {comparison.first}", f"second: {comparison.second}", f"scale {scale.label}"):
        y -= ROW_MM
        items.append(Label(note, text, (left, y), TEXT_MM))
    for layer, style in change_styles().items():
        if layer is note:
            continue
        y -= ROW_MM
        dash = PATH_DASH_MM if style.linetype == DASHED else ()
        items.append(Stroke(layer, ((left, y + TEXT_MM / 2), (left + KEY_MM, y + TEXT_MM / 2)), dash_mm=dash))
        items.append(Label(note, style.description.split(",")[0], (left + KEY_MM + 2.0, y), TEXT_MM))
    return items


def _dxf(items: list[ChangeLine | ChangeText], scale: Scale) -> bytes:
    from ezdxf.enums import TextEntityAlignment
    from ezdxf.filemanagement import new

    from floorplan.writers.dxf_document import document_bytes, fixed_metadata

    with fixed_metadata():
        document = new("R2010", setup=False)
        document.header["$INSUNITS"] = INSUNITS_METRES
        dash, gap = (scale.model_m(length) for length in PATH_DASH_MM)
        document.linetypes.add(DASHED, [dash + gap, dash, -gap], description="Dashed __ __ __")
        for style in change_styles().values():
            linetype = "Continuous" if style.linetype == CONTINUOUS else style.linetype
            document.layers.add(style.name, color=style.aci, linetype=linetype, lineweight=round(100 * style.pen_mm))
        space = document.modelspace()
        for item in items:
            if isinstance(item, ChangeLine):
                space.add_lwpolyline(item.points, dxfattribs={"layer": item.change.value})
            else:
                rotation = 90.0 if item.upwards else 0.0
                text = space.add_text(item.text, height=scale.model_m(TEXT_MM), rotation=rotation, dxfattribs={"layer": item.change.value})
                text.set_placement(item.at, align=TextEntityAlignment.BOTTOM_CENTER)
        return document_bytes(document, "")
