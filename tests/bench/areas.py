"""The six simulated areas beside the paper's table: `python -m tests.bench.areas FOLDER --seeds 1 2 3`.

Every scan is simulated into FOLDER (kept, if it is there), then built twice from the same segments: with the published
method (plain least squares, L1, 30 cm) and with the default one. The tables are medians over the seeds.
"""

import argparse
import json
import sys
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from statistics import median
from typing import Any

from floorplan.build import Job, build
from floorplan.config_file import load_config
from floorplan.simulate import simulate
from tests.bench.score import score

AREAS = ("area1", "area2", "area3", "area4", "area5", "area6")
LONG_AREAS_RATE_HZ = 5.0  # areas 2 and 3 at half the paper's frame rate: the same walk, half the images
METHODS = {
    "published": ("merge.method=paper", "least_squares.method=plain"),
    "default": (),
}


@dataclass(frozen=True)
class Run:
    """One build of one scan: `summary.json`, the scores against the truth, and how many planes the truth has."""

    summary: dict[str, Any]
    score: dict[str, Any]
    true_planes: int


def scan_of(folder: Path, area: str, seed: int) -> Path:
    """The simulated scan, made when it is not there."""
    scan = folder / f"{area}-{seed}"
    if not (scan / "truth.json").is_file():
        simulate(scan, area, seed, rate_hz=LONG_AREAS_RATE_HZ if area in ("area2", "area3") else None)
    return scan


def run(scan: Path, work: Path, method: str) -> Run:
    """Build `scan` by one of METHODS and score it."""
    build(Job(scan, work, load_config(None, METHODS[method])))
    truth = json.loads((scan / "truth.json").read_text("utf-8"))
    summary = json.loads((work / "summary.json").read_text("utf-8"))
    return Run(summary, score(scan, work), len(truth["planes"]))


Cell = Callable[[Run], float]
DRIFT_COLUMNS: tuple[tuple[str, Cell], ...] = (
    ("path m", lambda r: r.summary["path_length_m"]),
    ("considered", lambda r: r.summary["hypotheses_considered"]),
    ("accepted", lambda r: r.summary["hypotheses_accepted"]),
    ("initial", lambda r: r.summary["initial_planes"]),
    ("after", lambda r: r.summary["final_planes"]),
    ("true", lambda r: r.true_planes),
    ("odometry m", lambda r: r.summary["drift"]["odometry_m"]),
    ("compass m", lambda r: r.summary["drift"]["compass_m"]),
    ("least squares m", lambda r: r.summary["drift"]["least_squares_m"]),
    ("final m", lambda r: r.summary["drift"]["final_m"]),
)
SCORE_COLUMNS: tuple[tuple[str, Cell], ...] = (
    ("complexity reduction", lambda r: r.summary["complexity_reduction"]),
    ("by true planes", lambda r: 1 - r.true_planes / r.summary["initial_planes"]),
    ("wall-to-wall %", lambda r: 100 * r.score["spans"]["mean_relative"]),
    ("missed %", lambda r: 100 * r.score["spans"]["missed"]),
    ("path error m", lambda r: r.score["trajectory"]["mean_m"]),
    ("precision 5 cm", lambda r: r.score["walls"]["precision"]["5cm"]),
    ("recall 5 cm", lambda r: r.score["walls"]["recall"]["5cm"]),
    ("room IoU", lambda r: r.score["rooms"]["room_iou"]),
)


def table(runs: dict[str, list[Run]], columns: Sequence[tuple[str, Cell]]) -> str:
    """Markdown: a row per area, medians over its runs."""
    lines = ["| area | " + " | ".join(name for name, _ in columns) + " |", "|" + " --- |" * (len(columns) + 1)]
    for area, done in runs.items():
        cells = [f"{median(cell(r) for r in done):.4g}" for _, cell in columns]
        lines.append(f"| {area} | " + " | ".join(cells) + " |")
    return "\n".join(lines) + "\n"


def main() -> None:
    """The command."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("folder", type=Path, help="where the scans and work folders go, and stay")
    parser.add_argument("--seeds", type=int, nargs="+", default=[1, 2, 3, 4, 5])
    parser.add_argument("--areas", nargs="+", default=list(AREAS), choices=AREAS)
    asked = parser.parse_args()
    runs: dict[str, dict[str, list[Run]]] = {method: {} for method in METHODS}
    for area in asked.areas:
        for seed in asked.seeds:
            scan = scan_of(asked.folder, area, seed)
            for method in METHODS:
                runs[method].setdefault(area, []).append(run(scan, asked.folder / f"{scan.name}.work", method))
                sys.stderr.write(f"{scan.name} {method}\n")
    for method, of_area in runs.items():
        drift, scores = table(of_area, DRIFT_COLUMNS), table(of_area, SCORE_COLUMNS)
        sys.stdout.write(f"\n{method}, medians over seeds {asked.seeds}\n\n{drift}\n{scores}")


if __name__ == "__main__":
    main()
