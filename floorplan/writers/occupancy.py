"""What already stands on the drawing, as weighted boxes, and what a new text would cost where it is tried."""

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np

from floorplan.model.checks import Array
from floorplan.model.plan import Point

TEXT_WEIGHT = 100.0  # text over text is unreadable
STAMP_WEIGHT = 12.0  # before stamps have their final place
WALL_WEIGHT = 30.0  # text over a wall line
SYMBOL_WEIGHT = 15.0  # text over a door swing
LINE_WEIGHT = 20.0  # text over a thin line


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
        if self._arrays is None:
            self._arrays = np.asarray(self._boxes, dtype=float).reshape(-1, 4), np.asarray(self._weights, dtype=float)
        boxes, weights = self._arrays
        overlap = (boxes[:, 0] < box.x1) & (boxes[:, 2] > box.x0) & (boxes[:, 1] < box.y1) & (boxes[:, 3] > box.y0)
        return float(weights[overlap & (weights >= at_least)].sum())
