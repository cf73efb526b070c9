"""What a sheet says about the scan it was made from: the writers' input beside the plan itself."""

from dataclasses import dataclass


@dataclass(frozen=True)
class FactRow:
    """One line of a table of facts, already worded: what, how much."""

    label: str
    value: str


@dataclass(frozen=True)
class SheetFacts:
    """Scan name, date of the recording (ISO, empty when unknown), software and the numbers of the accuracy statement.

    `software` is name and version. `drift_m` is the distance from start to end after the last stage, where the
    walk returned to its start; `path_m` the length walked. `rows`, `problems`, `calibration` (empty: none) and the unseen parts are
    worded by the caller.
    """

    scan: str = ""
    date: str = ""
    software: str = ""
    frames: int | None = None
    path_m: float | None = None
    drift_m: float | None = None
    rows: tuple[FactRow, ...] = ()
    problems: tuple[str, ...] = ()
    calibration: str = ""
    unseen: tuple[str, ...] = ()
