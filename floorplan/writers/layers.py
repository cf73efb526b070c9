"""The layer table: US NCS names (default) or ISO 13567, with pens, linetypes and what each layer is for."""

from dataclasses import dataclass
from enum import StrEnum

from floorplan.errors import ConfigError

CONTINUOUS = "CONTINUOUS"
DASHED = "DASHED"
PATH_DASH_MM = (3.0, 1.5)  # dash and gap of DASHED on paper: readable at 0.25 mm pens


class Layer(StrEnum):
    """Layers by their US NCS name; `LayerStyle.name` is what the file shows."""

    WALL = "A-WALL"
    WALL_INFERRED = "A-WALL-INFR"
    WALL_PATTERN = "A-WALL-PATT"
    DOOR = "A-DOOR"
    GLAZING = "A-GLAZ"
    COLUMN = "A-COLS"
    AREA = "A-AREA"
    AREA_GROSS = "A-AREA-GROS"
    AREA_IDENTITY = "A-AREA-IDEN"
    DIMENSION = "A-ANNO-DIMS"
    NOTE = "A-ANNO-NOTE"
    SYMBOL = "A-ANNO-SYMB"
    TITLE_BLOCK = "A-ANNO-TTLB"
    PATH = "V-PATH"
    POINTS = "V-PNTS"


@dataclass(frozen=True)
class LayerStyle:
    """`aci` AutoCAD colour index on screen; `ink` colour on paper; `pen_mm` line weight; `visible` and `plotted` as in a CAD layer list."""

    layer: Layer
    name: str
    aci: int
    ink: str
    pen_mm: float
    linetype: str
    visible: bool
    plotted: bool
    description: str


@dataclass(frozen=True)
class _Row:
    layer: Layer
    element: str  # ISO 13567 element (CI/SfB table 1, six places)
    presentation: str  # ISO 13567 presentation, two places
    user: str  # ISO 13567 user-defined suffix, where element and presentation alone are not unique
    aci: int
    ink: str
    pen_mm: float
    description: str
    linetype: str = CONTINUOUS
    visible: bool = True
    plotted: bool = True


_ROWS = (
    _Row(Layer.WALL, "22----", "E-", "", 7, "#000000", 0.50, "Wall faces as seen"),
    _Row(Layer.WALL_INFERRED, "22----", "E-", "INFR", 8, "#555555", 0.25, "Wall lines inferred, not seen", DASHED),
    _Row(Layer.WALL_PATTERN, "22----", "H-", "", 254, "#d4d4d4", 0.13, "Wall fill"),
    _Row(Layer.DOOR, "32----", "E-", "", 30, "#000000", 0.25, "Doors and passages"),
    _Row(Layer.GLAZING, "37----", "E-", "", 4, "#0077aa", 0.25, "Glazing and windows"),
    _Row(Layer.COLUMN, "28----", "E-", "", 7, "#000000", 0.50, "Columns"),
    _Row(Layer.AREA, "00----", "E-", "AREA", 3, "#2e8b57", 0.13, "Room outlines on the inner faces", plotted=False),
    _Row(Layer.AREA_GROSS, "00----", "E-", "GROS", 5, "#4466aa", 0.13, "Gross outline of the floor", plotted=False),
    _Row(Layer.AREA_IDENTITY, "00----", "T-", "IDEN", 3, "#1f3d2b", 0.25, "Room number, area, ceiling height"),
    _Row(Layer.DIMENSION, "------", "D-", "", 1, "#8b1a1a", 0.18, "Numbered dimensions, face to face"),
    _Row(Layer.NOTE, "------", "T-", "NOTE", 7, "#222222", 0.18, "Notes"),
    _Row(Layer.SYMBOL, "------", "Y-", "", 7, "#222222", 0.25, "Scale bar and north arrow"),
    _Row(Layer.TITLE_BLOCK, "------", "B-", "", 7, "#000000", 0.35, "Sheet frame and title block"),
    _Row(Layer.PATH, "90----", "E-", "PATH", 6, "#cc44cc", 0.13, "Trajectory of the sensor", visible=False, plotted=False),
    _Row(Layer.POINTS, "90----", "E-", "PNTS", 9, "#999999", 0.13, "Evidence points", visible=False, plotted=False),
)

_ISO_EMPTY_OPTIONAL = "E---------"  # status: existing; sector, phase, projection, scale, work package: not used
LAYER_SETS = ("ncs", "iso13567")


def _iso_name(row: _Row) -> str:
    base = f"A-{row.element}{row.presentation}"
    return base + _ISO_EMPTY_OPTIONAL + row.user if row.user else base


def layer_styles(layer_set: str) -> dict[Layer, LayerStyle]:
    """Every layer of the drawing, in drawing order; raises ConfigError for a set that is not in `LAYER_SETS`."""
    if layer_set not in LAYER_SETS:
        raise ConfigError(f"drawing.layers = {layer_set!r}: no such layer set; use one of {', '.join(LAYER_SETS)}")
    return {
        row.layer: LayerStyle(
            layer=row.layer,
            name=row.layer.value if layer_set == "ncs" else _iso_name(row),
            aci=row.aci,
            ink=row.ink,
            pen_mm=row.pen_mm,
            linetype=row.linetype,
            visible=row.visible,
            plotted=row.plotted,
            description=row.description,
        )
        for row in _ROWS
    }
