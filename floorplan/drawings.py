"""The drawings a build was asked for: which writer, which file, and what the sheet says about the scan."""

from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass, replace
from datetime import UTC, datetime
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from floorplan import __version__
from floorplan.config import Config, DrawingConfig, ProjectConfig
from floorplan.drawing_process import DrawingProcess
from floorplan.errors import ConfigError, UsageError
from floorplan.model.checks import Array
from floorplan.model.normal import NORMAL_95
from floorplan.model.plan import Plan
from floorplan.model.scan import NANOSECONDS_PER_SECOND, IngestedScan
from floorplan.model.ties import Calibration
from floorplan.reporting import Reporter
from floorplan.results import Results
from floorplan.summary import Summary
from floorplan.work.disk import clear_disk_errors

if TYPE_CHECKING:
    from floorplan.writers import Job
    from floorplan.writers.facts import SheetFacts

ON_SHEETS = ("dxf", "svg", "pdf", "png", "report")  # writers that lay the plan on a sheet at a scale
ALONE = DrawingProcess()  # one that draws nothing
TURNED_DEG = 2.0  # steps of the angle that the plan may lie at under the path
PATH_SHARE = 0.9  # of the path's size that is sure: odometry may have stretched it
TABLES = ("dimensions", "rooms")  # writers of comma-separated tables
FORMATS_OF_SUFFIX: dict[str, tuple[str, ...]] = {  # endings that promise a content; any other says nothing
    **{f".{name}": (name,) for name in ("dxf", "svg", "pdf", "png", "geojson", "ifc")},
    **{f".{name}": () for name in ("jpg", "jpeg", "tif", "tiff", "bmp", "webp", "gif", "dwg", "dwf", "eps", "ifcxml", "ifczip")},
    ".json": ("json", "geojson"),
    ".csv": TABLES,
    ".html": ("report",),
    ".htm": ("report",),
}
EARLIEST_CLOCK_S = 946_684_800  # 2000-01-01: smaller stamps count from some other beginning than 1970


@dataclass(frozen=True)
class Drawing:
    """One file to draw: `format` names the writer."""

    format: str
    path: Path


def tables_in(folder: Path) -> tuple[Drawing, ...]:
    """The tables to write in `folder`, each under its own name."""
    if folder.is_file():
        raise UsageError(f"{folder} is a file; the tables need a folder")
    with clear_disk_errors(folder):
        if folder.parent.is_dir():
            folder.mkdir(exist_ok=True)
    return tuple(Drawing(name, folder / f"{name}.csv") for name in TABLES)


def check_drawings(drawings: tuple[Drawing, ...]) -> None:
    """Raise `UsageError` before any work is done when a drawing could not be written at the end."""
    if any(drawing.format == "ifc" for drawing in drawings):
        from floorplan.writers.ifc_model import need_ifcopenshell

        need_ifcopenshell()
    for drawing in drawings:
        if not drawing.path.parent.is_dir():
            raise UsageError(f"{drawing.path}: there is no folder {drawing.path.parent}; make it first")
        if drawing.path.is_dir():
            raise UsageError(f"{drawing.path} is a folder; give the name of a file")
        suffix = drawing.path.suffix.lower()
        if suffix in FORMATS_OF_SUFFIX and drawing.format not in FORMATS_OF_SUFFIX[suffix]:
            raise UsageError(f"{drawing.path}: this would hold {drawing.format.upper()}, not {suffix}; give the name another ending")


def check_sheet(drawings: tuple[Drawing, ...], drawing: DrawingConfig, path_xy_m: Array) -> None:
    """Raise `ConfigError`, before anything is computed, for a sheet that does not exist or that the walked path alone does not fit.

    `path_xy_m (N, 2)` may still be turned by any angle and bent by drift, so it must be too large under every angle, by a tenth.
    """
    if not any(one.format in ON_SHEETS for one in drawings):
        return
    from floorplan.writers.layers import layer_styles
    from floorplan.writers.occupancy import Rectangle
    from floorplan.writers.scale import IMPERIAL_SERIES, METRIC_SERIES, Scale, fits, parse_scale
    from floorplan.writers.sheet_size import sheet_named
    from floorplan.writers.unit_style import unit_style

    layer_styles(drawing.layers)
    units = unit_style(drawing.units)
    area = sheet_named(drawing.sheet).drawing
    if not drawing.scale:
        return
    scale, angles = parse_scale(drawing.scale), np.radians(np.arange(0.0, 180.0, TURNED_DEG))
    along = PATH_SHARE * np.ptp(path_xy_m @ np.stack((np.cos(angles), np.sin(angles))), axis=0)
    square = np.roll(along, len(angles) // 2)  # to each angle
    sizes = [Rectangle(0.0, 0.0, float(width), float(height)) for width, height in zip(along, square, strict=True)]
    if not any(fits(scale, size, area) for size in sizes):
        series = METRIC_SERIES if units.metric else IMPERIAL_SERIES
        fitting = next((Scale(one) for one in series if any(fits(Scale(one), size, area) for size in sizes)), None)
        path = f"the walked path alone, {max(along) / PATH_SHARE:.0f} m across, does not fit the sheet"
        remedy = f"use {fitting.label} or smaller, or a larger --sheet" if fitting else "leave --scale out, or use a larger --sheet"
        raise ConfigError(f"drawing.scale = {drawing.scale!r}: {path}; {remedy}")


@contextmanager
def drawing_beside(drawings: tuple[Drawing, ...], jobs: int) -> Iterator[DrawingProcess]:
    """A second process for `drawings`, not yet begun; it has ended afterwards, whatever happens."""
    second = DrawingProcess(tuple(drawing.format for drawing in drawings), jobs)
    try:
        yield second
    finally:
        second.end()


def write_drawings(
    results: Results,
    table: Summary,
    scan: Path,
    drawings: tuple[Drawing, ...],
    config: Config,
    reporter: Reporter,
    second: DrawingProcess = ALONE,
) -> tuple[Path, ...]:
    """Write every drawing; each file is whole or not there. Gives the files. What a `second` process can draw, it draws meanwhile."""
    if not drawings:
        return ()
    from floorplan import writers  # ezdxf and matplotlib come with it

    job = writers.Job(results.plan, config.drawing, _project(config, results.plan), sheet_facts(results, table, scan))
    pictures = [drawing.format for drawing in drawings if drawing.format in ON_SHEETS and drawing.format != "dxf"]
    if config.drawing.template and pictures:
        reporter.message(f"note: {', '.join(pictures)}: drawn with the built-in title block; a template is for DXF")
    shared = tuple(drawing for drawing in drawings if drawing.format in second.formats)
    sent = second.send(job, [(drawing.format, drawing.path) for drawing in shared])
    _write(job, (drawing for drawing in drawings if not (sent and drawing in shared)))
    if sent and not second.succeeded():
        _write(job, shared)
    files = files_of(drawings, results.plan)
    for path in files:
        reporter.message(f"wrote {path}")
    return files


def _write(job: "Job", drawings: Iterable[Drawing]) -> None:
    from floorplan import writers

    for drawing in drawings:
        with clear_disk_errors(drawing.path):
            writers.write_job(drawing.format, job, drawing.path)


def _project(config: Config, plan: Plan) -> ProjectConfig:
    """The title block's words; north as the site grid has it, unless it was given for the sheet itself."""
    if plan.site is None or config.project.north_deg is not None:
        return config.project
    return replace(config.project, north_deg=plan.site.north_deg)


def files_of(drawings: tuple[Drawing, ...], plan: Plan) -> tuple[Path, ...]:
    """The files that drawings of a plan become: some formats make one per storey."""
    from floorplan import writers

    return tuple(path for drawing in drawings for path in writers.files_of(drawing.format, plan, drawing.path))


def sheet_facts(results: Results, table: Summary, scan: Path) -> "SheetFacts":
    """What the sheet says about the scan it was made from."""
    from floorplan.writers.facts import FactRow, SheetFacts

    recording = results.scan.recording
    rows = (
        *(FactRow("Scan", f"{part.name}: {part.start}") for part in results.scan.parts),
        FactRow("Format", recording.format),
        FactRow("Gravity", recording.gravity_source.value),
        FactRow("Frames", f"{table.frames}, of which {table.keyframes} were looked at"),
        FactRow("Duration", f"{table.duration_s:.1f} s"),
        FactRow("Planes", f"{table.initial_planes} seen, {table.final_planes} after merging ({table.merge_method})"),
    )
    return SheetFacts(
        scan=scan.name,
        date=_date(results.scan),
        software=f"floorplan {__version__}",
        frames=table.frames,
        path_m=table.path_length_m,
        drift_m=table.drift.final_m if table.drift else None,
        rows=rows,
        problems=tuple(f"{p.code}: {p.message} ({p.count})" for p in results.problems),
        calibration=_calibration_words(results.solution.calibration),
        unseen=() if results.plan.upper_storeys else results.plan.notes,
    )


def _calibration_words(calibration: Calibration | None) -> str:
    """What the sheet says of a plan calibrated by tape: how many distances, and what they did to all others; empty without."""
    used = sum(row.used for row in calibration.rows) if calibration else 0
    if calibration is None or not used:
        return ""
    distances = f"{used} measured distance{'s' if used > 1 else ''}"
    left_out = len(calibration.rows) - used
    beside = f" ({left_out} more left out: all else contradicts)" if left_out else ""
    if calibration.scale == 1:
        return f"Calibrated by tape with {distances}{beside}; no common factor."
    interval = NORMAL_95 * calibration.scale_sigma
    return f"Calibrated by tape with {distances}{beside}; common factor {calibration.scale:.5f} +-{interval:.5f}."


def _date(scan: IngestedScan) -> str:
    """Day of the recording (ISO), empty where the stamps do not count from 1970."""
    seconds = int(scan.recording.stamp_ns[0]) // NANOSECONDS_PER_SECOND
    return datetime.fromtimestamp(seconds, UTC).date().isoformat() if seconds > EARLIEST_CLOCK_S else ""
