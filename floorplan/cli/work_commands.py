"""`floorplan status` and `floorplan export`: what a work folder holds, and drawings from it again."""

from dataclasses import asdict
from pathlib import Path
from typing import Annotated

import typer

from floorplan.cli import options as o
from floorplan.cli.console import ConsoleReporter, echo, echo_json, echo_table
from floorplan.config import Config
from floorplan.errors import UsageError


def status(work: o.Work, config: o.ConfigFile = None, settings: o.Settings = None, as_json: o.AsJson = False) -> None:
    """The stages: kept, stale (and because of what), missing; seconds and sizes.

    Without --config and --set, the settings of the last build hold.
    """
    from floorplan.work.folder import read_owner
    from floorplan.work.status import current_owner, stages_status

    made_for = read_owner(work)
    effective = o.effective_config(config or work / "config.toml", settings)
    states = stages_status(work, effective, current_owner(made_for, work))
    if as_json:
        echo_json({"scan": made_for.scan, "format": made_for.format, "stages": [asdict(state) for state in states]})
        return
    echo(f"{made_for.scan} ({made_for.format})")
    echo_table(
        (s.folder, s.state, "" if s.seconds is None else f"{s.seconds:.1f} s", f"{s.size_bytes / 1e6:.1f} MB", "; ".join(s.reasons))
        for s in states
    )


def export(
    work: o.Work,
    dxf: o.Dxf = None,
    svg: o.Svg = None,
    pdf: o.Pdf = None,
    png: o.Png = None,
    json: o.JsonFile = None,
    geojson: o.Geojson = None,
    csv: o.Csv = None,
    report: o.Report = None,
    graph: Annotated[Path | None, typer.Option("--graph", metavar="F.npz", help="The layout graph, for 'floorplan solve'.")] = None,
    frame: Annotated[
        int | None, typer.Option("--frame", metavar="N", help="With --png: not the plan but what the camera saw in frame N, labelled.")
    ] = None,
    config: o.ConfigFile = None,
    settings: o.Settings = None,
    units: o.Units = None,
    scale: o.Scale = None,
    sheet: o.Sheet = None,
    quiet: o.Quiet = False,
) -> None:
    """Write drawings, or the layout graph, again from finished stages."""
    from floorplan.work.folder import read_owner

    if frame is not None:
        _export_frame(work, frame, png, o.effective_config(config or work / "config.toml", settings))
        png = None
        if not any((dxf, svg, pdf, json, geojson, csv, report, graph)):
            return
    drawings = o.asked_drawings(csv, dxf=dxf, svg=svg, pdf=pdf, png=png, json=json, geojson=geojson, report=report)
    if not drawings and graph is None:
        raise UsageError("nothing to write: give at least one of --dxf, --svg, --pdf, --png, --json, --geojson, --csv, --report, --graph")
    read_owner(work)
    from floorplan.export import export as run
    from floorplan.export import export_graph

    effective = o.effective_config(config or work / "config.toml", settings, units=units, scale=scale, sheet=sheet)
    if graph is not None:
        export_graph(work, effective, graph)
    written = run(work, effective, drawings, ConsoleReporter(quiet)) if drawings else ()
    for path in (*written, *([graph] if graph else [])):
        echo(str(path))


def _export_frame(work: Path, frame: int, png: Path | None, config: Config) -> None:
    """Write the labelled picture of one frame to `png`."""
    if png is None:
        raise UsageError("--frame needs --png F, the picture to write")
    from floorplan.frame_export import export_frame

    row = export_frame(work, config, frame, png)
    echo(f"{png} (frame {row})")
