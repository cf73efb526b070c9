"""Score a built plan against a simulated scan's truth: `python -m tests.bench.score SCAN WORK --json`."""

import argparse
import json
import sys
from pathlib import Path
from typing import Any

import numpy as np

from tests.bench.score_input import Case, load_case
from tests.bench.score_rooms import door_scores, room_scores, width_scores
from tests.bench.score_walls import dimension_scores, span_scores, thickness_scores, wall_scores


def score(scan: Path, work: Path) -> dict[str, Any]:
    """All metrics of one plan; None where there is nothing to measure. Metres and shares."""
    case = load_case(scan, work)
    return {
        "preset": case.truth["preset"],
        "seed": case.truth["seed"],
        "path_m": case.truth["path_length_m"],
        "walls": wall_scores(case),
        "rooms": room_scores(case),
        "spans": span_scores(case),
        "doors": door_scores(case),
        "widths": width_scores(case),
        "trajectory": trajectory_scores(case),
        "thickness": thickness_scores(case),
        "dimensions": dimension_scores(case),
    }


def trajectory_scores(case: Case) -> dict[str, Any]:
    """Mean and largest position error after placement; error of the vector from start to end."""
    error = np.linalg.norm(case.path_plan_m - case.path_true_m, axis=1)
    plan, true = case.path_plan_m, case.path_true_m
    ends = (plan[-1] - plan[0]) - (true[-1] - true[0])
    return {
        "frames": len(plan),
        "mean_m": float(error.mean()),
        "max_m": float(error.max()),
        "start_to_end_m": float(np.linalg.norm(ends)),
    }


def main() -> None:
    """The command."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("scan", type=Path, help="simulated scan with its truth.json")
    parser.add_argument("work", type=Path, help="work folder with plan.json and trajectory.tum")
    parser.add_argument("--json", action="store_true", help="machine-readable")
    arguments = parser.parse_args()
    result = score(arguments.scan, arguments.work)
    sys.stdout.write(json.dumps(result) + "\n" if arguments.json else as_text(result))


def as_text(result: dict[str, Any]) -> str:
    """One line per metric."""
    lines = []
    for name, value in result.items():
        for key, number in value.items() if isinstance(value, dict) else [("", value)]:
            lines.append(f"{name:12s} {key:24s} {_short(number)}")
    return "\n".join(lines) + "\n"


def _short(number: Any) -> str:
    if isinstance(number, dict):
        return "  ".join(f"{key} {_short(value)}" for key, value in number.items())
    return f"{number:.4f}" if isinstance(number, float) else str(number)


if __name__ == "__main__":
    main()
