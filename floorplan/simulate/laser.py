"""A level laser scanner on wheels: 1 x N sweeps over a ray-cast building."""

from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from floorplan.geometry import rotation_about_z
from floorplan.model.checks import Array
from floorplan.simulate.raycast import NO_SURFACE, RayCaster
from floorplan.simulate.sensor import Shot
from floorplan.simulate.walk import Walk

BEAMS = 180
MAX_RANGE_M = 50.0
SIGMA_M = 0.01
HEIGHT_M = 0.40  # of the sweep above the floor: a robot's


def angles_rad() -> Array:
    """Direction of every beam (BEAMS,), counter-clockwise from straight ahead; the first points to the right."""
    return np.radians(-90.0 + np.arange(BEAMS) * 180.0 / BEAMS)


def rolled(walk: Walk) -> Walk:
    """The same way on wheels: level, at a fixed height, sensor axes x ahead, y left, z up."""
    position = walk.position_m.copy()
    position[:, 2] = HEIGHT_M
    return replace(walk, position_m=position, world_from_camera=rotation_about_z(walk.yaw_rad))


class LaserScanner:
    """Takes sweeps; `rays (BEAMS, 3)` are unit directions in sensor axes. `slips`: the wheels below it do."""

    def __init__(self, caster: RayCaster, seed: int, slips: bool = False) -> None:
        self.caster, self.seed, self.slips = caster, seed, slips
        angle = angles_rad()
        self.rays = np.column_stack((np.cos(angle), np.sin(angle), np.zeros(BEAMS))).astype(np.float32)

    def shots(self, walk: Walk) -> Iterator[Shot]:
        """One sweep (1, BEAMS) per pose; 0 where nothing comes back."""
        for index in range(len(walk)):
            rng = np.random.default_rng([self.seed, 81, index])
            directions = self.rays @ walk.world_from_camera[index].T.astype(np.float32)
            hits = self.caster.solid(walk.position_m[index], directions)
            back = (hits.surface != NO_SURFACE) & (hits.distance < MAX_RANGE_M)
            noisy = np.where(back, hits.distance + SIGMA_M * rng.standard_normal(BEAMS), 0.0)
            yield Shot(noisy[None], hits.distance[None], np.where(back, hits.surface, NO_SURFACE)[None])
