"""Places: what was seen over a few metres of path, as one cloud about the sweep in its middle."""

from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from floorplan.model.checks import Array
from floorplan.sweep_matching.surfaces import SweepSurfaces

REACH_M = 4.0  # of path before and after: more and the drift within it shows, less and every corridor looks like the next
VIEW_M = 12.0  # what lies further away than this is thin and known by its yaw
_CELL_M = 0.10  # points closer together are one
_KEPT = 64  # clouds kept at a time


@dataclass(frozen=True)
class Nodes:
    """M sweeps in order: `pose (M, 3)` as matched, `path_m (M,)` walked so far, what each saw."""

    pose: Array
    path_m: Array
    surfaces: tuple[SweepSurfaces, ...]

    def __len__(self) -> int:
        return len(self.pose)


@dataclass(frozen=True)
class Cloud:
    """Points about one node, in its axes: `row (n, 4)` x, y, normal; `sigma_m (n,)`."""

    row: Array
    sigma_m: Array


class Places:
    """The clouds of the nodes, made when asked for."""

    def __init__(self, nodes: Nodes) -> None:
        self._nodes = nodes
        self.cloud = lru_cache(maxsize=_KEPT)(self._cloud)

    def _cloud(self, node: int) -> Cloud:
        """What was seen within REACH_M of path, seen from `node`."""
        path = self._nodes.path_m
        first, last = np.searchsorted(path, (path[node] - REACH_M, path[node] + REACH_M + 1e-9))
        rows, sigmas = [], []
        for k in range(int(first), int(last)):
            rows.append(_seen_from(self._nodes.surfaces[k].row, self._nodes.pose[k], self._nodes.pose[node]))
            sigmas.append(self._nodes.surfaces[k].sigma_m)
        row, sigma = np.concatenate(rows), np.concatenate(sigmas)
        near = np.flatnonzero(np.hypot(row[:, 0], row[:, 1]) < VIEW_M)
        kept = near[_thinned(row[near], _CELL_M)]
        return Cloud(np.ascontiguousarray(row[kept]), sigma[kept])


def _seen_from(row: Array, pose: Array, node: Array) -> Array:
    """Rows (n, 4) in the axes of `pose (3,)`, brought into those of `node (3,)`."""
    yaw = pose[2] - node[2]
    turn = np.array(((np.cos(yaw), np.sin(yaw)), (-np.sin(yaw), np.cos(yaw))))  # of row vectors
    c, s = np.cos(node[2]), np.sin(node[2])
    away = np.array((c * (pose[0] - node[0]) + s * (pose[1] - node[1]), c * (pose[1] - node[1]) - s * (pose[0] - node[0])))
    return np.hstack((row[:, :2] @ turn + away, row[:, 2:] @ turn))


def _thinned(row: Array, cell_m: float) -> Array:
    """Indices of one point per cell and side of a surface: the first that was seen."""
    cell = np.floor(row[:, :2] / cell_m).astype(np.int64)
    facing = np.rint(row[:, 2:]).astype(np.int64) + 1
    key = ((cell[:, 0] << 24) + cell[:, 1]) * 16 + facing[:, 0] * 4 + facing[:, 1]
    return np.asarray(np.unique(key, return_index=True)[1])
