"""`--tolerance`: what a checked distance may be off by."""

import re
from dataclasses import dataclass

from floorplan.errors import CheckFailedError, UsageError
from floorplan.laser.compare import Check

BARE_BELOW_M = 1.0  # a number without a unit from here on is hardly meant in metres
LENGTHS_M = {"": 1.0, "m": 1.0, "cm": 0.01, "mm": 0.001}


@dataclass(frozen=True)
class Tolerance:
    """A length in metres, or a share of the measured distance in per cent; `text` as it was given."""

    value: float
    relative: bool
    text: str

    def __str__(self) -> str:
        return f"{self.value:g} %" if self.relative else f"{1000 * self.value:g} mm"


def parse_tolerance(text: str) -> Tolerance:
    """`15mm`, `0.015m` or `1%`; a bare number below 1 is metres. Raises UsageError for anything else."""
    found = re.fullmatch(r"(\d+\.?\d*|\.\d+)\s*(%|[a-z]*)", text.strip().lower().replace(",", "."))
    if found is None or (found[2] != "%" and found[2] not in LENGTHS_M):
        raise UsageError(f"--tolerance {text}: give a length like 15mm or 0.015 (metres), or a percentage like 1%")
    if not found[2] and float(found[1]) >= BARE_BELOW_M:
        raise UsageError(f"--tolerance {text}: {found[1]} of what? Write {found[1]}mm, {found[1]}% or {found[1]}m")
    relative = found[2] == "%"
    return Tolerance(float(found[1]) * (1.0 if relative else LENGTHS_M[found[2]]), relative, text.strip())


def enforce(check: Check, tolerance: Tolerance) -> None:
    """Raise CheckFailedError when a compared distance is off by more, or a measured one could not be compared: that proves nothing."""
    beyond = [row for row in check.rows if (abs(row.percent) if tolerance.relative else abs(row.difference_m)) > tolerance.value]
    if beyond:
        worst = max(beyond, key=lambda row: abs(row.percent) if tolerance.relative else abs(row.difference_m))
        raise CheckFailedError(
            f"{len(beyond)} of {len(check.rows)} distances are off by more than {tolerance}; the worst is {worst.id}, "
            f"{1000 * worst.difference_m:+.0f} mm ({worst.percent:+.2f} %); measure it again, then look at 'floorplan merges' or rescan"
        )
    if check.bad:
        lines = ", ".join(str(row.line) for row in check.bad)
        raise CheckFailedError(
            f"{len(check.bad)} of {len(check.bad) + len(check.rows)} measured rows could not be compared (line {lines}), so the tolerance "
            "is not proven; mend these rows, or take them out"
        )
