"""What the evidence merge changed once everything was merged."""

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
