"""A short HTML page of one build: the sheet inline, rooms, dimensions, what was rejected, notes and problems; needs no network."""

from dataclasses import dataclass

from floorplan.config import ProjectConfig
from floorplan.model.plan import Plan
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


def html_bytes(compositions: tuple[Composition, ...], project: ProjectConfig, facts: SheetFacts) -> bytes:
    """The page, one sheet per storey, from `templates/report.html`; raises InputError when the installation lacks its templates."""
    from jinja2 import Environment, FileSystemLoader, StrictUndefined
    from markupsafe import Markup

    title = project.name or facts.scan or "Floor plan"
    environment = Environment(loader=FileSystemLoader(templates_dir()), autoescape=True, undefined=StrictUndefined)
    first = compositions[0]
    sheets = [svg_text(sheet_scene(one, project, facts), one.layers, title) for one in compositions]
    page = environment.get_template(TEMPLATE).render(
        title=title,
        lead=_lead(first, facts),
        sheets=[Markup(svg.partition("\n")[2]) for svg in sheets],  # our own drawings, escaped where they were made; no XML declaration
        facts=fact_rows(compositions, facts),
        rooms=[row for one in compositions for row in schedule(one.plan, one.units)],
        area_unit=area_unit(first.units),
        dimensions=[row for one in compositions for row in dimension_rows(one)],
        rejections=[rejection for one in compositions for rejection in one.plan.rejections],
        notes=list(dict.fromkeys(note for one in compositions for note in notes(one, facts))),
        problems=facts.problems,
    )
    return page.encode("utf-8")


def _lead(composition: Composition, facts: SheetFacts) -> str:
    parts = (facts.scan and f"Scan {facts.scan}", facts.date, f"scale {composition.scale.label}", facts.software)
    return " · ".join(part for part in parts if part)


def fact_rows(compositions: tuple[Composition, ...], facts: SheetFacts) -> tuple[FactRow, ...]:
    """The numbers of the scan that are known, then the caller's own rows."""
    units: UnitStyle = compositions[0].units
    rows = [FactRow(f"Accuracy of distances, 95 %{level(one.plan)}", accuracy_text(one.plan)) for one in compositions]
    if facts.path_m is not None:
        rows.append(FactRow("Walked", length_text(facts.path_m, units)))
    if facts.drift_m is not None:
        rows.append(FactRow("Start to end after adjustment", length_text(facts.drift_m, units)))
    return (*rows, *facts.rows)


def level(plan: Plan) -> str:
    """`, Storey 2`; empty where there is but one."""
    return f", {plan.level}" if plan.level else ""


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
