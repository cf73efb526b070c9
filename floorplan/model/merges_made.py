"""The merges that made the planes, and how surely each was right."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from floorplan.model.checks import Array, freeze


@dataclass(frozen=True)
class MergesMade:
    """E merges in the order they were made, a tree on the tracks of each plane: `first (E,)`, `second (E,)` tracks that were asked about.

    `log_odds (E,)` of being one plane when it was decided; `slack_m (E,)` root mean square of the distance that may yet be
    between the two sides.
    """

    first: Array
    second: Array
    log_odds: Array
    slack_m: Array

    def __post_init__(self) -> None:
        whole, real = (np.int64, ("E",)), (np.float64, ("E",))
        freeze(self, {"first": whole, "second": whole, "log_odds": real, "slack_m": real})

    def __len__(self) -> int:
        return len(self.first)

    def only(self, kept: Array) -> "MergesMade":
        """The merges of the boolean or index array `kept`."""
        return MergesMade(self.first[kept], self.second[kept], self.log_odds[kept], self.slack_m[kept])


def join_merges(parts: Sequence[MergesMade]) -> MergesMade:
    """All parts in one table."""
    empty: list[Array] = [np.zeros(0)]
    names = ("first", "second", "log_odds", "slack_m")
    return MergesMade(*(np.concatenate([getattr(part, name) for part in parts] or empty) for name in names))
