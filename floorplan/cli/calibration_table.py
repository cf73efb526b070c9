"""What the distances measured by hand did to the plan."""

from typing import TYPE_CHECKING

import typer

from floorplan.cli.console import echo, echo_table, whole_mm
from floorplan.model.normal import NORMAL_95

if TYPE_CHECKING:
    from floorplan.model.ties import Calibration

HEADER = ("measured by hand", "m", "plan without", "plan with", "from the others", "off")


def print_calibration(calibration: "Calibration") -> None:
    """One line per distance, the common scale, warnings on stderr."""
    rows = [
        (
            row.name,
            f"{row.measured_m:.3f}",
            f"{row.before_m:.3f}",
            f"{row.after_m:.3f}",
            f"{row.predicted_m:.3f} +-{NORMAL_95 * row.predicted_sigma_m:.3f}",
            f"{whole_mm(row.predicted_m - row.measured_m)} mm" + ("" if row.used else ", left out"),
        )
        for row in calibration.rows
    ]
    echo_table([HEADER, *rows])
    used = [row for row in calibration.rows if row.used]
    if len(used) > 1:
        mean_mm = 1000 * sum(abs(row.predicted_m - row.measured_m) for row in used) / len(used)
        echo(f"left out one at a time, each is foretold by the others to {mean_mm:.1f} mm on average: so good is the plan elsewhere")
    if calibration.scale != 1:
        off = 100 * (1 / calibration.scale - 1)
        echo(f"common scale {calibration.scale:.5f} +-{NORMAL_95 * calibration.scale_sigma:.5f}: all distances were {off:+.2f} % off")
    for warning in calibration.warnings:
        typer.echo(f"warning: {warning}", err=True)
