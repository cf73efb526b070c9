"""The title block as a description: cells, captions and fields; pictures draw it, the DXF makes a block with attributes of it."""

from dataclasses import dataclass

from floorplan.config import ProjectConfig
from floorplan.model.plan import Plan
from floorplan.writers.composition import Composition
from floorplan.writers.facts import SheetFacts
from floorplan.writers.sheet_size import Box
from floorplan.writers.unit_style import UnitStyle, plus_minus_text, unit_style

ROW_MM = 8.5
CAPTION_MM = 1.2  # capital height of the small captions
PAD_MM = 1.2
MILLIMETRES = unit_style("mm")  # what an accuracy is said in
TITLE_BLOCK = "TITLE_BLOCK"  # name of the block, ours and a template's


@dataclass(frozen=True)
class Field:
    """One cell: attribute tag, its caption, share of the row's width, height of capitals of its value."""

    tag: str
    caption: str
    share: float
    height_mm: float


@dataclass(frozen=True)
class Cell:
    """A field in its place on the sheet."""

    field: Field
    box: Box


ROWS: tuple[tuple[Field, ...], ...] = (
    (Field("PROJECT", "Project", 1.0, 3.0),),
    (Field("ADDRESS", "Address", 1.0, 2.0),),
    (Field("CLIENT", "Client", 0.5, 2.0), Field("FLOOR", "Floor", 0.5, 2.0)),
    (Field("SURVEYOR", "Surveyor", 0.5, 2.0), Field("DATE", "Date of scan", 0.5, 2.0)),
    (Field("SCAN", "Scan", 1.0, 1.8),),
    (Field("ACCURACY", "Accuracy of distances, 95 %", 1.0, 1.8),),
    (Field("SCALE", "Scale", 0.34, 3.0), Field("SHEET", "Sheet", 0.33, 2.0), Field("UNITS", "Units", 0.33, 2.0)),
    (Field("SOFTWARE", "Made with", 1.0, 1.4),),
)
TAGS = tuple(field.tag for row in ROWS for field in row)


def block_height_mm() -> float:
    return ROW_MM * len(ROWS)


def cells(strip: Box) -> tuple[Cell, ...]:
    """The cells at the foot of the strip, first row on top."""
    placed = []
    top = strip.bottom + block_height_mm()
    for index, row in enumerate(ROWS):
        left = strip.left
        for field in row:
            right = left + field.share * strip.width
            placed.append(Cell(field, Box(left, top - (index + 1) * ROW_MM, right, top - index * ROW_MM)))
            left = right
    return tuple(placed)


def values(composition: Composition, project: ProjectConfig, facts: SheetFacts) -> dict[str, str]:
    """The value of every field, by tag."""
    return {
        "PROJECT": project.name or "Floor plan",
        "ADDRESS": project.address,
        "CLIENT": project.client,
        "FLOOR": floor_text(project, composition.plan),
        "SURVEYOR": project.surveyor,
        "DATE": facts.date,
        "SCAN": facts.scan,
        "ACCURACY": accuracy_text(composition.plan, composition.units),
        "SCALE": composition.scale.label,
        "SHEET": composition.sheet.name,
        "UNITS": {"m": "metres", "mm": "millimetres", "ft": "feet and inches"}[composition.units.name],
        "SOFTWARE": facts.software,
    }


def floor_text(project: ProjectConfig, plan: Plan) -> str:
    """The floor as the project calls it; an upper storey says its height above the lowest too."""
    if not plan.elevation_m:
        return project.floor or plan.level
    return " - ".join(word for word in (project.floor, f"{plan.level} ({plan.elevation_m:+.2f} m)") if word)


def accuracy_text(plan: Plan, units: UnitStyle = MILLIMETRES) -> str:
    """Median and worst 95 % half width of the dimensions: in millimetres, or in the sheet's inches."""
    sigmas = sorted(dimension.sigma_m for dimension in plan.dimensions)
    if not sigmas:
        return "no dimensions"
    median, worst = (plus_minus_text(sigma, MILLIMETRES if units.metric else units) for sigma in (sigmas[len(sigmas) // 2], sigmas[-1]))
    unit = " mm" if units.metric else ""
    return f"{median}{unit} median, {worst}{unit} worst of {len(sigmas)}"
