"""Where the plan was placed on the site grid, and how well its control points fit."""

from typing import TYPE_CHECKING

import typer

from floorplan.cli.console import echo, echo_table, whole_mm
from floorplan.model.normal import NORMAL_95

if TYPE_CHECKING:
    from floorplan.model.site import Site

HEADER = ("control point", "x", "y", "east", "north", "off east", "off north", "")


def print_site(site: "Site") -> None:
    """Turn and shift, one line per control point, the scale they ask for; warnings on stderr."""
    echo(f"on the site grid: origin at east {site.east_m:.3f}, north {site.north_m:.3f}, turned by {site.rotation_deg:.4f} degrees")
    if site.points:
        rows = [
            (
                point.name,
                *(f"{value:.3f}" for value in (*point.plan, *point.site)),
                *(f"{whole_mm(value)} mm" for value in point.residual_m),
                "corner" if point.snapped else "",
            )
            for point in site.points
        ]
        echo_table([HEADER, *rows])
    if site.scale is not None and site.scale_sigma is not None:
        off = 100 * (site.scale - 1)
        echo(f"lengths on the grid against the plan's: {off:+.3f} % +-{100 * NORMAL_95 * site.scale_sigma:.3f} (the plan keeps its own)")
    for warning in site.warnings:
        typer.echo(f"warning: {warning}", err=True)
