"""What wheels do that tracking by camera does not: every so often they slip, and the odometry jumps by decimetres and degrees."""

import numpy as np

from floorplan.geometry import rotation_about_z
from floorplan.model.checks import Array
from floorplan.simulate.odometry import Odometry

SLIP_EVERY_M = 20.0  # of path, on average: door sills, cables, a wheel that spins
SLIP_M = 0.10  # standard deviation of a slip, along and across
SLIP_RAD = np.radians(5.0)


def slipping(odometry: Odometry, seed: int) -> Odometry:
    """The odometry with slips between frames, at random places of the path: all that comes after is moved and turned."""
    random = np.random.default_rng([seed, 83])
    position, rotation = odometry.position_m.copy(), odometry.odom_from_camera.copy()
    travelled = np.concatenate(([0.0], np.cumsum(np.linalg.norm(np.diff(position[:, :2], axis=0), axis=1))))
    for frame in _slips(travelled, random):
        turn = rotation_about_z(np.asarray(SLIP_RAD * random.standard_normal()))
        moved = np.append(SLIP_M * random.standard_normal(2), 0.0)
        pivot = position[frame].copy()
        position[frame:] = (position[frame:] - pivot) @ turn.T + pivot + moved
        rotation[frame:] = turn @ rotation[frame:]
    return Odometry(position, rotation)


def _slips(travelled_m: Array, random: np.random.Generator) -> Array:
    """Frames (S,) before which the wheels slipped."""
    count = int(np.ceil(3 * travelled_m[-1] / SLIP_EVERY_M)) + 10
    at = np.cumsum(random.exponential(SLIP_EVERY_M, count))
    return np.unique(np.searchsorted(travelled_m, at[at < travelled_m[-1]]))
