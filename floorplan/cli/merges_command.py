"""`floorplan merges`."""

from dataclasses import asdict
from typing import TYPE_CHECKING

from floorplan.cli import options as o
from floorplan.cli.console import echo_json, echo_table

if TYPE_CHECKING:
    from floorplan.merge_table import MergeRow

NAMED_FRAMES = 4  # as many are listed in the table; --json has all
HEADER = ("tracks", "axis", "distance", "solved", "sigma", "chi2", "verdict", "seen in frames", "both in one frame")


def merges(work: o.Work, as_json: o.AsJson = False) -> None:
    """Every hypothesis accepted or rejected, with its numbers and the frames that saw it."""
    from floorplan.export import read_merges

    rows = read_merges(work)
    if as_json:
        echo_json([asdict(row) for row in rows])
    else:
        echo_table([HEADER, *(_cells(row) for row in rows)])


def _cells(row: "MergeRow") -> tuple[str, ...]:
    sides = (row.first, row.second)
    frames = row.frames_of_both
    more = f" and {len(frames) - NAMED_FRAMES} more" if len(frames) > NAMED_FRAMES else ""
    return (
        f"{row.first.track} = {row.second.track}",
        f"{row.axis}{'+' if row.facing > 0 else '-'}",
        f"{row.distance_m:.3f} m",
        f"{row.solved_distance_m:.3f} m",
        "" if row.sigma_m is None else f"{row.sigma_m:.4f} m",
        "" if row.chi_square is None else f"{row.chi_square:.1f}",
        row.verdict,
        ", ".join(f"{s.first_frame}-{s.last_frame} ({s.keyframes}x)" for s in sides),
        (", ".join(map(str, frames[:NAMED_FRAMES])) + more) or "none",
    )
