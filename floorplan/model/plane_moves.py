"""What the evidence merge changed once everything was merged, and how its two candidates compared."""

from dataclasses import dataclass


@dataclass(frozen=True)
class PlaneMove:
    """One change that the evidence of the whole asked for: `tracks` were cut off the plane of track `source` and went to that of
    `target`, or are a plane of their own; `joined` so many planes became one with others besides. `log_evidence` gained.

    `source` is None where nothing was cut and planes were joined alone, `target` where what was cut stands alone.
    """

    tracks: tuple[int, ...]
    source: int | None
    target: int | None
    joined: int
    log_evidence: float


@dataclass(frozen=True)
class AxisChoice:
    """The second candidate on one axis (0, 1, 2) where it was asked and differed: log evidence of all planes of the axis' system with the

    planes of the best-first search, and with this axis' planes of the second candidate, each after its moves; by how much less the
    second's chi-square is, how much of that choosing between more planes explains, and whether it was `taken`.
    """

    axis: int
    first_log_evidence: float
    second_log_evidence: float
    chi_square_less: float
    chi_square_by_choosing: float
    taken: bool


@dataclass(frozen=True)
class Changes:
    """All of both."""

    moves: tuple[PlaneMove, ...]
    choices: tuple[AxisChoice, ...]
