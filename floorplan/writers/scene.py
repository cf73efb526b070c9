"""The sheet as a flat list of strokes, fills and labels in paper millimetres (origin at the lower left, y up).

Every picture format (SVG, PDF, PNG) draws one `Scene`; the DXF sheet takes its frame and tables from the same items.
"""

from dataclasses import dataclass
from enum import StrEnum

from floorplan.model.plan import Point
from floorplan.writers.layers import Layer


class Align(StrEnum):
    """Where a label's anchor lies along its baseline."""

    START = "start"
    MIDDLE = "middle"
    END = "end"


@dataclass(frozen=True)
class Stroke:
    """A line drawn with the pen of its layer, or with `pen_mm`; closed strokes do not repeat their first point."""

    layer: Layer
    points: tuple[Point, ...]
    closed: bool = False
    pen_mm: float | None = None
    dash_mm: tuple[float, ...] = ()


@dataclass(frozen=True)
class Fill:
    """An area (even-odd over its rings) in one colour."""

    layer: Layer
    rings: tuple[tuple[Point, ...], ...]
    colour: str


@dataclass(frozen=True)
class Label:
    """One line of text: `at` is on the baseline, `height_mm` the height of capitals, `rotation_deg` counter-clockwise."""

    layer: Layer
    text: str
    at: Point
    height_mm: float
    align: Align = Align.START
    rotation_deg: float = 0.0
    bold: bool = False


Item = Stroke | Fill | Label


@dataclass(frozen=True)
class Scene:
    """A sheet of paper and what is on it, drawn in order."""

    width_mm: float
    height_mm: float
    items: tuple[Item, ...]
