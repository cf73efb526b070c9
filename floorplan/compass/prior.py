"""What the compass tells the main pass about every keyframe."""

import math
from dataclasses import dataclass

import numpy as np

from floorplan.grid.normals import NoiseScale
from floorplan.model.checks import Array, freeze

_TURN_STEP_RAD = math.radians(5.0)  # heading drift grows with turning: 5 degrees count like _DRIFT_STEP_M walked
_DRIFT_STEP_M = 0.3
_REST = 0.05  # ... and a little at rest


def heading_walk(turn_rad: Array, step_m: Array) -> Array:
    """Relative standard deviation (F - 1,) of odometry's heading error per step, from its turn and its length."""
    return np.asarray(np.sqrt(_REST + step_m / _DRIFT_STEP_M + (turn_rad / _TURN_STEP_RAD) ** 2))


@dataclass(frozen=True)
class CompassPrior:
    """Levelled and turned to the walls, from a first look at the whole recording; F keyframes.

    `level_from_sensor (F, 3, 3)` gravity along -z, heading as the odometry has it; `yaw_rad (F,)` what to turn that by to
    reach the Manhattan frame, with `yaw_sigma_rad (F,)`; `turn_rad (F - 1,)` and `step_m (F - 1,)` odometry between
    keyframes; `noise` how the sensor compares with its model; `final` True when the
    yaw is the published compass's and is not to be refined.
    """

    level_from_sensor: Array
    yaw_rad: Array
    yaw_sigma_rad: Array
    measured: Array
    turn_rad: Array
    step_m: Array
    noise: NoiseScale
    final: bool = False

    def __post_init__(self) -> None:
        freeze(
            self,
            {
                "level_from_sensor": (np.float64, ("F", 3, 3)),
                "yaw_rad": (np.float64, ("F",)),
                "yaw_sigma_rad": (np.float64, ("F",)),
                "measured": (np.bool_, ("F",)),
                "turn_rad": (np.float64, ("T",)),
                "step_m": (np.float64, ("T",)),
            },
        )
