"""Drawing units and how distances, areas and scales are worded: metres, millimetres, feet and inches."""

from dataclasses import dataclass
from fractions import Fraction

from floorplan.errors import ConfigError
from floorplan.model.normal import NORMAL_95

MILLIMETRE_M = 0.001  # finest step of metric texts
METRES_PER_FOOT = 0.3048
INCHES_PER_FOOT = 12
INCH_STEP = Fraction(1, 8)  # finest fraction shown: 3.2 mm, about what a scan is good for
SQUARE_METRES_PER_SQUARE_FOOT = METRES_PER_FOOT**2


@dataclass(frozen=True)
class UnitStyle:
    """`per_metre` drawing units in one metre; `insunits` the DXF code; `metric` chooses the wording and the scale series."""

    name: str
    per_metre: float
    insunits: int
    metric: bool


UNIT_STYLES = (UnitStyle("m", 1.0, 6, True), UnitStyle("mm", 1000.0, 4, True), UnitStyle("ft", 1 / METRES_PER_FOOT, 2, False))


def unit_style(name: str) -> UnitStyle:
    """The style of that name; raises ConfigError when there is none."""
    for style in UNIT_STYLES:
        if style.name == name:
            return style
    raise ConfigError(f"drawing.units = {name!r}: use one of {', '.join(style.name for style in UNIT_STYLES)}")


def feet_and_inches(length_m: float) -> str:
    """`17'-9 7/8"`, to the nearest eighth of an inch."""
    eighths = round(length_m / METRES_PER_FOOT * INCHES_PER_FOOT / INCH_STEP)
    sign, eighths = ("-", -eighths) if eighths < 0 else ("", eighths)
    feet, rest = divmod(Fraction(eighths) * INCH_STEP, INCHES_PER_FOOT)
    return f"{sign}{feet}'-{'0 ' if 0 < rest < 1 else ''}{_inches(rest)}"


def _inches(inches: Fraction) -> str:
    whole, part = divmod(inches, 1)
    fraction = f"{part.numerator}/{part.denominator}" if part else ""
    if whole and fraction:
        return f'{whole} {fraction}"'
    return f'{fraction or whole}"'


def length_text(length_m: float, units: UnitStyle) -> str:
    """A length alone: `5.432 m`, `5432 mm` or `17'-9 7/8"`."""
    if not units.metric:
        return feet_and_inches(length_m)
    millimetres = round(length_m * 1000)  # a whole number: never "-0"
    return f"{millimetres / 1000:.3f} m" if units.name == "m" else f"{millimetres} mm"


def plus_minus_text(sigma_m: float, units: UnitStyle) -> str:
    """The 95 % half width: `±0.012`, `±12` or `±1/2"`, never below the step shown: no distance is known exactly."""
    half = NORMAL_95 * sigma_m
    if units.metric:
        half = max(half, MILLIMETRE_M)
        return f"±{half:.3f}" if units.name == "m" else f"±{half * 1000:.0f}"
    steps = max(1, -int(-(half / METRES_PER_FOOT * INCHES_PER_FOOT) // float(INCH_STEP)))
    return f"±{_inches(steps * INCH_STEP)}"


def distance_text(distance_m: float, sigma_m: float, units: UnitStyle) -> str:
    """`5.432 m ±0.012` (95 %)."""
    return f"{length_text(distance_m, units)} {plus_minus_text(sigma_m, units)}"


def area_text(area_m2: float, sigma_m2: float | None, units: UnitStyle) -> str:
    """`23.45 m² ±0.12` or `252.4 sq ft ±1.3` (95 %); without a sigma the area is that of what was seen: `23.45 m² seen`."""
    known = "seen" if sigma_m2 is None else f"±{area_interval(sigma_m2, units)}"
    return f"{area_number(area_m2, units)} {'m²' if units.metric else 'sq ft'} {known}"


def area_number(area_m2: float, units: UnitStyle) -> str:
    """The area alone, without its unit."""
    return f"{area_m2:.2f}" if units.metric else f"{area_m2 / SQUARE_METRES_PER_SQUARE_FOOT:.1f}"


def area_interval(sigma_m2: float, units: UnitStyle) -> str:
    """Its 95 % half width, never below the step shown."""
    half = NORMAL_95 * sigma_m2
    return f"{max(half, 0.01):.2f}" if units.metric else f"{max(half / SQUARE_METRES_PER_SQUARE_FOOT, 0.1):.1f}"


def ceiling_text(height_m: float | None, sigma_m: float | None, units: UnitStyle) -> str:
    """`h 2.640 m ±0.008`, without the +- when it is not known, or empty when no ceiling was seen."""
    if height_m is None:
        return ""
    return f"h {distance_text(height_m, sigma_m, units) if sigma_m is not None else length_text(height_m, units)}"
