"""Timed poses as text files hold them, and poses at other times by interpolation."""

from dataclasses import dataclass
from decimal import Decimal, InvalidOperation
from pathlib import Path

import numpy as np

from floorplan.errors import InputError
from floorplan.geometry import rotation_from_quat_xyzw
from floorplan.model.checks import Array, freeze

MISSING_STAMP_NS = np.iinfo(np.int64).min  # a stamp that could not be read


@dataclass(frozen=True)
class PoseTable:
    """Poses as read, N rows: `stamp_ns (N,)`, `position_m (N, 3)`, `quat_xyzw (N, 4)`; NaN where unreadable."""

    stamp_ns: Array
    position_m: Array
    quat_xyzw: Array

    def __post_init__(self) -> None:
        freeze(self, {"stamp_ns": (np.int64, ("N",)), "position_m": (np.float64, ("N", 3)), "quat_xyzw": (np.float64, ("N", 4))})

    def __len__(self) -> int:
        return len(self.stamp_ns)

    @property
    def valid(self) -> Array:
        """Boolean (N,): stamp, position and rotation are all numbers, and the quaternion is one."""
        norm = np.linalg.norm(self.quat_xyzw, axis=1)
        finite = np.isfinite(self.position_m).all(axis=1) & np.isfinite(norm)
        return np.asarray(finite & (norm > 0.1) & (self.stamp_ns != MISSING_STAMP_NS))  # a unit quaternion, badly rounded at worst

    def rows(self, index: Array) -> "PoseTable":
        """The given rows, in that order."""
        return PoseTable(self.stamp_ns[index], self.position_m[index], self.quat_xyzw[index])


def stamp_ns_from_text(text: str) -> int:
    """Nanoseconds of a stamp in seconds, without the rounding of binary fractions; MISSING_STAMP_NS when it is no number."""
    try:
        stamp = Decimal(text.strip())
    except InvalidOperation:
        return int(MISSING_STAMP_NS)
    return int(stamp.scaleb(9).to_integral_value()) if stamp.is_finite() else int(MISSING_STAMP_NS)


def number_from_text(text: str) -> float:
    """The number, or NaN when the text is none."""
    try:
        return float(text)
    except ValueError:
        return float("nan")


def text_lines(path: Path) -> list[str]:
    """Lines of a text file without comments (#) and blank ones. Raises `InputError` when it cannot be read as text."""
    try:
        text = path.read_text(encoding="utf-8-sig", errors="replace")
    except OSError as error:
        raise InputError(f"{path}: cannot be read ({error.strerror})") from error
    return [line for line in text.splitlines() if line.strip() and not line.lstrip().startswith("#")]


def read_tum_trajectory(path: Path) -> PoseTable:
    """A trajectory of lines `stamp tx ty tz qx qy qz qw`; a row that cannot be read is NaN."""
    cells = [line.replace(",", " ").split() for line in text_lines(path)]
    numbers = np.array([[number_from_text(cell) for cell in (row[1:8] + ["nan"] * 7)[:7]] for row in cells]).reshape(-1, 7)
    return PoseTable(np.array([stamp_ns_from_text(row[0]) for row in cells], dtype=np.int64), numbers[:, :3], numbers[:, 3:])


@dataclass(frozen=True)
class Interpolated:
    """Poses at asked-for times, N rows: `position_m (N, 3)`, `rotation (N, 3, 3)`; `known (N,)` False where none could be had."""

    position_m: Array
    rotation: Array
    known: Array


def interpolate(table: PoseTable, stamp_ns: Array, max_gap_s: float) -> Interpolated:
    """Poses of `table` (sorted, valid, without doubles) at `stamp_ns (N,)`: linear, spherical for rotations.

    Not known where the neighbours are further than `max_gap_s` apart, and outside the table by more than half its
    usual step (within that, the first or last pose stands).
    """
    time = (np.asarray(stamp_ns) - table.stamp_ns[0]) * 1e-9
    knots = (table.stamp_ns - table.stamp_ns[0]) * 1e-9
    after = np.clip(np.searchsorted(knots, time), 1, max(len(knots) - 1, 1))
    if len(knots) == 1:
        after = np.zeros(len(time), dtype=int)
    before = np.maximum(after - 1, 0)
    step = knots[after] - knots[before]
    share = np.clip(np.divide(time - knots[before], step, out=np.zeros(len(time)), where=step > 0), 0.0, 1.0)
    position = table.position_m[before] * (1 - share[:, None]) + table.position_m[after] * share[:, None]
    slack = 0.5 * float(np.median(np.diff(knots))) if len(knots) > 1 else 0.5 * max_gap_s
    on_knot = (share == 0) | (share == 1)
    known = (time >= -slack) & (time <= knots[-1] + slack) & ((step <= max_gap_s) | on_knot)
    return Interpolated(position, rotation_from_quat_xyzw(_slerp(table.quat_xyzw[before], table.quat_xyzw[after], share)), known)


def _slerp(first: Array, second: Array, share: Array) -> Array:
    first = first / np.linalg.norm(first, axis=1, keepdims=True)
    second = second / np.linalg.norm(second, axis=1, keepdims=True)
    cosine = np.einsum("ij,ij->i", first, second)
    second = np.where(cosine[:, None] < 0, -second, second)
    angle = np.arccos(np.clip(np.abs(cosine), 0.0, 1.0))
    sine = np.sin(angle)
    small = sine < 1e-6  # the chord is the arc there
    safe = np.where(small, 1.0, sine)
    a = np.where(small, 1 - share, np.sin((1 - share) * angle) / safe)
    b = np.where(small, share, np.sin(share * angle) / safe)
    return np.asarray(a[:, None] * first + b[:, None] * second)
