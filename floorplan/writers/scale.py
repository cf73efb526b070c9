"""The drawing scale: one of the customary series, chosen to fit the sheet, or the one asked for."""

import math
import re
from dataclasses import dataclass

from floorplan.errors import ConfigError
from floorplan.writers.sheet_size import Box

METRIC_SERIES = (20, 50, 100, 200, 250, 500, 1000, 2000, 5000)  # ISO 5455, with the customary 1:250
IMPERIAL_SERIES = (24, 48, 96, 192, 384, 768, 1536, 6000)  # 1/2", 1/4", 1/8", 1/16" ... to the foot
FIT_MARGIN_MM = 16.0  # left free around the plan for dimension chains and their text


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


def fits(scale: Scale, width_m: float, height_m: float, area: Box) -> bool:
    """Whether a plan of that size, with its margin, fits the drawing area."""
    room = 2 * FIT_MARGIN_MM
    return scale.paper_mm(width_m) + room <= area.width and scale.paper_mm(height_m) + room <= area.height


def choose_scale(asked: str, width_m: float, height_m: float, area: Box, metric: bool) -> Scale:
    """The largest scale of the series that fits, or the one asked for (`1:50`).

    Raises ConfigError for a scale that cannot be read or at which the plan does not fit the sheet.
    """
    series = METRIC_SERIES if metric else IMPERIAL_SERIES
    fitting = next((Scale(d) for d in series if fits(Scale(d), width_m, height_m, area)), None)
    if not asked:
        return fitting or Scale(_beyond_series(width_m, height_m, area))
    scale = parse_scale(asked)
    if not fits(scale, width_m, height_m, area):
        remedy = f"use {fitting.label}, or a larger --sheet" if fitting else "use a larger --sheet"
        size = f"{width_m:.1f} x {height_m:.1f} m"
        raise ConfigError(f"drawing.scale = {asked!r}: the plan of {size} does not fit the sheet at this scale; {remedy}")
    return scale


def parse_scale(text: str) -> Scale:
    """`1:50` or `50`; raises ConfigError otherwise."""
    match = re.fullmatch(r"\s*(?:1\s*:\s*)?(\d+(?:\.\d+)?)\s*", text)
    if match is None or float(match[1]) <= 0:
        raise ConfigError(f"drawing.scale = {text!r}: write it as 1:50")
    return Scale(float(match[1]))


def _beyond_series(width_m: float, height_m: float, area: Box) -> float:
    room = 2 * FIT_MARGIN_MM
    least = 1000 * max(width_m / (area.width - room), height_m / (area.height - room))
    magnitude = 10.0 ** math.floor(math.log10(least))
    return float(math.ceil(least / magnitude) * magnitude)
