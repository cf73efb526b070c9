"""What a reader gives and ingest completes: the sensor, the recording, one frame, problems met on the way."""

from dataclasses import dataclass
from enum import StrEnum
from itertools import pairwise

import numpy as np

from floorplan.model.checks import Array, freeze

NANOSECONDS_PER_SECOND = 1_000_000_000
POSES_MISSING = "poses-missing"  # the problem of a recording without a trajectory: its poses stand still


class SensorKind(StrEnum):
    """What made the grid: it decides which axes can be seen and how neighbours lie on it."""

    CAMERA = "camera"  # pinhole depth image, H x W
    LASER = "laser"  # one level sweep, 1 x N: no floor, no ceiling, no heights
    LIDAR = "lidar"  # spinning, rings x columns


class GravitySource(StrEnum):
    """Where the down direction of each frame comes from."""

    IMU = "imu"
    WORLD = "gravity-aligned world"
    ESTIMATED = "estimated from floor and ceiling"
    LEVEL = "assumed level"
    UNKNOWN = "unknown"


@dataclass(frozen=True)
class Intrinsics:
    """Pinhole camera of the DEPTH image: pixels; pixel centres at whole numbers."""

    width: int
    height: int
    fx: float
    fy: float
    cx: float
    cy: float


@dataclass(frozen=True)
class NoiseModel:
    """Standard deviation of one range reading: `constant_m + linear * r + quadratic_per_m * r^2` (r in metres)."""

    constant_m: float
    linear: float = 0.0
    quadratic_per_m: float = 0.0

    def sigma_m(self, range_m: Array) -> Array:
        """Standard deviation in metres, same shape as `range_m`."""
        return np.asarray(self.constant_m + self.linear * range_m + self.quadratic_per_m * range_m**2)


@dataclass(frozen=True)
class RangeAccuracy:
    """Standard deviations of errors that last all scan long: `scale_sigma` part of the range, `bias_sigma_m` of one surface."""

    scale_sigma: float
    bias_sigma_m: float


@dataclass(frozen=True)
class Sensor:
    """The instrument: grid size, noise, the ranges it can be trusted in, the angle between neighbouring rays."""

    kind: SensorKind
    height: int
    width: int
    noise: NoiseModel
    min_range_m: float
    max_range_m: float
    ray_step_rad: float
    intrinsics: Intrinsics | None = None
    accuracy: RangeAccuracy | None = None  # None: not known, typical of its kind


@dataclass(frozen=True)
class Problem:
    """One kind of bad data, coded and counted; never silently dropped.

    `code` is a short kebab-case word (`png-unreadable`, `stamp-doubled`); `where` names the first place
    (file, line, frame, stamp); `advice` says what to do. `fatal` means `build` stops on it.
    """

    code: str
    message: str
    where: str = ""
    count: int = 1
    advice: str = ""
    fatal: bool = False


@dataclass(frozen=True)
class Recording:
    """All of a scan except its depth, one row per frame in time order, N frames.

    `stamp_ns (N,)` the source's own stamps; `position_m (N, 3)` and `odom_from_sensor (N, 3, 3)` the odometry
    pose of the sensor in the odometry's world; `down_sensor (N, 3)` the unit direction of gravity in the
    sensor's axes, NaN while `gravity_source` is UNKNOWN. Sensor axes: cameras x right, y down, z forward
    (OpenCV); lasers and LiDARs x forward, y left, z up.
    """

    format: str
    sensor: Sensor
    stamp_ns: Array
    position_m: Array
    odom_from_sensor: Array
    down_sensor: Array
    gravity_source: GravitySource
    problems: tuple[Problem, ...] = ()
    returns_to_start: bool | None = None

    def __post_init__(self) -> None:
        freeze(
            self,
            {
                "stamp_ns": (np.int64, ("N",)),
                "position_m": (np.float64, ("N", 3)),
                "odom_from_sensor": (np.float64, ("N", 3, 3)),
                "down_sensor": (np.float64, ("N", 3)),
            },
        )

    def __len__(self) -> int:
        return len(self.stamp_ns)


@dataclass(frozen=True)
class Frame:
    """One depth image or sweep: `points (H, W, 3) float32` metres in the sensor's own axes, NaN where nothing came back.

    `index` is the row of the `Recording`. `confidence (H, W) uint8`, 0 (worst) to 2, or None where the
    sensor gives none. `grey (H, W) uint8`, the brightness, only where the recording has no poses of its own.
    """

    index: int
    stamp_ns: int
    points: Array
    confidence: Array | None = None
    grey: Array | None = None

    def __post_init__(self) -> None:
        freeze(self, {"points": (np.float32, ("H", "W", 3)), "confidence": (np.uint8, ("H", "W")), "grey": (np.uint8, ("H", "W"))})


@dataclass(frozen=True)
class Trajectory:
    """Poses of the sensor: `stamp_ns (N,)`, `position_m (N, 3)`, `world_from_sensor (N, 3, 3)`; z up."""

    stamp_ns: Array
    position_m: Array
    world_from_sensor: Array

    def __post_init__(self) -> None:
        freeze(
            self,
            {
                "stamp_ns": (np.int64, ("N",)),
                "position_m": (np.float64, ("N", 3)),
                "world_from_sensor": (np.float64, ("N", 3, 3)),
            },
        )


@dataclass(frozen=True)
class LeverArm:
    """From the point whose motion the odometry reports to the sensor, in the sensor's axes: metres ahead and to the left.

    `turns` it was told by; `applied`: it is sure and long enough to count, and the odometry was moved by it.
    """

    forward_m: float
    left_m: float
    forward_sigma_m: float
    left_sigma_m: float
    turns: int
    applied: bool


@dataclass(frozen=True)
class WheelTurn:
    """What the wheels' turns lack: `rad_per_m` driven ahead and a `part` of each turn; `applied`: it is sure, and was added."""

    rad_per_m: float
    part: float
    sigma_rad_per_m: float
    sigma_part: float
    applied: bool


@dataclass(frozen=True)
class Wheels:
    """What matched sweeps say about a robot's odometry; None where the recording does not tell."""

    lever_arm: LeverArm | None
    turn: WheelTurn | None


@dataclass(frozen=True)
class ScanPart:
    """One of several scans recorded in one building and joined: where it begins, and how it was laid against those before.

    `first_row` of the joined recording, `first_keyframe` of its keyframes; `quarters` turned its own axis-aligned world into the
    first scan's. `link_m` is the step from the last keyframe before to its first one (axis-aligned world), known to `link_sigma_m`;
    both are zero for the first scan. `start` says in words what the link was taken from.
    """

    name: str
    scan: str
    format: str
    first_row: int
    first_keyframe: int
    quarters: int
    link_m: tuple[float, float, float]
    link_sigma_m: tuple[float, float, float]
    start: str


@dataclass(frozen=True)
class IngestedScan:
    """Stage `1-ingest`: the recording with its gravity known, and the frames that will be looked at.

    `keyframe (F,)` are rows of `recording`, increasing; chosen by change of view. Everything called
    "frame" in later stages (`Segments.frame`, `LayoutGraph.frame`) is an index into `keyframe`.
    `recorded_odometry` holds all N poses as the source gave them where `recording` has refined ones, and `wheels` what matching found
    wrong with them. `map_sigma_m (N,)` where the refined ones are one map, places seen again joined: how well each place is known;
    errors do not add up along the path, and the poses' world has one direction all over. None: odometry that drifts.
    `parts` are the scans it was joined from, in order, whose stamps may overlap; empty for a scan that is one recording.
    """

    recording: Recording
    keyframe: Array
    recorded_odometry: Trajectory | None = None
    parts: tuple[ScanPart, ...] = ()
    map_sigma_m: Array | None = None
    wheels: Wheels | None = None

    @property
    def mapped(self) -> bool:
        """Whether the odometry is a map."""
        return self.map_sigma_m is not None

    @property
    def linked(self) -> tuple[ScanPart, ...]:
        """The parts that a link ties to the one before: all but the first."""
        return self.parts[1:]

    @property
    def stretches(self) -> tuple[slice, ...]:
        """The rows of the recording that each scan holds, one after the other; all of them for a single scan."""
        edges = [0, *(part.first_row for part in self.linked), len(self.recording)]
        return tuple(slice(low, high) for low, high in pairwise(edges))

    def __post_init__(self) -> None:
        freeze(self, {"keyframe": (np.int64, ("F",)), "map_sigma_m": (np.float64, ("N",))})
