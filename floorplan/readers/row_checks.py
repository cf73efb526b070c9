"""Rows that can be used: poses that are numbers, stamps in order and each once. What is left out is counted."""

from dataclasses import dataclass

import numpy as np

from floorplan.model.checks import Array
from floorplan.model.scan import Problem
from floorplan.readers.pose_table import MISSING_STAMP_NS, PoseTable

FEWEST_ROWS, ALIKE_SHARE = 10, 0.1  # of so many rows, hardly any with a stamp of its own: they have none


@dataclass(frozen=True)
class UsableRows:
    """`index (N,)` rows of the table in time order, each stamp once; and the problems met."""

    index: Array
    problems: tuple[Problem, ...]


def usable_rows(table: PoseTable, where: str, first_line: int = 1) -> UsableRows:
    """The rows of `table` that have a pose and a stamp of their own, sorted by time.

    `where` names the file and `first_line` the line of row 0, for the messages.
    """
    problems: list[Problem] = []
    valid = table.valid
    if not valid.all():
        row = int(np.argmin(valid))
        advice = "these frames are left out; the odometry was probably lost there"
        problems.append(Problem("pose-missing", "poses missing or not numbers", _line(where, row, first_line), int((~valid).sum()), advice))
    index = np.flatnonzero(valid)
    steps = np.diff(table.stamp_ns[index])
    if (steps < 0).any():
        row = int(index[np.argmax(steps < 0) + 1])
        advice = "rows are sorted by time; check that this is one recording"
        problems.append(Problem("stamp-unsorted", "stamps go back in time", _line(where, row, first_line), int((steps < 0).sum()), advice))
    index = index[np.argsort(table.stamp_ns[index], kind="stable")]
    doubled = np.concatenate([[False], np.diff(table.stamp_ns[index]) == 0])[: len(index)]  # of no rows, none
    if doubled.any():
        row = int(index[np.argmax(doubled)])
        lost = len(index) >= FEWEST_ROWS and (~doubled).sum() <= ALIKE_SHARE * len(index)
        advice = "stamps were lost or rounded off: write one per frame" if lost else "the first row of each stamp is kept"
        place = _line(where, row, first_line)
        problems.append(Problem("stamp-doubled", "stamps occur more than once", place, int(doubled.sum()), advice, fatal=bool(lost)))
    return UsableRows(index[~doubled], tuple(problems))


def pose_gaps(stamp_ns: Array, known: Array, where: str) -> tuple[Problem, ...]:
    """What to say of frames at `stamp_ns (N,)` whose pose is not `known (N,)`: how many, and the longest time without one."""
    if known.all():
        return ()
    order = np.argsort(stamp_ns, kind="stable")
    times = stamp_ns[order] * 1e-9
    posed = np.flatnonzero(known[order])
    edges = np.unique(np.concatenate([[0], posed, [len(order) - 1]]))
    missing = np.diff(edges) > 1
    longest = float(np.diff(times[edges])[missing].max(initial=0.0))
    first = stamp_text(int(stamp_ns[order][np.argmin(known[order])]))
    message = f"frames without a pose at their time; the longest stretch lasts {longest:.1f} s"
    advice = "these frames are left out; record the poses over the same time"
    return (Problem("pose-gap", message, f"{where}, {first}", int((~known).sum()), advice),)


def stamp_text(stamp_ns: int) -> str:
    """A stamp for messages, seconds."""
    return "no stamp" if stamp_ns == MISSING_STAMP_NS else f"{stamp_ns * 1e-9:.6f} s"


def span_text(stamp_ns: Array) -> str:
    """First and last stamp (N,) for messages."""
    return f"{stamp_text(int(stamp_ns[0]))} to {stamp_text(int(stamp_ns[-1]))}"


def _line(where: str, row: int, first_line: int) -> str:
    return f"{where}, row {row + first_line}"
