"""`floorplan template`: a title block to start one's own from."""

from pathlib import Path
from typing import Annotated

import typer

from floorplan.cli import options as o
from floorplan.cli.console import echo


def template(
    out: Annotated[Path, typer.Argument(metavar="OUT.dxf", help="The template to write.", show_default=False)],
    sheet: o.Sheet = None,
    config: o.ConfigFile = None,
    settings: o.Settings = None,
) -> None:
    """An empty sheet with our layers, styles and title block as DXF: change it in a CAD program, then give it to --template."""
    from floorplan.errors import UsageError

    effective = o.effective_config(config, settings, sheet=sheet)
    if not out.parent.is_dir() or out.is_dir():
        raise UsageError(f"{out}: give the name of a file in a folder that exists")
    from floorplan.writers import write_atomically
    from floorplan.writers.dxf import template_bytes

    write_atomically(out, template_bytes(effective.drawing))
    echo(str(out))
