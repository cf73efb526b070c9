"""`floorplan simulate`."""

from pathlib import Path
from typing import Annotated

import typer

from floorplan.cli import options as o
from floorplan.cli.console import ConsoleReporter, echo


def simulate(
    out: Annotated[Path, typer.Argument(metavar="OUT", help="The folder to write; new or empty.", show_default=False)],
    preset: Annotated[str, typer.Option("--preset", metavar="NAME", help="area1 .. area6, office, flat.")] = "flat",
    seed: Annotated[int, typer.Option("--seed", metavar="N", help="Another number, another building.")] = 1,
    hard: Annotated[bool, typer.Option("--hard", help="Depth biases, more drift, tall cabinets, open doors.")] = False,
    format: Annotated[str, typer.Option("--format", metavar="NAME", help="tum, stray, mcap, ...; a wrong name lists all.")] = "tum",
    sensor: Annotated[str, typer.Option("--sensor", help="lidar16: a spinning LiDAR (default: the format's).")] = "",
    path_scale: Annotated[float, typer.Option("--path-scale", min=0.05, metavar="X", help="Longer building and walk.")] = 1.0,
    odometry_error: Annotated[float | None, typer.Option("--odometry-error", min=0.0, metavar="X", help="0.02 is 2 %.")] = None,
    rate_hz: Annotated[float | None, typer.Option("--rate", min=0.1, metavar="HZ", help="Frames per second.")] = None,
    image_scale: Annotated[float, typer.Option("--image-scale", min=0.05, metavar="X", help="Smaller or larger images.")] = 1.0,
    storeys: Annotated[int, typer.Option("--storeys", min=1, max=9, metavar="N", help="Floors above each other, joined by a stair.")] = 1,
    noise_seed: Annotated[int | None, typer.Option("--noise-seed", metavar="N", help="Another walk in the same building.")] = None,
    works: Annotated[bool, typer.Option("--works", help="The building after works: a wall moved, a partition built.")] = False,
    part: Annotated[str, typer.Option("--walk-part", metavar="A:B", help="Record only this part; 1:0.4 goes back to front.")] = "0:1",
    quiet: o.Quiet = False,
) -> None:
    """An exact building, a walked scan of it, and its truth."""
    from floorplan.simulate import simulate as run
    from floorplan.simulate.walk_part import walk_part

    left_out = run(
        out,
        preset,
        seed,
        hard=hard,
        format=format,
        sensor=sensor,
        path_scale=path_scale,
        odometry_error=odometry_error,
        rate_hz=rate_hz,
        image_scale=image_scale,
        storeys=storeys,
        noise_seed=noise_seed,
        works=works,
        walk_part=walk_part(part),
        progress=ConsoleReporter(quiet).progress("simulate"),
    )
    for words in left_out:
        ConsoleReporter(quiet).message(f"note: {words}")
    echo(str(out))
