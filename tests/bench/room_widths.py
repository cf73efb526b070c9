"""Wall-to-wall distances inside single rooms: `python -m tests.bench.room_widths SCAN WORK [SCAN WORK ...]`.

Of the 300 distances that `tests.bench.score` takes at points of the path, those up to `ONE_LOOK_M` whose two ends are walls of one room
or corridor, so that the depth alone measured them and not the walk. A pier or recess that is not drawn makes an error of decimetres:
`OTHER_FACE_M` tells ends on another face apart, and the figures with them are printed too.
"""

import argparse
import sys
from pathlib import Path

import numpy as np

from tests.bench.score_input import load_case
from tests.bench.score_walls import wall_to_wall

ONE_LOOK_M = 6.0  # the simulated cameras' range; longer ones are lengths of corridors
OTHER_FACE_M = 0.08  # off by more, an end is on another face; piers stand out by 10 cm and more


def row(scan: Path, work: Path) -> tuple[str, list[float]]:
    """The scan's name, and its figures in the order of the columns."""
    spans = wall_to_wall(load_case(scan, work))
    used = spans.in_room & (spans.length_m <= ONE_LOOK_M)
    length, error = spans.length_m[used], np.abs(spans.plan_m - spans.length_m)[used]
    found = np.isfinite(error)
    same = found & (error <= OTHER_FACE_M)
    part = error[same] / length[same]
    own = [error[same].mean() * 1e3, np.percentile(error[same], 95) * 1e3, part.mean() * 100]
    return scan.name, [len(error), 1 - same.mean(), *own, error[found].mean() * 1e3, np.percentile(error[found], 95) * 1e3]


def main() -> None:
    """The command."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("folders", type=Path, nargs="+", help="SCAN WORK, SCAN WORK, ...")
    asked = parser.parse_args()
    if len(asked.folders) % 2:
        parser.error("give a work folder for every scan: SCAN WORK SCAN WORK ...")
    rows = [row(scan, work) for scan, work in zip(asked.folders[::2], asked.folders[1::2], strict=True)]
    sys.stdout.write(
        "| scan | distances | on another face | mean mm | 95 % mm | mean % | mean mm, all | 95 % mm, all |\n" + "| --- " * 8 + "|\n"
    )
    for name, (count, other, *rest) in [*rows, ("mean", list(np.mean([values for _, values in rows], axis=0)))]:
        sys.stdout.write(f"| {name} | {count:.0f} | {other:.3f} | " + " | ".join(f"{value:.2f}" for value in rest) + " |\n")


if __name__ == "__main__":
    main()
