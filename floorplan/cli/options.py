"""Options that several commands share, each with its help text once."""

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

if TYPE_CHECKING:
    from floorplan.config import Config
    from floorplan.drawings import Drawing

Scan = Annotated[
    Path,
    typer.Argument(metavar="SCAN", help="The recording: the folder of an app or camera, a laser log, or a ROS bag.", show_default=False),
]
Scans = Annotated[
    list[Path],
    typer.Argument(
        metavar="SCAN...",
        help="The recording: the folder of an app or camera, a laser log, or a ROS bag; several of one floor are joined.",
        show_default=False,
    ),
]
Work = Annotated[Path, typer.Argument(metavar="WORK", help="The work folder of a build.", show_default=False)]
Format = Annotated[str | None, typer.Option("--format", metavar="NAME", help="Format of the recording (default: recognised).")]
ConfigFile = Annotated[Path | None, typer.Option("--config", metavar="F.toml", help="Settings file; see 'floorplan config'.")]
Settings = Annotated[list[str] | None, typer.Option("--set", metavar="SECTION.KEY=VALUE", help="Change one setting (repeatable).")]
Topics = Annotated[
    list[str] | None, typer.Option("--topic", metavar="depth|pose|imu=NAME", help="Topic of a ROS bag to read (repeatable).")
]
AsJson = Annotated[bool, typer.Option("--json", help="Answer in JSON.")]
Quiet = Annotated[bool, typer.Option("--quiet", "-q", help="Errors only.")]
Verbose = Annotated[bool, typer.Option("--verbose", "-v", help="Say more: why each stage is made.")]
Jobs = Annotated[int, typer.Option("--jobs", "-j", min=0, metavar="N", help="Threads; above 1 a second process draws; 0: one per core.")]
Dxf = Annotated[Path | None, typer.Option("--dxf", metavar="FILE", help="CAD drawing.")]
Svg = Annotated[Path | None, typer.Option("--svg", metavar="FILE", help="Drawing in true millimetres.")]
Pdf = Annotated[Path | None, typer.Option("--pdf", metavar="FILE", help="Sheet to print.")]
Png = Annotated[Path | None, typer.Option("--png", metavar="FILE", help="Picture.")]
JsonFile = Annotated[Path | None, typer.Option("--json", metavar="FILE", help="The plan as data.")]
Geojson = Annotated[Path | None, typer.Option("--geojson", metavar="FILE", help="The plan for GIS.")]
Ifc = Annotated[Path | None, typer.Option("--ifc", metavar="FILE", help="Building model, IFC4 (needs the extra 'ifc').")]
Csv = Annotated[Path | None, typer.Option("--csv", metavar="DIR", help="Tables: dimensions.csv and rooms.csv in this folder.")]
Report = Annotated[Path | None, typer.Option("--report", metavar="FILE", help="A page with the plan, its numbers and its problems (HTML).")]
Trim = Annotated[str | None, typer.Option("--trim", metavar="12s:340s", help="Use this part of the recording; either end may be left out.")]
Control = Annotated[
    Path | None, typer.Option("--control", metavar="POINTS.csv", help="Points on the site grid: places the plan in every export.")
]
North = Annotated[
    float | None, typer.Option("--north", metavar="DEG", help="Grid north, counter-clockwise from the plan's +y: turns every export.")
]
Units = Annotated[str | None, typer.Option("--units", metavar="m|mm|ft", help="Units of the drawing.")]
Scale = Annotated[str | None, typer.Option("--scale", metavar="1:50", help="Scale of the sheet (default: chosen to fit).")]
Template = Annotated[str | None, typer.Option("--template", metavar="F.dxf", help="A title block of your own; see 'floorplan template'.")]
Sheet = Annotated[str | None, typer.Option("--sheet", metavar="A3", help="Size of the sheet.")]
Profile = Annotated[str | None, typer.Option("--profile", metavar="cafm", help="What a strict importer demands.")]
Layers = Annotated[str | None, typer.Option("--layers", metavar="ncs|iso13567", help="Names of the layers.")]
DxfVersion = Annotated[str | None, typer.Option("--dxf-version", metavar="R2010", help="Of the DXF file: R2000 to R2018.")]

TOPIC_SETTINGS = {  # what `--topic` calls the topics: sweeps and clouds are read in the place of depth
    "depth": "read.range_topic",
    "range": "read.range_topic",
    "pose": "read.pose_topic",
    "imu": "read.imu_topic",
}


def effective_config(path: Path | None, settings: list[str] | None, **drawing: str | None) -> "Config":
    """The configuration of the file, `--set`, and the options that are short for settings of `[drawing]`."""
    from floorplan.config_file import load_config

    short = [f"drawing.{name}={value}" for name, value in drawing.items() if value is not None]
    return load_config(path, [*(settings or []), *short])


def trim_settings(trim: str | None) -> list[str]:
    """`--trim` as a setting, checked. Raises `UsageError` for what is no stretch of time."""
    if trim is None:
        return []
    from floorplan.trim import parse_trim

    parse_trim(trim)
    return [f'ingest.trim="{trim}"']


def topic_settings(topics: list[str] | None) -> list[str]:
    """`--topic depth=/x` and the like as settings. Raises `UsageError` for any other role than depth, pose, imu."""
    from floorplan.errors import UsageError

    settings = []
    for text in topics or []:
        role, _, name = text.partition("=")
        if role not in TOPIC_SETTINGS or not name:
            raise UsageError(f"--topic {text}: write one of {', '.join(f'{known}=NAME' for known in TOPIC_SETTINGS)}")
        settings.append(f"{TOPIC_SETTINGS[role]}={name}")
    return settings


def asked_drawings(csv: Path | None, **files: Path | None) -> tuple["Drawing", ...]:
    """The drawings asked for, checked: format name = file; `csv` is the folder of the tables, made if need be."""
    from floorplan.drawings import Drawing, check_drawings, tables_in

    drawings = tuple(Drawing(name, path) for name, path in files.items() if path is not None)
    drawings += tables_in(csv) if csv is not None else ()
    check_drawings(drawings)
    return drawings


def default_work(scan: Path, *more: Path) -> Path:
    """The scan's name with `.floorplan`, beside it; of several, all names, beside the first."""
    whole = scan.resolve()
    return whole.with_name("+".join([whole.name, *(path.resolve().name for path in more)]) + ".floorplan")


def check_scan(scan: Path) -> None:
    """Raise `InputError` at once, before anything heavy is loaded, when there is nothing at `scan`."""
    from floorplan.errors import InputError

    if not scan.exists():
        raise InputError(f"{scan}: no such file or folder; give the folder that holds the recording, or the log file")


def check_topics(scan: Path, format: str | None, topics: list[str] | None) -> None:
    """Raise `UsageError` at once for topics of a recording that has none."""
    if not topics:
        return
    from floorplan.errors import UsageError
    from floorplan.readers import reader_for

    reader = reader_for(scan, format)
    if reader.name != "ros":
        raise UsageError(f"--topic {topics[0]}: {scan} is no ROS bag but {reader.description}; leave --topic out")


def check_template(config: "Config") -> None:
    """Raise `ConfigError` at once when the title block of one's own lacks what it must own."""
    if config.drawing.template:
        from floorplan.writers.dxf_template import check_template as check

        check(config.drawing)
