"""Drawings of a plan, one file per format behind one table."""

import os
import tempfile
from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cached_property
from importlib import import_module
from pathlib import Path

from floorplan.config import DrawingConfig, ProjectConfig
from floorplan.errors import UsageError
from floorplan.model.plan import Plan
from floorplan.writers.composition import Composition, compose
from floorplan.writers.facts import FactRow, SheetFacts
from floorplan.writers.plan_scene import sheet_scene
from floorplan.writers.scene import Scene

__all__ = ["WRITERS", "FactRow", "Job", "SheetFacts", "Writer", "files_of", "write", "write_job"]


@dataclass(frozen=True)
class Job:
    """What a format's writer is given. What several formats share is made once."""

    plan: Plan
    drawing: DrawingConfig
    project: ProjectConfig
    facts: SheetFacts

    @cached_property
    def composition(self) -> Composition:
        return compose(self.plan, self.drawing)

    @cached_property
    def scene(self) -> Scene:
        """The sheet as the picture formats draw it."""
        return sheet_scene(self.composition, self.project, self.facts)

    @property
    def title(self) -> str:
        return self.project.name or self.facts.scan or "Floor plan"

    @cached_property
    def storeys(self) -> tuple["Job", ...]:
        """One job per storey of the plan, from below upwards."""
        return tuple(replace(self, plan=storey) for storey in self.plan.storeys) if self.plan.upper_storeys else (self,)


def _dxf(job: Job) -> bytes:
    from floorplan.writers.dxf import dxf_bytes

    return dxf_bytes(job.composition, job.drawing.dxf_version, job.project, job.facts, job.drawing.template)


def _svg(job: Job) -> bytes:
    from floorplan.writers.svg import write_svg

    return write_svg(job.scene, job.composition.layers, job.title)


def _pdf(job: Job) -> bytes:
    from floorplan.writers.figure import pdf_bytes

    return pdf_bytes(job.scene, job.composition.layers, job.title)


def _png(job: Job) -> bytes:
    from floorplan.writers.figure import png_bytes

    return png_bytes(job.scene, job.composition.layers)


@dataclass(frozen=True)
class Writer:
    """One row of the table: `make` gives the bytes of the file; `per_storey`: one for each storey; `library` is slow to import."""

    name: str
    description: str
    make: Callable[[Job], bytes]
    per_storey: bool = False
    library: str = ""

    @property
    def option(self) -> str:
        """How it is asked for on the command line."""
        return "--csv DIR" if self.name in ("dimensions", "rooms") else f"--{self.name} FILE"


def _json(job: Job) -> bytes:
    from floorplan.plan.plan_json import plan_to_json

    return plan_to_json(job.plan).encode("utf-8")


def _geojson(job: Job) -> bytes:
    from floorplan.writers.geojson import geojson_bytes

    return geojson_bytes(job.plan)


def _dimensions(job: Job) -> bytes:
    from floorplan.writers.csv_tables import dimensions_csv

    return dimensions_csv(job.plan)


def _rooms(job: Job) -> bytes:
    from floorplan.writers.csv_tables import rooms_csv

    return rooms_csv(job.plan)


def _ifc(job: Job) -> bytes:
    from floorplan.writers.ifc import ifc_bytes

    return ifc_bytes(job.plan, job.project, job.facts)


def _report(job: Job) -> bytes:
    from floorplan.writers.html_summary import html_bytes

    return html_bytes(tuple(storey.composition for storey in job.storeys), job.project, job.facts)


_TABLE = (
    Writer("dxf", "CAD drawing: plan in model space, sheet in paper space (R2000 to R2018)", _dxf, per_storey=True, library="ezdxf"),
    Writer("svg", "the sheet in true millimetres, one group per layer", _svg, per_storey=True),
    Writer("pdf", "the sheet, vector, at true scale", _pdf, per_storey=True, library="matplotlib.backends.backend_pdf"),
    Writer("png", "the sheet as a picture", _png, per_storey=True, library="matplotlib.backends.backend_agg"),
    Writer("json", "the plan as data, with its schema version", _json),
    Writer("geojson", "the plan as features in plan metres, for GIS", _geojson),
    Writer("dimensions", "dimensions.csv, with an empty column to fill on site", _dimensions),
    Writer("rooms", "rooms.csv, the room schedule", _rooms),
    Writer("ifc", "IFC4 building model: storeys, walls, spaces, doors, with their accuracy (needs the extra 'ifc')", _ifc),
    Writer("report", "a short HTML page that needs no network", _report),
)
WRITERS = {writer.name: writer for writer in _TABLE}


def write(name: str, plan: Plan, path: Path, drawing: DrawingConfig, project: ProjectConfig, facts: SheetFacts) -> tuple[Path, ...]:
    """Write `plan` in the format called `name` (a key of `WRITERS`): each file appears whole or not at all; gives the files.

    Raises UsageError for an unknown format, ConfigError for drawing settings that do not exist or do not fit.
    """
    return write_job(name, Job(plan, drawing, project, facts), path)


def write_job(name: str, job: Job, path: Path) -> tuple[Path, ...]:
    """The same for a job that several formats are written of."""
    writer, paths = _writer_named(name), files_of(name, job.plan, path)
    for one, part in zip(paths, job.storeys if writer.per_storey else (job,), strict=True):
        write_atomically(one, writer.make(part))
    return paths


def files_of(name: str, plan: Plan, path: Path) -> tuple[Path, ...]:
    """The files that `path` stands for: with several storeys, drawings are one file each, `plan-1.dxf`, `plan-2.dxf` for `plan.dxf`."""
    if not (_writer_named(name).per_storey and plan.upper_storeys):
        return (path,)
    return tuple(path.with_stem(f"{path.stem}-{number}") for number in range(1, len(plan.storeys) + 1))


def load_library(name: str) -> None:
    """Import what the format called `name` is drawn with, ahead of the drawing."""
    if library := _writer_named(name).library:
        import_module(library)


def _writer_named(name: str) -> Writer:
    if name not in WRITERS:
        raise UsageError(f"format {name!r}: this program writes {', '.join(WRITERS)}")
    return WRITERS[name]


def write_atomically(path: Path, content: bytes) -> None:
    """Written beside, then renamed: a reader never sees half a file. Raises UsageError when the folder cannot be written."""
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        descriptor, beside = tempfile.mkstemp(prefix=f".{path.name}.", dir=path.parent)
    except OSError as error:
        raise UsageError(f"{path}: cannot be written ({error.strerror}); choose another folder") from error
    try:
        with os.fdopen(descriptor, "wb") as stream:
            stream.write(content)
        os.chmod(beside, 0o644)
        os.replace(beside, path)
    except OSError as error:
        Path(beside).unlink(missing_ok=True)
        raise UsageError(f"{path}: cannot be written ({error.strerror}); free some space or choose another folder") from error
