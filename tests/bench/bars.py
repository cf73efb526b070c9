"""Plans against the bars of docs/benchmarks.md: `python -m tests.bench.bars SCAN WORK [SCAN WORK ...] [--hard]`.

Scores every built plan against its scan's truth and prints one row per bar: what is asked, the mean over the plans, the worst.
"""

import argparse
import sys
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from tests.bench.score import score

Score = dict[str, Any]


@dataclass(frozen=True)
class Bar:
    """One quantity of a score with what is asked of it on clean and on hard scans (None: nothing); `least`: more is better."""

    name: str
    value: Callable[[Score], float | None]
    clean: float
    hard: float | None
    least: bool = False

    def asked(self, hard: bool) -> float | None:
        """The bar for one kind of scan."""
        return self.hard if hard else self.clean

    def holds(self, value: float, asked: float | None) -> bool:
        """Whether a value reaches what is asked."""
        return asked is None or (value >= asked if self.least else value <= asked)


def _share(section: str, tolerance: str) -> Callable[[Score], float | None]:
    return lambda s: s["walls"][section][tolerance]


BARS = (
    Bar("drawn on a true face, 3 cm", _share("precision", "3cm"), 0.97, None, least=True),
    Bar("drawn on a true face, 5 cm", _share("precision", "5cm"), 0.98, 0.80, least=True),
    Bar("drawn on a true face, 10 cm", _share("precision", "10cm"), 0.99, 0.98, least=True),
    Bar("seen wall drawn, 3 cm", _share("recall", "3cm"), 0.94, None, least=True),
    Bar("seen wall drawn, 5 cm", _share("recall", "5cm"), 0.96, 0.75, least=True),
    Bar("seen wall drawn, 10 cm", _share("recall", "10cm"), 0.97, 0.95, least=True),
    Bar("room IoU, visited", lambda s: s["rooms"]["room_iou"], 0.97, 0.95, least=True),
    Bar("corridor IoU", lambda s: s["rooms"]["corridor_iou"], 0.95, 0.90, least=True),
    Bar("false rooms per plan", lambda s: s["rooms"]["false_rooms"], 0.25, 0.5),
    Bar("room area error", lambda s: s["rooms"]["area_error"], 0.007, 0.015),
    Bar("wall-to-wall, mean", lambda s: s["spans"]["mean_relative"], 0.002, 0.005),
    Bar("wall-to-wall, 95th percentile, m", lambda s: s["spans"]["p95_m"], 0.015, 0.050),
    Bar("wall-to-wall over 5 m, mean", lambda s: s["spans"]["long_mean_relative"], 0.002, 0.006),
    Bar("wall-to-wall not found or 0.5 m off", lambda s: s["spans"]["missed"], 0.03, 0.08),
    Bar("doors walked through found", lambda s: s["doors"]["found"], 0.95, 0.90, least=True),
    Bar("doors drawn that are none", lambda s: s["doors"]["false"], 0.02, 0.04),
    Bar("door width error, m", lambda s: s["doors"]["width_error_m"], 0.020, 0.040),
    Bar("trajectory, mean, m", lambda s: s["trajectory"]["mean_m"], 0.02, 0.06),
    Bar("trajectory, start to end, m", lambda s: s["trajectory"]["start_to_end_m"], 0.03, 0.10),
    Bar("wall thickness, mean, m", lambda s: s["thickness"]["mean_error_m"], 0.005, 0.012),
)


def table(scores: Sequence[tuple[str, Score]], hard: bool) -> str:
    """Markdown: a row per bar with its mean over the plans, whether that holds, and the worst plan."""
    lines = ["| what | bar | mean | holds | worst | plans that miss it |", "| --- | --- | --- | --- | --- | --- |"]
    for bar in BARS:
        found = [(value, name) for name, one in scores if (value := bar.value(one)) is not None]
        if not found:
            continue
        mean = sum(value for value, _ in found) / len(found)
        worst, where = (min if bar.least else max)(found)
        asked = bar.asked(hard)
        missing = " ".join(name for value, name in found if not bar.holds(value, asked))
        cells = (bar.name, "-" if asked is None else f"{asked:g}", f"{mean:.4f}", "yes" if bar.holds(mean, asked) else "NO")
        lines.append(f"| {' | '.join(cells)} | {worst:.4f} {where} | {missing} |")
    return "\n".join(lines) + "\n"


def main() -> None:
    """The command."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("folders", type=Path, nargs="+", help="SCAN WORK, SCAN WORK, ...")
    parser.add_argument("--hard", action="store_true", help="the bars for hard scans")
    asked = parser.parse_args()
    if len(asked.folders) % 2:
        parser.error("give a work folder for every scan: SCAN WORK SCAN WORK ...")
    scores = [(scan.name, score(scan, work)) for scan, work in zip(asked.folders[::2], asked.folders[1::2], strict=True)]
    sys.stdout.write(table(scores, asked.hard))


if __name__ == "__main__":
    main()
