"""`floorplan solve`: the back end alone."""

from pathlib import Path
from typing import Annotated

import typer

from floorplan.cli import options as o
from floorplan.cli.console import ConsoleReporter


def solve(
    graph: Annotated[Path, typer.Argument(metavar="GRAPH.npz", help="A layout graph.", show_default=False)],
    out: Annotated[Path, typer.Option("--json", metavar="OUT.json", help="Where the answer goes.", show_default=False)],
    method: Annotated[str | None, typer.Option("--method", metavar="NAME", help="evidence or paper.")] = None,
    no_covariance: Annotated[bool, typer.Option("--no-covariance", help="Leave the planes' covariance out.")] = False,
    config: o.ConfigFile = None,
    settings: o.Settings = None,
    quiet: o.Quiet = False,
) -> None:
    """Least squares, merge and re-solve on a layout graph from elsewhere."""
    from floorplan.errors import InputError
    from floorplan.graph_file import load_graph
    from floorplan.solve_graph import solve_graph, solved_to_json

    reporter = ConsoleReporter(quiet)
    short = [] if method is None else [f"merge.method={method}"]
    effective = o.effective_config(config, [*(settings or []), *short])
    solved = solve_graph(load_graph(graph), effective, covariance=not no_covariance, progress=reporter.progress("solve"))
    try:
        out.write_text(solved_to_json(solved), "utf-8")
    except OSError as error:
        raise InputError(f"{out}: cannot be written: {error.strerror}; name a file in a folder that exists") from error
    if solved.rejected_rows:
        reporter.message(f"{solved.rejected_rows} measurements left out: their sign contradicts their facing")
    accepted = int(solved.merged.hypotheses.accepted.sum())
    reporter.message(
        f"{len(solved.solution.plane_of_track)} tracks, {len(solved.solution.plane_offset_m)} planes, "
        f"{accepted} of {len(solved.merged.hypotheses)} hypotheses accepted, {solved.seconds:.2f} s"
    )
