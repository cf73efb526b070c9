"""What already stands on the drawing, as weighted boxes, and what a new text would cost where it is tried."""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass

import numpy as np

from floorplan.model.checks import Array
from floorplan.model.plan import Point

TEXT_WEIGHT = 100.0  # text over text is unreadable
STAMP_WEIGHT = 12.0  # before stamps have their final place
WALL_WEIGHT = 30.0  # text over a wall line
SYMBOL_WEIGHT = 15.0  # text over a door swing
LINE_WEIGHT = 20.0  # text over a thin line
ENDS_SHARE = 0.1  # of a dimension line, at either end: there it meets its walls


@dataclass(frozen=True)
class Rectangle:
    """An axis-aligned box in the plan frame, metres."""

    x0: float
    y0: float
    x1: float
    y1: float

    @classmethod
    def around(cls, points: Iterable[Point], grow: float = 0.0) -> "Rectangle":
        xs, ys = zip(*points, strict=True)
        return cls(min(xs) - grow, min(ys) - grow, max(xs) + grow, max(ys) + grow)

    @classmethod
    def centred(cls, centre: Point, width: float, height: float) -> "Rectangle":
        return cls(centre[0] - width / 2, centre[1] - height / 2, centre[0] + width / 2, centre[1] + height / 2)

    def holds(self, other: "Rectangle") -> bool:
        """Whether `other` lies inside."""
        return self.x0 <= other.x0 and self.y0 <= other.y0 and other.x1 <= self.x1 and other.y1 <= self.y1

    def joined(self, others: "Iterable[Rectangle]") -> "Rectangle":
        """The box around this one and all others."""
        return Rectangle.around(corner for box in (self, *others) for corner in ((box.x0, box.y0), (box.x1, box.y1)))

    def moved(self, x: float, y: float) -> "Rectangle":
        return Rectangle(self.x0 + x, self.y0 + y, self.x1 + x, self.y1 + y)

    def grown(self, by: float) -> "Rectangle":
        """Larger by as much on every side."""
        return Rectangle(self.x0 - by, self.y0 - by, self.x1 + by, self.y1 + by)


class Occupancy:
    """A growing list of weighted boxes; `cost` is the summed weight of those a box overlaps."""

    def __init__(self) -> None:
        self._boxes: list[tuple[float, float, float, float]] = []
        self._weights: list[float] = []
        self._arrays: tuple[Array, Array] | None = None

    def add(self, box: Rectangle, weight: float) -> None:
        self._boxes.append((box.x0, box.y0, box.x1, box.y1))
        self._weights.append(weight)
        self._arrays = None

    def touches(self, point: Point, weight: float) -> bool:
        """Whether a box of that weight lies under the point."""
        return any(
            w == weight and b[0] <= point[0] <= b[2] and b[1] <= point[1] <= b[3] for b, w in zip(self._boxes, self._weights, strict=True)
        )

    def cost(self, box: Rectangle, at_least: float = 0.0) -> float:
        """Summed weight of the boxes that `box` overlaps, of those that weigh `at_least` so much."""
        taken, weights = self._table()
        return float(weights[_overlap(taken, box) & (weights >= at_least)].sum())

    def free(self, boxes: Sequence[Rectangle], at_least: float) -> Array:
        """Which (M,) of `boxes` overlap nothing that weighs `at_least` so much."""
        taken, weights = self._table()
        return np.asarray(~_overlaps(boxes, taken[:, weights >= at_least]).any(axis=1))

    def costs(self, boxes: Sequence[Rectangle]) -> Array:
        """`cost` of each (M,) of `boxes`."""
        taken, weights = self._table()
        return np.asarray(_overlaps(boxes, taken) @ weights)

    def covered_share(self, box: Rectangle, axis: int, weight: float) -> float:
        """Share of the length of `box` along `axis` that boxes of that weight cover, but for its ends, which may touch walls."""
        taken, weights = self._table()
        low, high = (box.x0, box.x1) if axis == 0 else (box.y0, box.y1)
        shrink = ENDS_SHARE * (high - low)
        low, high = low + shrink, high - shrink
        over = taken[:, _overlap(taken, box) & (weights == weight)]
        covered = np.minimum(over[2 + axis], high) - np.maximum(over[axis], low)
        return float(np.clip(covered, 0.0, None).sum() / (high - low)) if high > low else 0.0

    def _table(self) -> tuple[Array, Array]:
        """The boxes (4, N) as x0, y0, x1, y1, and their weights (N,)."""
        if self._arrays is None:
            columns = np.ascontiguousarray(np.asarray(self._boxes, dtype=float).reshape(-1, 4).T)
            self._arrays = columns, np.asarray(self._weights, dtype=float)
        return self._arrays


def _overlap(taken: Array, box: Rectangle) -> Array:
    """Which (N,) of the boxes `taken` (4, N) a box overlaps."""
    return np.asarray((taken[0] < box.x1) & (taken[2] > box.x0) & (taken[1] < box.y1) & (taken[3] > box.y0))


def _overlaps(boxes: Sequence[Rectangle], taken: Array) -> Array:
    """Which of `boxes` and `taken` (4, N) overlap, (M, N)."""
    asked = np.array([(box.x0, box.y0, box.x1, box.y1) for box in boxes], dtype=float).reshape(-1, 4).T[:, :, None]
    return np.asarray((taken[0] < asked[2]) & (taken[2] > asked[0]) & (taken[1] < asked[3]) & (taken[3] > asked[1]))
