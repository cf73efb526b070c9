"""Paper sizes, the frame on them, and the strip at the right that holds schedule, notes and title block."""

from dataclasses import dataclass

from floorplan.errors import ConfigError

BINDING_MARGIN_MM = 20.0  # ISO 5457: left edge
MARGIN_MM = 10.0  # ISO 5457: the other edges
ANSI_MARGIN_MM = 12.7  # half an inch


@dataclass(frozen=True)
class Box:
    """A rectangle on paper, millimetres."""

    left: float
    bottom: float
    right: float
    top: float

    @property
    def width(self) -> float:
        return self.right - self.left

    @property
    def height(self) -> float:
        return self.top - self.bottom

    @property
    def centre(self) -> tuple[float, float]:
        return (self.left + self.right) / 2, (self.bottom + self.top) / 2


@dataclass(frozen=True)
class Sheet:
    """A sheet in landscape: `frame` inside the margins, `drawing` for the plan, `strip` for words."""

    name: str
    width_mm: float
    height_mm: float
    left_margin_mm: float
    margin_mm: float
    strip_mm: float

    @property
    def frame(self) -> Box:
        return Box(self.left_margin_mm, self.margin_mm, self.width_mm - self.margin_mm, self.height_mm - self.margin_mm)

    @property
    def drawing(self) -> Box:
        return Box(self.frame.left, self.frame.bottom, self.frame.right - self.strip_mm, self.frame.top)

    @property
    def strip(self) -> Box:
        return Box(self.frame.right - self.strip_mm, self.frame.bottom, self.frame.right, self.frame.top)


def _iso(name: str, width_mm: float, height_mm: float, strip_mm: float) -> Sheet:
    return Sheet(name, width_mm, height_mm, BINDING_MARGIN_MM, MARGIN_MM, strip_mm)


def _ansi(name: str, width_mm: float, height_mm: float, strip_mm: float) -> Sheet:
    return Sheet(name, width_mm, height_mm, ANSI_MARGIN_MM, ANSI_MARGIN_MM, strip_mm)


SHEETS = (
    _iso("A4", 297, 210, 76),
    _iso("A3", 420, 297, 92),
    _iso("A2", 594, 420, 110),
    _iso("A1", 841, 594, 130),
    _iso("A0", 1189, 841, 150),
    _ansi("ANSI A", 279.4, 215.9, 76),
    _ansi("ANSI B", 431.8, 279.4, 92),
    _ansi("ANSI C", 558.8, 431.8, 110),
    _ansi("ANSI D", 863.6, 558.8, 130),
    _ansi("ANSI E", 1117.6, 863.6, 150),
)


def sheet_named(name: str) -> Sheet:
    """The sheet of that name (`a3`, `ANSI-B` and `ansi b` are understood); raises ConfigError when there is none."""
    wanted = name.strip().upper().replace("-", " ").replace("_", " ")
    for sheet in SHEETS:
        if wanted in (sheet.name, sheet.name.replace(" ", "")):
            return sheet
    raise ConfigError(f"drawing.sheet = {name!r}: use one of {', '.join(sheet.name for sheet in SHEETS)}")
