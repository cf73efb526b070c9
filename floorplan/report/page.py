"""The page from `templates/report.html.j2`: everything inside one file, nothing fetched."""

import json
import platform
from dataclasses import asdict, replace
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path

from floorplan import __version__
from floorplan.config import Config
from floorplan.config_file import config_to_toml
from floorplan.laser.compare import Check
from floorplan.report.birds_eye import four_views
from floorplan.report.details import details
from floorplan.report.drawing import plan_drawing
from floorplan.report.side_by_side import side_by_side
from floorplan.report.tables import Count, accuracy_rows, coverage, plane_rows, told_merges, verdict_counts
from floorplan.results import Results
from floorplan.summary import Summary
from floorplan.templates_dir import templates_dir
from floorplan.work.folder import Owner

TEMPLATE = "report.html.j2"
LIBRARIES = ("numpy", "scipy", "numba", "shapely", "cvxpy", "clarabel", "opencv-python-headless")


def report_html(results: Results, table: Summary, owner: Owner, config: Config, check: Check | None = None) -> str:
    """The whole page as text. Raises InputError when the installation lacks its templates."""
    from jinja2 import Environment, FileSystemLoader, StrictUndefined
    from markupsafe import Markup

    results = replace(results, plan=side_by_side(results.plan))
    environment = Environment(loader=FileSystemLoader(templates_dir()), autoescape=True, undefined=StrictUndefined, trim_blocks=True)
    told = json.dumps(details(results), ensure_ascii=False).replace("</", "<\\/")
    return environment.get_template(TEMPLATE).render(
        title=config.project.name or Path(owner.scan).name,
        software=f"floorplan {__version__}",
        plan=results.plan,
        summary=table,
        drawing=plan_drawing(results.plan),
        views=four_views(results),
        accuracy=accuracy_rows(results.plan),
        planes=plane_rows(results),
        verdicts=verdict_counts(results),
        merges=told_merges(results),
        coverage=coverage(results),
        check=check,
        calibration=results.solution.calibration,
        problems=results.problems,
        config=config_to_toml(config),
        versions=_versions(),
        owner=owner,
        laser_sha256=config.corrections.laser_sha256,
        details=Markup(told),  # JSON of our own making, its only way out of the element escaped
        seconds=tuple(table.seconds.items()),
        initial=table.initial_planes,
        counts=tuple(Count(name, value) for name, value in _counted(table)),
    )


def _counted(table: Summary) -> list[tuple[str, int]]:
    """The whole numbers of the summary."""
    return [(name.replace("_", " "), value) for name, value in asdict(table).items() if type(value) is int]


def _versions() -> tuple[tuple[str, str], ...]:
    found = [("Python", platform.python_version()), ("floorplan", __version__)]
    for name in LIBRARIES:
        try:
            found.append((name, version(name)))
        except PackageNotFoundError:
            found.append((name, "not installed"))
    return tuple(found)
