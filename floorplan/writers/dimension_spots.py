"""The places a dimension can take: its line aside of where the plan put it, its text along, beyond or across the line."""

from collections.abc import Iterator
from dataclasses import dataclass

from floorplan.model.plan import Dimension, Point
from floorplan.writers.occupancy import Rectangle
from floorplan.writers.scale import Scale

TEXT_HEIGHT_MM = 1.8  # ISO 3098, the smallest size of lettering
TEXT_GAP_MM = 0.8  # between dimension line and text
TICK_MM = 1.2  # width of the oblique stroke
CLEARANCE_MM = 0.7  # kept free around text
STEP_MM = 4.0  # trials aside: one line of text and its gap
SIDE_STEPS = 16
ASIDE_COST = 0.6  # per step: the plan's own place is the best guess
SLID_COST = 0.2  # text off the middle of its line
ACROSS_COST = 4.0  # text at a right angle to a short dimension
BEYOND_COST = 6.0  # text past the end of its dimension line
TOO_WIDE_COST = 8.0  # text wider than its dimension, yet centred


@dataclass(frozen=True)
class Spot:
    """One place: coordinate of the line, ends of the line as drawn, centre, direction and box of the text, and what it costs by itself."""

    across: float
    reach: tuple[Point, Point]
    text_centre: Point
    text_rotation_deg: float
    text_box: Rectangle
    cost: float
    reaches_beyond: bool = False

    def line_box(self, scale: Scale) -> Rectangle:
        return Rectangle.around(self.reach, scale.model_m(CLEARANCE_MM / 2))


def span(dimension: Dimension) -> tuple[float, float]:
    """Lower and upper coordinate of the two faces."""
    low, high = sorted((dimension.start[dimension.axis], dimension.end[dimension.axis]))
    return low, high


def point_at(axis: int, along: float, across: float) -> Point:
    """The point with these coordinates along and across `axis`."""
    return (along, across) if axis == 0 else (across, along)


def spots(dimension: Dimension, width: float, scale: Scale) -> Iterator[tuple[Spot, ...]]:
    """Every place to try for a text of `width` (plan metres), line by line: the plan's own, then ever farther aside and ever dearer."""
    across = dimension.line[1 - dimension.axis]
    step = scale.model_m(STEP_MM)
    yield tuple(_along(dimension, across, width, scale, 0.0))
    for count in range(1, SIDE_STEPS + 1):
        for way in (1.0, -1.0):
            yield tuple(_along(dimension, across + way * count * step, width, scale, count * ASIDE_COST))


def _along(dimension: Dimension, across: float, width: float, scale: Scale, cost: float) -> Iterator[Spot]:
    """Text on the line's middle, slid to both sides, across it (short ones), beyond either end."""
    axis, (low, high) = dimension.axis, span(dimension)
    middle, room = (low + high) / 2, high - low - width
    offset = scale.model_m(TEXT_GAP_MM + TEXT_HEIGHT_MM / 2)
    sign = 1.0 if axis == 0 else -1.0
    yield _spot(axis, across, (low, high), (middle, across + sign * offset), width, scale, cost + (TOO_WIDE_COST if room < 0 else 0.0))
    if room > 0:
        for slide in (-0.25 * room, 0.25 * room, -0.45 * room, 0.45 * room):
            yield _spot(axis, across, (low, high), (middle + slide, across + sign * offset), width, scale, cost + SLID_COST)
        return
    side = scale.model_m(TEXT_GAP_MM) + width / 2
    for turned in (side, -side):
        yield _spot(axis, across, (low, high), (middle, across + turned), width, scale, cost + ACROSS_COST, across_the_line=True)
    beyond = width / 2 + scale.model_m(TICK_MM + CLEARANCE_MM)
    for centre, reach in ((high + beyond, (low, high + beyond + width / 2)), (low - beyond, (low - beyond - width / 2, high))):
        words = (centre, across + sign * offset)
        yield _spot(axis, across, reach, words, width, scale, cost + BEYOND_COST, reaches_beyond=True)


def _spot(
    axis: int,
    across: float,
    reach: Point,
    text: Point,
    width: float,
    scale: Scale,
    cost: float,
    across_the_line: bool = False,
    reaches_beyond: bool = False,
) -> Spot:
    """`reach` and `text` in coordinates (along, across)."""
    rotation = 0.0 if (axis == 0) != across_the_line else 90.0
    centre = point_at(axis, *text)
    return Spot(
        across=across,
        reach=(point_at(axis, reach[0], across), point_at(axis, reach[1], across)),
        text_centre=centre,
        text_rotation_deg=rotation,
        text_box=text_box(centre, width, scale, rotation),
        cost=cost,
        reaches_beyond=reaches_beyond,
    )


def text_box(centre: Point, width: float, scale: Scale, rotation_deg: float) -> Rectangle:
    """The box of words of `width`, with the space kept free around them."""
    clear = scale.model_m(CLEARANCE_MM)
    wide, high = width + 2 * clear, scale.model_m(TEXT_HEIGHT_MM) + 2 * clear
    return Rectangle.centred(centre, *((wide, high) if rotation_deg == 0.0 else (high, wide)))
