"""`floorplan status` and `floorplan export`: what a work folder holds, and drawings from it again."""

import os
from dataclasses import asdict
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from floorplan.cli import options as o
from floorplan.cli.console import ConsoleReporter, echo, echo_json, echo_table
from floorplan.cli.site_table import print_site
from floorplan.config import Config
from floorplan.errors import UsageError

if TYPE_CHECKING:
    from floorplan.drawings import Drawing
    from floorplan.work.status import StageStatus


def status(work: o.Work, config: o.ConfigFile = None, settings: o.Settings = None, as_json: o.AsJson = False) -> None:
    """The stages: kept, stale (and because of what), missing; seconds and sizes.

    Without --config and --set, the settings of the last build hold. Of several scans joined, those of each follow.
    """
    from floorplan.work.folder import part_folders

    folders = (work, *part_folders(work))
    if as_json:
        states = [_status_tree(folder, config, settings) for folder in folders]
        echo_json(states[0] | ({"parts": states[1:]} if len(states) > 1 else {}))
        return
    for folder in folders:
        _print_status(folder, config, settings)


def _status_tree(work: Path, config: Path | None, settings: list[str] | None) -> dict[str, Any]:
    from floorplan.export import read_advice
    from floorplan.work.folder import read_owner

    owner = read_owner(work)
    states = _states(work, config, settings)
    advice = [asdict(one) for one in read_advice(work, states)]
    several = {"scans": owner.scans} if owner.scans else {}
    return {"scan": owner.scan, **several, "format": owner.format, "stages": [asdict(state) for state in states], "advice": advice}


def _print_status(work: Path, config: Path | None, settings: list[str] | None) -> None:
    from floorplan.export import read_advice
    from floorplan.work.folder import read_owner

    owner, states = read_owner(work), _states(work, config, settings)
    echo(f"{owner.scan} ({owner.format}{', joined' if owner.scans else ''})")
    echo_table(
        (s.folder, s.state, "" if s.seconds is None else f"{s.seconds:.1f} s", f"{s.size_bytes / 1e6:.1f} MB", "; ".join(s.reasons))
        for s in states
    )
    _print_next(states)
    for one in read_advice(work, states):
        echo(f"better: {one}")


def _print_next(states: "tuple[StageStatus, ...]") -> None:
    """What the next build would do, and how long that took last time."""
    again = [state for state in states if state.state != "kept"]
    if not again:
        echo("everything is up to date: the next build makes no stage again")
        return
    known = [state.seconds for state in again if state.seconds is not None]
    took = f"; they took {sum(known):.0f} s last time" if len(known) == len(again) else ""
    echo(f"the next build makes {', '.join(state.folder for state in again)}{took}")


def _states(work: Path, config: Path | None, settings: list[str] | None) -> "tuple[StageStatus, ...]":
    from floorplan.work.folder import read_owner
    from floorplan.work.status import current_owner, stages_status

    effective = o.effective_config(config or work / "config.toml", settings)
    return stages_status(work, effective, current_owner(read_owner(work), work))


def export(
    work: o.Work,
    dxf: o.Dxf = None,
    svg: o.Svg = None,
    pdf: o.Pdf = None,
    png: o.Png = None,
    json: o.JsonFile = None,
    geojson: o.Geojson = None,
    ifc: o.Ifc = None,
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
    template: o.Template = None,
    profile: o.Profile = None,
    layers: o.Layers = None,
    dxf_version: o.DxfVersion = None,
    control: o.Control = None,
    north: o.North = None,
    quiet: o.Quiet = False,
) -> None:
    """Write drawings, or the layout graph, again from finished stages."""
    from floorplan.work.folder import read_owner

    if frame is not None:
        _export_frame(work, frame, png, o.effective_config(config or work / "config.toml", settings))
        png = None
        if not any((dxf, svg, pdf, json, geojson, ifc, csv, report, graph)):
            return
    drawings = o.asked_drawings(csv, dxf=dxf, svg=svg, pdf=pdf, png=png, json=json, geojson=geojson, ifc=ifc, report=report)
    if not drawings and graph is None:
        options = ("dxf", "svg", "pdf", "png", "json", "geojson", "ifc", "csv", "report", "graph")
        raise UsageError(f"nothing to write: give at least one of {', '.join(f'--{name}' for name in options)}")
    read_owner(work)
    from floorplan.corrections import with_site
    from floorplan.export import export_graph

    drawn = {"units": units, "scale": scale, "sheet": sheet, "template": template}
    drawn |= {"profile": profile, "layers": layers, "dxf_version": dxf_version}
    effective = o.effective_config(config or work / "config.toml", settings, **drawn)
    effective = with_site(effective, control, north)
    if dxf is not None:
        o.check_template(effective)
    if drawings:
        _export_drawings(work, effective, drawings, quiet)
    if graph is not None:
        export_graph(work, effective, graph)
        echo(str(graph))


def _export_drawings(work: Path, config: Config, drawings: "tuple[Drawing, ...]", quiet: bool) -> None:
    from floorplan.export import export as run

    exported = run(work, config, drawings, ConsoleReporter(quiet), os.cpu_count() or 1)
    if exported.plan.site is not None and not quiet:
        print_site(exported.plan.site)
    for path in exported.files:
        echo(str(path))


def _export_frame(work: Path, frame: int, png: Path | None, config: Config) -> None:
    """Write the labelled picture of one frame to `png`."""
    if png is None:
        raise UsageError("--frame needs --png F, the picture to write")
    from floorplan.frame_export import export_frame

    row = export_frame(work, config, frame, png)
    echo(f"{png} (frame {row})")
