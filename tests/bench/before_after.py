"""Two plans of one simulated scan beside each other: `python -m tests.bench.before_after SCAN WORK WORK OUT.png`.

True wall faces grey, the plan's seen faces black where they lie within 5 cm of a true one, red elsewhere, the path blue.
"""

import argparse
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from tests.bench.score_input import Case, load_case
from tests.bench.score_walls import span_scores, wall_scores

NEAR_M = 0.05
PIECE_M = 0.05
INCHES, DPI = (11.0, 5.6), 90


def draw(ax: Axes, case: Case, title: str) -> None:
    """One plan over the truth."""
    for face in case.truth["faces"]:
        ax.plot(*_true_ends(face).T, color="0.8", lw=2.5, zorder=1)
    for face in case.plan["faces"]:
        if face["certainty"] != "seen":
            continue
        ends = case.placement.xy([face["start"], face["end"]])
        off = _distance_m(ends, case.truth["faces"]) > NEAR_M
        ax.plot(*ends.T, color="red" if off else "black", lw=1.4, zorder=3 if off else 2)
    ax.plot(*case.path_plan_m[:, :2].T, color="tab:blue", lw=0.5)
    scores = wall_scores(case)["precision"]["5cm"], 100 * span_scores(case)["mean_relative"]
    ax.set_title(f"{title}: {100 * scores[0]:.1f} % of the walls within 5 cm,\nwall to wall off by {scores[1]:.2f} % (mean)", fontsize=9)
    ax.set_aspect("equal")
    ax.axis("off")


def _true_ends(face: dict[str, Any]) -> np.ndarray:
    """Ends (2, 2) of a true face in plan."""
    ends = np.empty((2, 2))
    ends[:, face["axis"]] = face["offset"]
    ends[:, 1 - face["axis"]] = face["start"], face["end"]
    return ends


def _distance_m(ends: np.ndarray, faces: list[dict[str, Any]]) -> float:
    """Median over the pieces of a drawn face of the distance to the nearest true face along its axis."""
    axis = int(np.abs(ends[1] - ends[0]).argmin())
    along = np.linspace(ends[0, 1 - axis], ends[1, 1 - axis], max(2, round(float(np.abs(ends[1] - ends[0]).max()) / PIECE_M)))
    best = np.full(len(along), np.inf)
    for face in faces:
        if face["axis"] == axis:
            inside = (along > face["start"] - PIECE_M) & (along < face["end"] + PIECE_M)
            best[inside] = np.minimum(best[inside], abs(face["offset"] - ends[:, axis].mean()))
    return float(np.median(best))


def main() -> None:
    """The picture."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("scan", type=Path)
    parser.add_argument("published", type=Path, help="work folder of the published method")
    parser.add_argument("default", type=Path, help="work folder of the default one")
    parser.add_argument("out", type=Path)
    asked = parser.parse_args()
    figure = Figure(figsize=INCHES, layout="compressed")
    for ax, work, title in zip(figure.subplots(1, 2), (asked.published, asked.default), ("published", "default"), strict=True):
        draw(ax, load_case(asked.scan, work), title)
    figure.savefig(asked.out, dpi=DPI)


if __name__ == "__main__":
    main()
