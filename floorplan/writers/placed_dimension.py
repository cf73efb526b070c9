"""A dimension in its place on the drawing."""

from dataclasses import dataclass

from floorplan.model.plan import Dimension, Point
from floorplan.writers.occupancy import Rectangle
from floorplan.writers.unit_style import UnitStyle, distance_text


@dataclass(frozen=True)
class PlacedDimension:
    """A dimension as drawn, plan frame, metres: ends of the dimension line, centre of the text.

    `line_reach` are the ends of the line as drawn: it runs on under text that stands beyond the measured stretch.
    `extended`: whether start and end need an extension line; an end that touches a wall needs none. `leader` joins
    the line to words that stand elsewhere.
    """

    dimension: Dimension
    text: str
    line: tuple[Point, Point]
    line_reach: tuple[Point, Point]
    text_centre: Point
    text_rotation_deg: float
    extended: tuple[bool, bool]
    text_box: Rectangle
    line_box: Rectangle
    leader: tuple[Point, Point] | None = None


def dimension_label(dimension: Dimension, units: UnitStyle) -> str:
    """`D1  5.432 m ±0.012`."""
    return f"{dimension.id}  {distance_text(dimension.distance_m, dimension.sigma_m, units)}"
