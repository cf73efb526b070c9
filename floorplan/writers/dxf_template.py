"""Title blocks as DXF templates: opening and checking an office's own."""

from pathlib import Path
from typing import TYPE_CHECKING

from floorplan.config import DrawingConfig
from floorplan.errors import ConfigError
from floorplan.writers.layers import Layer, LayerStyle, layer_styles
from floorplan.writers.sheet_size import sheet_named
from floorplan.writers.title_block import TITLE_BLOCK

if TYPE_CHECKING:
    from ezdxf.document import Drawing

BEYOND_MM = 1.0  # lines on the paper's very edge
APPLICATION = "FLOORPLAN"  # registered application of the extended data that carries our ids
REQUIRED_TAGS = ("PROJECT", "DATE", "SCALE", "ACCURACY")  # a sheet without these is not one of this program's plans


def check_template(drawing: DrawingConfig) -> None:
    """Raise ConfigError naming everything that the template of `drawing` lacks, before any work is done; none is fine."""
    if drawing.template:
        document = open_template(drawing.template, layer_styles(drawing.layers))
        _check_size(document, drawing)


def _check_size(document: "Drawing", drawing: DrawingConfig) -> None:
    """Raise ConfigError for a title block whose lines reach beyond the sheet."""
    from ezdxf.bbox import extents

    sheet = sheet_named(drawing.sheet)
    box = extents(document.blocks.get(TITLE_BLOCK).query("LINE LWPOLYLINE POLYLINE SOLID"), fast=True)
    if not box.has_data or (box.extmax.x <= sheet.width_mm + BEYOND_MM and box.extmax.y <= sheet.height_mm + BEYOND_MM):
        return
    raise ConfigError(
        f"drawing.template = {drawing.template!r}: its title block reaches to {box.extmax.x:.0f} x {box.extmax.y:.0f} mm, beyond the sheet "
        f"{sheet.name} of {sheet.width_mm:g} x {sheet.height_mm:g}; give --sheet the size that it was made for"
    )


def open_template(path: str, layers: dict[Layer, LayerStyle]) -> "Drawing":
    """The template as a document to draw into; raises ConfigError naming everything it lacks."""
    from ezdxf.filemanagement import readfile
    from ezdxf.lldxf.const import DXFError

    if not Path(path).is_file():
        raise ConfigError(f"drawing.template = {path!r}: there is no such file")
    try:
        document = readfile(path)
    except (DXFError, OSError) as error:
        raise ConfigError(f"drawing.template = {path!r}: this is no DXF file that can be read ({error})") from error
    lacking = template_faults(document, layers)
    if holds_plan(document):
        raise ConfigError(
            f"drawing.template = {path!r} is a drawing with a plan of this program in it, which would lie under the new one; "
            "delete all in its model space, or start from what 'floorplan template OUT.dxf' writes"
        )
    if lacking:
        raise ConfigError(f"drawing.template = {path!r} lacks {'; '.join(lacking)}; start from what 'floorplan template OUT.dxf' writes")
    return document


def holds_plan(document: "Drawing") -> bool:
    """Whether the model space holds what this program drew: its entities carry our ids."""
    return any(entity.has_xdata(APPLICATION) for entity in document.modelspace())


def template_faults(document: "Drawing", layers: dict[Layer, LayerStyle]) -> tuple[str, ...]:
    """What a template must own and does not: the title block with its attributes, and the layer it goes on."""
    faults = []
    layer = layers[Layer.TITLE_BLOCK].name
    if layer not in document.layers:
        faults.append(f"the layer {layer}")
    if TITLE_BLOCK not in document.blocks:
        return (*faults, f"the block {TITLE_BLOCK} with the attributes {', '.join(REQUIRED_TAGS)}")
    owned = {definition.dxf.tag for definition in document.blocks.get(TITLE_BLOCK).query("ATTDEF")}
    missing = [tag for tag in REQUIRED_TAGS if tag not in owned]
    if missing:
        faults.append(f"the attributes {', '.join(missing)} in the block {TITLE_BLOCK}")
    return tuple(faults)
