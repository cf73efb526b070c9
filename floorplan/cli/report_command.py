"""`floorplan report`."""

from pathlib import Path
from typing import Annotated

import typer

from floorplan.cli import options as o
from floorplan.cli.console import ConsoleReporter, echo


def report(
    work: o.Work,
    out: Annotated[Path, typer.Argument(metavar="F.html", help="The page to write.", show_default=False)],
    laser: Annotated[Path | None, typer.Option("--laser", metavar="LASER.csv", help="Measured distances to check against.")] = None,
    config: o.ConfigFile = None,
    settings: o.Settings = None,
    quiet: o.Quiet = False,
) -> None:
    """One offline HTML page: plan, evidence, accuracy, what was rejected and why."""
    from floorplan.work.folder import read_owner

    read_owner(work)
    effective = o.effective_config(config or work / "config.toml", settings)
    from floorplan.write_report import write_report

    for row in write_report(work, effective, out, laser):
        ConsoleReporter(quiet).message(f"not compared: {row.text}")
    echo(str(out))
