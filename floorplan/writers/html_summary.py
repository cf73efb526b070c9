"""A short HTML page of one build: the sheet inline, rooms, dimensions, what was rejected, notes and problems; needs no network."""

from dataclasses import dataclass

from floorplan.config import ProjectConfig
from floorplan.templates_dir import templates_dir
from floorplan.writers.composition import Composition
from floorplan.writers.facts import FactRow, SheetFacts
from floorplan.writers.plan_scene import sheet_scene
from floorplan.writers.sheet_words import area_unit, notes, schedule
from floorplan.writers.svg import svg_text
from floorplan.writers.title_block import accuracy_text
from floorplan.writers.unit_style import UnitStyle, distance_text, length_text

TEMPLATE = "report.html"


@dataclass(frozen=True)
class DimensionRow:
    """One dimension, worded."""

    id: str
    text: str
    between: str
    room: str


def html_bytes(composition: Composition, project: ProjectConfig, facts: SheetFacts) -> bytes:
    """The page from `templates/report.html`; raises InputError when the installation lacks its templates."""
    from jinja2 import Environment, FileSystemLoader, StrictUndefined
    from markupsafe import Markup

    title = project.name or facts.scan or "Floor plan"
    environment = Environment(loader=FileSystemLoader(templates_dir()), autoescape=True, undefined=StrictUndefined)
    svg = svg_text(sheet_scene(composition, project, facts), composition.layers, title)
    page = environment.get_template(TEMPLATE).render(
        title=title,
        lead=_lead(composition, facts),
        svg=Markup(svg.partition("\n")[2]),  # our own drawing, escaped where it was made; no XML declaration
        facts=fact_rows(composition, facts),
        rooms=schedule(composition.plan, composition.units),
        area_unit=area_unit(composition.units),
        dimensions=dimension_rows(composition),
        rejections=composition.plan.rejections,
        notes=notes(composition, facts),
        problems=facts.problems,
    )
    return page.encode("utf-8")


def _lead(composition: Composition, facts: SheetFacts) -> str:
    parts = (facts.scan and f"Scan {facts.scan}", facts.date, f"scale {composition.scale.label}", facts.software)
    return " · ".join(part for part in parts if part)


def fact_rows(composition: Composition, facts: SheetFacts) -> tuple[FactRow, ...]:
    """The numbers of the scan that are known, then the caller's own rows."""
    units: UnitStyle = composition.units
    rows = [FactRow("Accuracy of distances, 95 %", accuracy_text(composition.plan))]
    if facts.path_m is not None:
        rows.append(FactRow("Walked", length_text(facts.path_m, units)))
    if facts.drift_m is not None:
        rows.append(FactRow("Start to end after adjustment", length_text(facts.drift_m, units)))
    return (*rows, *facts.rows)


def dimension_rows(composition: Composition) -> tuple[DimensionRow, ...]:
    """Every dimension of the plan, heights too."""
    return tuple(
        DimensionRow(
            dimension.id,
            distance_text(dimension.distance_m, dimension.sigma_m, composition.units),
            f"{dimension.from_plane} to {dimension.to_plane}",
            dimension.room or dimension.role.value,
        )
        for dimension in composition.plan.dimensions
    )
