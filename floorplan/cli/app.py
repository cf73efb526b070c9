"""The typer application: every command in one place, each in its own small module."""

from typing import Annotated

import typer

from floorplan import __version__
from floorplan.cli import (
    build_command,
    check_command,
    compare_command,
    info_command,
    look_commands,
    merges_command,
    report_command,
    simulate_command,
    solve_command,
    template_command,
    view_command,
    work_commands,
)

app = typer.Typer(
    no_args_is_help=True,
    add_completion=False,
    rich_markup_mode=None,
    pretty_exceptions_enable=False,
    help="Offline floor plans that surveyors trust, from recorded depth and odometry.",
    epilog="Exit codes: 0 done, 1 a bug, 2 wrong usage, 3 input cannot be used, 4 no solution, 5 a check failed, 130 interrupted.",
)


def _print_version(asked: bool) -> None:
    if asked:
        typer.echo(f"floorplan {__version__}")
        raise typer.Exit


@app.callback()
def _floorplan(
    version: Annotated[bool, typer.Option("--version", callback=_print_version, is_eager=True, help="Print the version and exit.")] = False,
) -> None:
    """Offline floor plans that surveyors trust, from recorded depth and odometry."""


app.command("build")(build_command.build)
app.command("info")(info_command.info)
app.command("status")(work_commands.status)
app.command("check")(check_command.check)
app.command("compare")(compare_command.compare)
app.command("merges")(merges_command.merges)
app.command("export")(work_commands.export)
app.command("report")(report_command.report)
app.command("view")(view_command.view)
app.command("formats")(look_commands.formats)
app.command("template")(template_command.template)
app.command("config")(look_commands.config)
app.command("doctor")(look_commands.doctor)
app.command("solve")(solve_command.solve)
app.command("simulate")(simulate_command.simulate)
