"""The up direction from accelerometer and odometry together.

In the odometry's world the accelerations of walking cancel over time, because the velocity stays bounded; what is
left of the mean is gravity. Over a time T it errs by (change of velocity) / (g T) and by the accelerometer's bias.
"""

from dataclasses import dataclass

import numpy as np

from floorplan.model.checks import Array
from floorplan.model.scan import GravitySource, Problem
from floorplan.readers.pose_table import MISSING_STAMP_NS

STANDARD_GRAVITY_M_S2 = 9.81
GRAVITY_BAND_M_S2 = 2.0  # a mean further than this from standard gravity is no gravity: wrong unit or gravity taken out
WALKING_SPEED_CHANGE_M_S = 0.5  # between start and end of a hand-held recording
BIAS_M_S2 = 0.05  # phone accelerometers, after factory calibration: some 5 mg
WORLD_SIGMA_RAD = np.deg2rad(0.25)  # tilt error of a phone's visual-inertial world, which estimates that bias
DISAGREEMENT_RAD = np.deg2rad(5.0)  # no bias or gait explains more: axes, stamps or poses are wrong


@dataclass(frozen=True)
class ImuTable:
    """Specific force turned to point down at rest, sensor axes: `stamp_ns (K,)`, `down_m_s2 (K, 3)`."""

    stamp_ns: Array
    down_m_s2: Array

    def __len__(self) -> int:
        return len(self.stamp_ns)

    def usable(self) -> "ImuTable":
        """Only rows whose stamp and accelerations are numbers."""
        good = np.isfinite(self.down_m_s2).all(axis=1) & (self.stamp_ns != MISSING_STAMP_NS)
        return ImuTable(self.stamp_ns[good], self.down_m_s2[good])


@dataclass(frozen=True)
class FusedUp:
    """`up_world (3,)`, unit, where it comes from, and problems met."""

    up_world: Array
    source: GravitySource
    problems: tuple[Problem, ...] = ()


def mean_down_world(imu: ImuTable, stamp_ns: Array, world_from_sensor: Array) -> Array:
    """Mean down-pointing specific force (3,) m/s^2 in the odometry's world, over the readings within the poses' time.

    NaN when there is no such reading. `stamp_ns (N,)` sorted, `world_from_sensor (N, 3, 3)`.
    """
    within = (imu.stamp_ns >= stamp_ns[0]) & (imu.stamp_ns <= stamp_ns[-1])
    if not within.any():
        return np.full(3, np.nan)
    after = np.clip(np.searchsorted(stamp_ns, imu.stamp_ns[within]), 1, max(len(stamp_ns) - 1, 1))
    after = np.minimum(after, len(stamp_ns) - 1)
    before = np.maximum(after - 1, 0)
    nearer = np.where(imu.stamp_ns[within] - stamp_ns[before] < stamp_ns[after] - imu.stamp_ns[within], before, after)
    return np.asarray(np.einsum("kij,kj->ki", world_from_sensor[nearer], imu.down_m_s2[within]).mean(axis=0))


def fused_up(imu: ImuTable, stamp_ns: Array, world_from_sensor: Array, world_up: Array) -> FusedUp:
    """Up in a world that its maker calls gravity aligned: weighted mean of `world_up (3,)` and the accelerometer's up.

    The weights are the inverse variances of both. Where they contradict each other the world is believed and a
    problem says so.
    """
    down = mean_down_world(imu, stamp_ns, world_from_sensor)
    strength = float(np.linalg.norm(down))
    if not abs(strength - STANDARD_GRAVITY_M_S2) < GRAVITY_BAND_M_S2:  # NaN too
        message = f"accelerometer mean is {strength:.2f} m/s^2, no gravity"
        return FusedUp(world_up, GravitySource.WORLD, (Problem("imu-implausible", message, advice="the odometry's own world is used"),))
    up = -down / strength
    angle = float(np.arccos(np.clip(up @ world_up, -1.0, 1.0)))
    if angle > DISAGREEMENT_RAD:
        message = f"accelerometer and odometry disagree about the vertical by {np.rad2deg(angle):.1f} degrees"
        advice = "the odometry's own world is used; check floor and walls in the plan"
        return FusedUp(world_up, GravitySource.WORLD, (Problem("gravity-contradictory", message, advice=advice),))
    seconds = (stamp_ns[-1] - stamp_ns[0]) * 1e-9
    imu_sigma = np.hypot(WALKING_SPEED_CHANGE_M_S / (strength * max(seconds, 0.1)), BIAS_M_S2 / strength)
    weight = imu_sigma**-2 / (imu_sigma**-2 + WORLD_SIGMA_RAD**-2)
    mean = weight * up + (1 - weight) * world_up
    return FusedUp(mean / np.linalg.norm(mean), GravitySource.IMU)
