"""`floorplan build`."""

import os
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from floorplan.cli import options as o
from floorplan.cli.calibration_table import print_calibration
from floorplan.cli.console import ConsoleReporter, echo, echo_table
from floorplan.cli.interrupts import INTERRUPTED, was_interrupted
from floorplan.cli.site_table import print_site
from floorplan.errors import UsageError
from floorplan.model.normal import NORMAL_95

if TYPE_CHECKING:
    from floorplan.build import Job
    from floorplan.drawings import Drawing
    from floorplan.results import Results
    from floorplan.work.stages import Stage

NAMED_DIMENSIONS = 12  # as many are listed; the rest are in the drawing


def build(
    scans: o.Scans,
    dxf: o.Dxf = None,
    svg: o.Svg = None,
    pdf: o.Pdf = None,
    png: o.Png = None,
    json: o.JsonFile = None,
    geojson: o.Geojson = None,
    ifc: o.Ifc = None,
    csv: o.Csv = None,
    report: o.Report = None,
    work: Annotated[Path | None, typer.Option("--work", metavar="DIR", help="Work folder (default: SCAN.floorplan).")] = None,
    config: o.ConfigFile = None,
    settings: o.Settings = None,
    from_stage: Annotated[str | None, typer.Option("--from", metavar="STAGE", help="Make this stage and what follows again.")] = None,
    until_stage: Annotated[str | None, typer.Option("--until", metavar="STAGE", help="Stop after this stage.")] = None,
    laser: Annotated[Path | None, typer.Option("--laser", metavar="F.csv", help="Distances measured by hand: calibrates the plan.")] = None,
    edits: Annotated[Path | None, typer.Option("--edits", metavar="F.toml", help="Corrections by hand.")] = None,
    start: Annotated[str | None, typer.Option("--start", metavar="match|common|F.csv", help="How several scans are laid together.")] = None,
    control: o.Control = None,
    north: o.North = None,
    format: o.Format = None,
    topics: o.Topics = None,
    trim: o.Trim = None,
    units: o.Units = None,
    scale: o.Scale = None,
    sheet: o.Sheet = None,
    template: o.Template = None,
    profile: o.Profile = None,
    layers: o.Layers = None,
    dxf_version: o.DxfVersion = None,
    jobs: o.Jobs = 0,
    quiet: o.Quiet = False,
    verbose: o.Verbose = False,
) -> None:
    """Scan to plan: the whole job; several scans of one floor become one plan.

    Finished stages are kept, so giving the command again is cheap.
    """
    reporter = ConsoleReporter(quiet, verbose)
    short = [*o.topic_settings(topics), *o.trim_settings(trim)]
    drawn = {"units": units, "scale": scale, "sheet": sheet, "template": template}
    drawn |= {"profile": profile, "layers": layers, "dxf_version": dxf_version}
    effective = o.effective_config(config, [*(settings or []), *short], **drawn)
    redo_from, until = _stages(from_stage, until_stage)
    for scan in scans:
        o.check_scan(scan)
        o.check_topics(scan, format, topics)
    from floorplan.build import Job
    from floorplan.corrections import with_edits, with_laser, with_site, with_start

    drawings = o.asked_drawings(csv, dxf=dxf, svg=svg, pdf=pdf, png=png, json=json, geojson=geojson, ifc=ifc, report=report)
    _check_drawn(drawings, until)
    o.check_template(effective)
    effective = with_site(with_start(with_edits(with_laser(effective, laser), edits), start), control, north)
    job = Job(scans[0], work or o.default_work(*scans), effective, format, redo_from, until, drawings, jobs or os.cpu_count() or 1)
    results = _run(job, scans, reporter)
    if results is not None and not quiet:
        _print_numbers(job, results)


def _stages(from_stage: str | None, until_stage: str | None) -> "tuple[Stage | None, Stage | None]":
    """The stages that `--from` and `--until` name. Raises UsageError for names that are none, and for an order that makes nothing."""
    from floorplan.work.stages import check_order, stage_named

    redo_from = stage_named(from_stage) if from_stage else None
    until = stage_named(until_stage) if until_stage else None
    check_order(redo_from, until)
    return redo_from, until


def _check_drawn(drawings: "tuple[Drawing, ...]", until: "Stage | None") -> None:
    """Raise UsageError where drawings are asked of a build that stops before there is a plan."""
    from floorplan.work.stages import PLAN

    if drawings and until not in (None, PLAN):
        asked = ", ".join(str(drawing.path) for drawing in drawings)
        raise UsageError(f"--until {until.name} stops before the plan, so {asked} would not be drawn; leave one of the two out")


def _run(job: "Job", scans: list[Path], reporter: ConsoleReporter) -> "Results | None":
    """The build of one scan or of several; interrupted, it says what is kept and how to go on."""
    try:
        if len(scans) == 1:
            from floorplan.build import build as run

            return run(job, reporter)
        from floorplan.build_several import build_several, title_of

        return build_several(replace(job, scan=Path(title_of(scans))), scans, reporter)
    except (KeyboardInterrupt, SystemError) as error:
        if not was_interrupted(error):
            raise
        typer.echo(_kept_words(job.work), err=True)
        raise typer.Exit(INTERRUPTED) from None


def _kept_words(work: Path) -> str:
    """What an interrupted build leaves, and how to go on."""
    from floorplan.work.folder import partial_name
    from floorplan.work.stages import STAGES

    kept = [stage.folder for stage in STAGES if (work / stage.folder).is_dir()]
    kept += [f"part of {stage.folder}" for stage in STAGES if (work / partial_name(stage)).is_dir()]
    if not kept:
        return f"interrupted; {work} keeps no stage yet: {STAGES[0].folder} is kept when it is whole. The same command begins it anew."
    return f"interrupted; {work} keeps {', '.join(kept)}. Give the same command again to go on from there."


def _print_numbers(job: "Job", results: "Results") -> None:
    from floorplan.drawings import files_of

    levels = results.plan.storeys
    rooms = [room for level in levels for room in level.rooms]
    dimensions = [dimension for level in levels for dimension in level.dimensions]
    storeys = [("storeys", str(len(levels)), ", ".join(f"{level.level} at {level.elevation_m:+.3f} m" for level in levels))]
    echo_table(
        [
            *(storeys if len(levels) > 1 else []),
            ("rooms", str(len(rooms)), f"{sum(room.area_m2 for room in rooms):.1f} m2 in all"),
            (
                "walls",
                str(sum(len(level.walls) for level in levels)),
                f"{sum(len(level.free_lines) for level in levels)} more off the axes",
            ),
            ("openings", str(sum(len(level.openings) for level in levels)), ""),
            (
                "planes",
                str(len(results.solution.plane_offset_m)),
                f"from {len(results.layout.tracks.axis)} initial ones ({results.merged.method})",
            ),
            ("dimensions", str(len(dimensions)), ""),
        ]
    )
    echo_table((d.id, f"{d.distance_m:.3f} m", f"+-{NORMAL_95 * d.sigma_m:.3f}", d.room) for d in dimensions[:NAMED_DIMENSIONS])
    if len(dimensions) > NAMED_DIMENSIONS:
        echo(f"and {len(dimensions) - NAMED_DIMENSIONS} more dimensions: in {job.work / 'plan.json'}, and in dimensions.csv with --csv DIR")
    if results.solution.calibration is not None:
        print_calibration(results.solution.calibration)
    if results.plan.site is not None:
        print_site(results.plan.site)
    for level in levels:
        for note in level.notes:
            echo(f"note: {f'{level.level}: ' if len(levels) > 1 else ''}{note}")
    for file in (*files_of(job.drawings, results.plan), job.work):
        echo(str(file))
