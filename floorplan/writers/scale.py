"""The drawing scale: one of the customary series, chosen to fit the sheet, or the one asked for."""

import re
from collections.abc import Callable
from dataclasses import dataclass

from floorplan.errors import ConfigError
from floorplan.writers.occupancy import Rectangle
from floorplan.writers.sheet_size import Box

METRIC_SERIES = (20, 50, 100, 200, 250, 500, 1000, 2000, 5000)  # ISO 5455, with the customary 1:250
IMPERIAL_SERIES = (24, 48, 96, 192, 384, 768, 1536, 6000)  # 1/2", 1/4", 1/8", 1/16" ... to the foot
SMALLEST = 1e6  # a country on a sheet
FIT_MARGIN_MM = 4.0  # left free around the plan and its dimension chains


@dataclass(frozen=True)
class Scale:
    """1 : `denominator`."""

    denominator: float

    @property
    def label(self) -> str:
        return f"1:{self.denominator:g}"

    def paper_mm(self, length_m: float) -> float:
        return length_m * 1000 / self.denominator

    def model_m(self, length_mm: float) -> float:
        return length_mm * self.denominator / 1000


def fits(scale: Scale, box: Rectangle, area: Box) -> bool:
    """Whether a drawing of that size, with its margin, fits the drawing area."""
    room = 2 * FIT_MARGIN_MM
    return scale.paper_mm(box.x1 - box.x0) + room <= area.width and scale.paper_mm(box.y1 - box.y0) + room <= area.height


def choose_scale(asked: str, drawn: Callable[[Scale], Rectangle], area: Box, metric: bool) -> Scale:
    """The largest scale of the series that fits, or the one asked for (`1:50`); `drawn` is what a scale must hold, chains and all.

    Raises ConfigError for a scale that cannot be read or at which the plan does not fit the sheet.
    """
    series = METRIC_SERIES if metric else IMPERIAL_SERIES
    if asked and fits(asked_scale := parse_scale(asked), drawn(asked_scale), area):
        return asked_scale
    fitting = next((Scale(d) for d in series if fits(Scale(d), drawn(Scale(d)), area)), None)
    if not asked:
        return fitting or Scale(_beyond_series(drawn, area))
    box = drawn(asked_scale)
    width_m, height_m = box.x1 - box.x0, box.y1 - box.y0
    remedy = f"use {fitting.label}, or a larger --sheet" if fitting else "use a larger --sheet"
    size = f"{width_m:.1f} x {height_m:.1f} m with its dimensions"
    raise ConfigError(f"drawing.scale = {asked!r}: the plan of {size} does not fit the sheet at this scale; {remedy}")


def parse_scale(text: str) -> Scale:
    """`1:50` or `50`; raises ConfigError otherwise."""
    match = re.fullmatch(r"\s*(?:1\s*:\s*)?(\d+(?:\.\d+)?)\s*", text)
    if match is None or float(match[1]) <= 0:
        raise ConfigError(f"drawing.scale = {text!r}: write it as 1:50")
    return Scale(float(match[1]))


def _beyond_series(drawn: Callable[[Scale], Rectangle], area: Box) -> float:
    """The next round denominator that fits; the smallest drawing of all where even the words of its dimensions are too many."""
    denominator = float(METRIC_SERIES[-1])
    while denominator < SMALLEST and not fits(Scale(denominator), drawn(Scale(denominator)), area):
        denominator *= 2
    return denominator
