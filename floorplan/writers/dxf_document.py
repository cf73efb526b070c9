"""An empty DXF document with our layers, linetypes, styles and units, and its bytes, the same for the same input."""

import io
import re
from collections.abc import Iterator
from contextlib import contextmanager
from datetime import UTC, date, datetime
from typing import TYPE_CHECKING

from floorplan.errors import ConfigError
from floorplan.writers.composition import CAFM_DXF_VERSION, DXF_VERSIONS, Composition
from floorplan.writers.dxf_template import APPLICATION, open_template
from floorplan.writers.layers import CONTINUOUS, DASHED, PATH_DASH_MM

if TYPE_CHECKING:
    from ezdxf.document import Drawing

TEXT_STYLE = "FLOORPLAN"
DIMENSION_STYLE = "FLOORPLAN"
FONT = "arial.ttf"  # every CAD program has it or replaces it by one as wide
INSUNITS_METRIC = 1  # $MEASUREMENT
VIEW_MARGIN = 1.15  # a little air around the plan in the start view
SCREEN_ASPECT = 1.6  # of a wide screen
FIXED_JULIAN_DATE = 2451544.91568287  # written where the recording's date is not known


@contextmanager
def fixed_metadata() -> Iterator[None]:
    """ezdxf's own switch for reproducible files: no time, no random identifiers."""
    from ezdxf._options import options

    before = options.write_fixed_meta_data_for_testing
    options.write_fixed_meta_data_for_testing = True
    try:
        yield
    finally:
        options.write_fixed_meta_data_for_testing = before


def new_document(composition: Composition, version: str, template: str = "") -> "Drawing":
    """A document of that DXF version, begun from a template if there is one; raises ConfigError for a version we do not write."""
    from ezdxf.filemanagement import new

    if composition.strict:
        version = CAFM_DXF_VERSION
    if version not in DXF_VERSIONS:
        raise ConfigError(f"drawing.dxf_version = {version!r}: use one of {', '.join(DXF_VERSIONS)}")
    document = open_template(template, composition.layers) if template else new(version, setup=False)
    document.dxfversion = version
    set_up(document, composition)
    return document


def set_up(document: "Drawing", composition: Composition) -> None:
    """Units, linetypes, text style and layers; what the document (a template) already has is left as it is."""
    units = composition.units
    document.header["$INSUNITS"] = units.insunits
    document.header["$MEASUREMENT"] = INSUNITS_METRIC if units.metric else 0
    document.header["$LUNITS"] = 2 if units.metric else 4  # decimal; architectural
    document.header["$LTSCALE"] = model_per_mm(composition)  # patterns are in paper millimetres ...
    document.header["$PSLTSCALE"] = 0  # ... and scaled in model space, so that both spaces look alike
    if DASHED not in document.linetypes:
        dash, gap = PATH_DASH_MM
        document.linetypes.add(DASHED, [dash + gap, dash, -gap], description="Dashed __ __ __")
    if TEXT_STYLE not in document.styles:
        document.styles.add(TEXT_STYLE, font=FONT)
    if APPLICATION not in document.appids:
        document.appids.add(APPLICATION)
    for style in composition.layers.values():
        if style.name in document.layers:
            continue
        linetype = "Continuous" if style.linetype == CONTINUOUS else style.linetype
        weight = round(style.pen_mm * 100)
        layer = document.layers.add(style.name, color=style.aci, linetype=linetype, lineweight=weight, plot=style.plotted)
        layer.description = style.description
        if not style.visible:
            layer.off()


def model_per_mm(composition: Composition) -> float:
    """Drawing units that one millimetre on paper stands for."""
    return composition.scale.model_m(1.0) * composition.units.per_metre


def document_bytes(document: "Drawing", recorded: str) -> bytes:
    """The file; its dates are the recording's (ISO), never the clock's."""
    classes = document.classes
    classes.add_required_classes(document.dxfversion)  # from a set, in an order that changes from process to process: ours is sorted
    classes.classes = dict(sorted(classes.classes.items()))
    stream = io.StringIO()
    document.write(stream)
    text = _without_clock(stream.getvalue(), recorded)
    return document.encode(text)


def _without_clock(text: str, recorded: str) -> str:
    stamp = f"{_julian_date(recorded):.8f}"
    return re.sub(r"(\$TD(?:U?CREATE|U?UPDATE)\n *40\n)[^\n]*", lambda match: match[1] + stamp, text)


def _julian_date(recorded: str) -> float:
    if not re.fullmatch(r"\d{4}-\d{2}-\d{2}.*", recorded):
        return FIXED_JULIAN_DATE
    day = date.fromisoformat(recorded[:10])
    return datetime(day.year, day.month, day.day, tzinfo=UTC).toordinal() + 1721424.5  # Julian day of 0001-01-01 is 1721425.5
