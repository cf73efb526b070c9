"""`floorplan merges`."""

from dataclasses import asdict
from typing import TYPE_CHECKING, Annotated

import typer

from floorplan.cli import options as o
from floorplan.cli.console import echo_json, echo_table

if TYPE_CHECKING:
    from floorplan.merge_table import MergeRow
    from floorplan.model.plane_moves import AxisChoice, PlaneMove

NAMED_FRAMES = 4  # as many are listed in the table; --json has all
CHANGES = ("tracks", "from", "to", "planes joined", "log evidence gained")
CHOICES = ("axis", "log evidence best first", "with L1 on this axis", "chi2 less (by choosing)", "taken")
AXIS_NAMES = ("x", "y", "z")
HEADER = ("tracks", "axis", "distance", "solved", "sigma", "chi2", "verdict", "seen in frames", "both in one frame")


Changes = Annotated[bool, typer.Option("--changes", help="Only what changed once all was merged, and both candidates, with log evidence.")]


def merges(work: o.Work, changes: Changes = False, as_json: o.AsJson = False) -> None:
    """Every hypothesis accepted or rejected, with its numbers and the frames that saw it."""
    from floorplan.export import read_changes, read_merges

    if changes:
        found = read_changes(work)
        if as_json:
            echo_json(asdict(found))
        else:
            echo_table([CHANGES, *(_change(move) for move in found.moves)])
            echo_table([CHOICES, *(_choice(choice) for choice in found.choices)])
        return
    rows = read_merges(work)
    if as_json:
        echo_json([asdict(row) for row in rows])
    else:
        echo_table([HEADER, *(_cells(row) for row in rows)])


def _change(move: "PlaneMove") -> tuple[str, ...]:
    tracks = ", ".join(map(str, move.tracks)) or "none"
    source = "" if move.source is None else f"the plane of {move.source}"
    target = "" if not move.tracks else "a plane of their own" if move.target is None else f"the plane of {move.target}"
    return (tracks, source, target, str(move.joined), f"{move.log_evidence:.1f}")


def _choice(choice: "AxisChoice") -> tuple[str, ...]:
    axis, winner = AXIS_NAMES[choice.axis], "L1" if choice.taken else "best first"
    less = f"{choice.chi_square_less:.1f} ({choice.chi_square_by_choosing:.1f})"
    return (axis, f"{choice.first_log_evidence:.1f}", f"{choice.second_log_evidence:.1f}", less, winner)


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
