"""What would make a scan better: a measured fact and what to do about it."""

from dataclasses import dataclass


@dataclass(frozen=True)
class Advice:
    """One piece of advice: a short `code`, the `fact` that was measured, and what to do next time, or now."""

    code: str
    fact: str
    advice: str

    def __str__(self) -> str:
        return f"{self.fact}: {self.advice}"
