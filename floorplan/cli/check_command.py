"""`floorplan check`."""

import csv
from dataclasses import asdict, fields
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from floorplan.cli import options as o
from floorplan.cli.console import ConsoleReporter, counted, echo, echo_json, echo_table, whole_mm
from floorplan.errors import InputError
from floorplan.model.normal import NORMAL_95

if TYPE_CHECKING:
    from floorplan.laser.compare import Check

BY_HAND = ("Edited by hand", "Edit not applied")  # how notes about corrections by hand begin
TABLE_DECIMALS = 4  # of metres and per cent in the CSV table: no meter says more
HEADER = ("id", "measured", "plan", "difference", "%", "95 %", "level", "room")


def check(
    work: o.Work,
    laser: Annotated[Path, typer.Argument(metavar="LASER.csv", help="The measured distances.", show_default=False)],
    tolerance: Annotated[
        str | None, typer.Option("--tolerance", metavar="15mm|1%", help="Exit with 5 when a distance is off by more.")
    ] = None,
    csv_file: Annotated[Path | None, typer.Option("--csv", metavar="FILE", help="Write the table as CSV.")] = None,
    as_json: o.AsJson = False,
    quiet: o.Quiet = False,
) -> None:
    """Plan distances against measured ones: table, mean error, level of accuracy; the exit code tells."""
    from floorplan.export import read_calibration
    from floorplan.laser.compare import check_plan
    from floorplan.laser.table import read_laser
    from floorplan.laser.tolerance import enforce, parse_tolerance
    from floorplan.plan_file import read_plan

    reporter = ConsoleReporter(quiet)
    bound = None if tolerance is None else parse_tolerance(tolerance)
    if bound is not None:
        reporter.message(f"tolerance: {bound}")
    plan = read_plan(work)
    result = check_plan(plan, read_laser(laser), read_calibration(work))
    by_hand = [note for storey in plan.storeys for note in storey.notes if note.startswith(BY_HAND)]
    for row in result.bad:
        reporter.message(f"not compared: {row.text}")
    if csv_file is not None:
        write_check_csv(result, csv_file)
    if as_json:
        echo_json({**asdict(result), "calibrated": result.calibrated, "edits": by_hand})
    else:
        print_check(result)
        for note in by_hand:
            echo(f"note: {note}")
    if not result.rows and not result.bad:
        raise InputError(f"{laser}: measured_m is empty in all of its {result.empty} rows; measure on site, and write the metres there")
    if not result.rows:
        raise InputError(f"{laser}: none of its {len(result.bad) + result.empty} rows can be compared with the plan")
    if bound is not None:
        enforce(result, bound)


def print_check(result: "Check") -> None:
    """The table, then the verdict."""
    rows = [
        (
            row.id,
            f"{row.measured_m:.3f} m",
            f"{row.plan_m:.3f} m +-{NORMAL_95 * row.sigma_m:.3f}",
            f"{whole_mm(row.difference_m)} mm",
            f"{row.percent:+.2f}",
            "within" if row.within else "OUTSIDE",
            "calibrated with" if row.calibrated else row.level,
            row.room,
        )
        for row in result.rows
    ]
    if rows:
        echo_table([HEADER, *rows])
    if result.mean_m is None or result.worst_m is None or result.share_within is None:
        return
    echo()
    left_out = f", {counted(len(result.bad), 'row')} could not be compared" if result.bad else ""
    echo(f"{counted(len(rows), 'distance')}{left_out}")
    if result.calibrated:
        others = len(rows) - result.calibrated
        rest = f"the numbers below are of the other {others}" if others else "so these numbers prove nothing: measure others"
        echo(f"{result.calibrated} of them calibrated this plan (--laser): {rest}")
    echo(f"mean error {result.mean_percent:.2f} % ({1000 * result.mean_m:.1f} mm), all of them together {result.bias_percent:+.2f} %")
    echo(f"worst error {result.worst_percent:.2f} % ({1000 * result.worst_m:.1f} mm)")
    echo(f"{100 * result.share_within:.0f} % inside the 95 % interval")
    echo(f"level of accuracy at 95 % (USIBD): {result.level}")


def _rounded(row: dict[str, Any]) -> dict[str, Any]:
    """The row with tenths of millimetres."""
    return {name: f"{value:.{TABLE_DECIMALS}f}" if isinstance(value, float) else value for name, value in row.items()}


def write_check_csv(result: "Check", path: Path) -> None:
    """The rows as CSV. Raises InputError where the file cannot be written."""
    try:
        with path.open("w", encoding="utf-8", newline="") as stream:
            writer = csv.DictWriter(stream, [f.name for f in fields(result.rows[0])] if result.rows else ["id"], lineterminator="\n")
            writer.writeheader()
            writer.writerows(_rounded(asdict(row)) for row in result.rows)
    except OSError as error:
        raise InputError(f"{path}: cannot be written ({error.strerror}); name a file in a folder that exists") from error
