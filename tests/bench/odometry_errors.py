"""Position error of whole builds against the odometry's error: `python -m tests.bench.odometry_errors FOLDER --seeds 1 2`.

Per seed one building of 150 m of walk is simulated into FOLDER (kept, if it is there), with the depth frames of one walk under
odometry of 0, 2 and 5 % error, so the columns differ in nothing else. Frames at 5 Hz.
"""

import argparse
import os
import sys
from dataclasses import dataclass
from pathlib import Path
from statistics import fmean

from floorplan.build import Job, build
from floorplan.simulate import simulate
from floorplan.simulate.scene import draw_scene
from floorplan.simulate.simulate import odometry_of
from floorplan.simulate.write_tum import write_odometry
from tests.bench.score import score

ERRORS = (0.0, 0.02, 0.05)
BARS_M = (0.01, 0.02, 0.04)  # mean position error to be reached
RATE_HZ = 5.0
ODOMETRY_STREAM = 79  # as `simulate` draws it
# Two rings side by side, or one: both scaled to 150 m. Seeds alternate.
BUILDINGS = (("area2", 150 / 200), ("area5", 150 / 113))


@dataclass(frozen=True)
class Outcome:
    """One build: mean and largest position error after placement, and of the vector from start to end, metres."""

    scan: str
    mean_m: float
    max_m: float
    start_to_end_m: float


def scans_of(folder: Path, seed: int) -> list[Path]:
    """The scans of one seed, one per error, made where they are missing; all but the first share its depth images."""
    preset, path_scale = BUILDINGS[seed % len(BUILDINGS)]
    scans = [folder / f"{preset}-{seed}-{100 * error:.0f}" for error in ERRORS]
    if not (scans[0] / "truth.json").is_file():
        simulate(scans[0], preset, seed, path_scale=path_scale, rate_hz=RATE_HZ, odometry_error=ERRORS[0])
    scene = draw_scene(preset, seed, path_scale=path_scale, rate_hz=RATE_HZ)
    for scan, error in zip(scans[1:], ERRORS[1:], strict=True):
        if (scan / "odometry.txt").is_file():
            continue
        for file in sorted(f for f in scans[0].rglob("*") if f.is_file() and f.name != "odometry.txt"):
            copy = scan / file.relative_to(scans[0])
            copy.parent.mkdir(parents=True, exist_ok=True)
            os.link(file, copy)
        write_odometry(scan, scene.walk, odometry_of(scene, [seed, ODOMETRY_STREAM], False, error))
    return scans


def run(scan: Path) -> Outcome:
    """Build one scan with the default settings and score its trajectory."""
    work = scan.with_suffix(".work")
    build(Job(scan, work))
    path = score(scan, work)["trajectory"]
    return Outcome(scan.name, path["mean_m"], path["max_m"], path["start_to_end_m"])


def main() -> None:
    """One line per build, then a table of means."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folder", type=Path, help="where the scans and work folders go, and stay")
    parser.add_argument("--seeds", type=int, nargs="+", default=list(range(1, 11)))
    parser.add_argument("--simulate-only", action="store_true", help="make the scans, build nothing")
    asked = parser.parse_args()
    outcomes: dict[float, list[Outcome]] = {error: [] for error in ERRORS}
    for seed in asked.seeds:
        for error, scan in zip(ERRORS, scans_of(asked.folder, seed), strict=True):
            if asked.simulate_only:
                continue
            outcomes[error].append(run(scan))
            last = outcomes[error][-1]
            sys.stdout.write(f"{last.scan} mean {last.mean_m:.4f} max {last.max_m:.4f} start to end {last.start_to_end_m:.4f}\n")
            sys.stdout.flush()
    if not asked.simulate_only:
        sys.stdout.write(_table(outcomes))


def _table(outcomes: dict[float, list[Outcome]]) -> str:
    lines = ["| odometry error | mean position error m | worst build m | largest error m | start to end m | bar m |", "|" + " --- |" * 6]
    for (error, done), bar_m in zip(outcomes.items(), BARS_M, strict=True):
        mean, worst = fmean(o.mean_m for o in done), max(o.mean_m for o in done)
        largest, ends = max(o.max_m for o in done), fmean(o.start_to_end_m for o in done)
        lines.append(f"| {100 * error:.0f} % | {mean:.4f} | {worst:.4f} | {largest:.4f} | {ends:.4f} | {bar_m} |")
    return "\n".join(lines) + "\n"


if __name__ == "__main__":
    main()
