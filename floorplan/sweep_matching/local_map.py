"""What was seen over the last metres of path: the map that the next sweep is matched with."""

from dataclasses import dataclass, field

import numpy as np

from floorplan.model.checks import Array
from floorplan.sweep_matching.kernels import add_sweep, build_cells
from floorplan.sweep_matching.surfaces import SweepSurfaces

MEMORY_PATH_M = 20.0  # what was last seen longer ago lies where the drift since then put it: the merge's business
SPACING_M = 0.05  # sightings closer than this are one point


@dataclass
class LocalMap:
    """Rows of `kernels.py` and their look-up table; grows by whole sweeps and forgets by path."""

    points: Array = field(default_factory=lambda: np.zeros((0, 6)))
    frame: Array = field(default_factory=lambda: np.zeros(4, np.int64))
    start: Array = field(default_factory=lambda: np.zeros(1, np.int64))
    order: Array = field(default_factory=lambda: np.zeros(0, np.int64))

    def add(self, sweep: SweepSurfaces, pose: Array, path_m: float) -> None:
        """Join `sweep`, seen from `pose (3,)` after `path_m` metres of path."""
        self._index(self.points[self.points[:, 5] >= path_m - MEMORY_PATH_M])
        room = np.concatenate((self.points, np.zeros((len(sweep.row), 6))))
        count = add_sweep(room, len(self.points), self.frame, self.start, self.order, sweep.row, pose, path_m, SPACING_M)
        self._index(room[:count].copy())

    def _index(self, points: Array) -> None:
        self.points = points
        if len(points):
            self.frame, self.start, self.order = build_cells(points)
        else:
            self.order = np.zeros(0, np.int64)
