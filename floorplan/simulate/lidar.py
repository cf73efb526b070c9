"""A spinning LiDAR of 16 rings, carried by hand, over a ray-cast building; each sweep is taken at one instant."""

from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from floorplan.simulate.raycast import NO_SURFACE, RayCaster
from floorplan.simulate.sensor import Shot
from floorplan.simulate.walk import BODY_FROM_CAMERA, Walk

RINGS = 16  # the usual small one: 30 degrees in steps of 2
LOWEST_DEG, RING_STEP_DEG = -15.0, 2.0
COLUMNS = 900  # 0.4 degrees apart: 20 turns a second
MIN_RANGE_M, MAX_RANGE_M = 0.5, 100.0
SIGMA_M = 0.015  # of 3 cm typical accuracy, two thirds are systematic in the makers' sheets


def carried(walk: Walk) -> Walk:
    """The same way with sensor axes x ahead, y left, z up."""
    return replace(walk, world_from_camera=walk.world_from_camera @ BODY_FROM_CAMERA.T)


class SpinningLidar:
    """Takes sweeps; `rays (RINGS * columns, 3)` are unit directions, rings from the lowest, each once around from straight behind."""

    def __init__(self, caster: RayCaster, seed: int, scale: float = 1.0) -> None:
        self.caster, self.seed = caster, seed
        self.shape = (RINGS, max(round(COLUMNS * scale), 1))
        up = np.radians(LOWEST_DEG + RING_STEP_DEG * np.arange(RINGS))[:, None]
        around = (-np.pi + 2 * np.pi * (np.arange(self.shape[1]) + 0.5) / self.shape[1])[None]
        rays = np.stack(np.broadcast_arrays(np.cos(up) * np.cos(around), np.cos(up) * np.sin(around), np.sin(up)), axis=-1)
        self.rays = rays.reshape(-1, 3).astype(np.float32)

    def shots(self, walk: Walk) -> Iterator[Shot]:
        """One sweep per pose; 0 where nothing comes back."""
        for index in range(len(walk)):
            rng = np.random.default_rng([self.seed, 82, index])
            directions = self.rays @ walk.world_from_camera[index].T.astype(np.float32)
            hits = self.caster.solid(walk.position_m[index], directions)
            back = (hits.surface != NO_SURFACE) & (hits.distance > MIN_RANGE_M) & (hits.distance < MAX_RANGE_M)
            noisy = np.where(back, hits.distance + SIGMA_M * rng.standard_normal(len(back)), 0.0)
            surface = np.where(back, hits.surface, NO_SURFACE)
            yield Shot(*(values.reshape(self.shape) for values in (noisy, hits.distance, surface)))
