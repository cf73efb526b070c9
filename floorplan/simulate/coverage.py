"""Which parts of which surfaces the sensor's rays have hit."""

import numpy as np

from floorplan.model.checks import Array
from floorplan.simulate.raycast import NO_SURFACE
from floorplan.simulate.surfaces import Surface

CELL_M = 0.05
ENOUGH_HITS = 20  # looked at (every fourth pixel is), in one cell over the whole scan: about 80 pixels
IMAGE_STRIDE = 2


class Coverage:
    """Counts hits per cell of CELL_M along every upright axis-aligned surface; `rays (H * W, 3)` in sensor axes."""

    def __init__(self, surfaces: tuple[Surface, ...], rays: Array, stride: int = IMAGE_STRIDE) -> None:
        upright = [surface.axis in (0, 1) for surface in surfaces]
        self.surfaces, self._rays, self._stride = surfaces, rays, stride
        self._low = np.array([s.along[0] if u else 0.0 for s, u in zip(surfaces, upright, strict=True)])
        self._along = np.array([1 - s.axis if u else 0 for s, u in zip(surfaces, upright, strict=True)])
        lengths = [s.along[1] - s.along[0] if u else 0.0 for s, u in zip(surfaces, upright, strict=True)]
        self._cells = np.array([max(int(np.ceil(length / CELL_M - 1e-6)), 1) for length in lengths])
        self._first = np.concatenate(([0], np.cumsum(self._cells)))
        self.hits = np.zeros(self._first[-1], dtype=np.int64)
        self.total = np.zeros(len(surfaces), dtype=np.int64)

    def add(self, surface: Array, depth_m: Array, position_m: Array, world_from_camera: Array) -> None:
        """Count one shot: `surface (H, W)`, `depth_m (H, W)` true depths in ray lengths."""
        step = slice(None, None, self._stride)
        found = surface[step, step] != NO_SURFACE
        picked = surface[step, step][found]
        at = self._rays.reshape(*surface.shape, 3)[step, step][found] * depth_m[step, step][found][:, None]
        world = at @ np.asarray(world_from_camera).T + position_m
        value = np.where(self._along[picked] == 0, world[:, 0], world[:, 1])
        cell = np.clip(((value - self._low[picked]) / CELL_M).astype(int), 0, self._cells[picked] - 1)
        self.hits += np.bincount(self._first[picked] + cell, minlength=len(self.hits))
        self.total += np.bincount(picked, minlength=len(self.total))

    def seen(self, index: int) -> list[tuple[float, float]]:
        """Ranges along surface `index` that were hit often enough."""
        surface = self.surfaces[index]
        enough = self.hits[self._first[index] : self._first[index + 1]] >= ENOUGH_HITS
        edges = np.flatnonzero(np.diff(np.concatenate(([0], enough.astype(int), [0]))))
        low, high = surface.along
        return [(low + a * CELL_M, min(low + b * CELL_M, high)) for a, b in edges.reshape(-1, 2)]
