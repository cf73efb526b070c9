"""The up direction named by an axis of the odometry's world."""

import numpy as np

from floorplan.errors import ConfigError
from floorplan.model.checks import Array

AXES = "xyz"
ARKIT_UP = np.array([0.0, 1.0, 0.0])  # of the world in which iPhones and iPads track
OPENCV_FROM_ARKIT = np.diag([1.0, -1.0, -1.0])  # ARKit's camera has y up and looks along -z


def named_axis(name: str) -> Array:
    """Unit vector (3,) of "+z", "-y" and the like. Raises `ConfigError` for anything else."""
    sign, letter = (name[0], name[1:]) if name[:1] in "+-" else ("+", name)
    if len(letter) != 1 or letter not in AXES:
        raise ConfigError(f"read.world_up = {name!r}: must be one of +x, -x, +y, -y, +z, -z")
    return np.asarray(np.eye(3)[AXES.index(letter)] * (-1.0 if sign == "-" else 1.0))


def down_in_sensor(up_world: Array, world_from_sensor: Array) -> Array:
    """Down directions (N, 3) in the sensor's axes, of `up_world (3,)` and rotations (N, 3, 3)."""
    return np.asarray(-np.einsum("nji,j->ni", world_from_sensor, up_world))
