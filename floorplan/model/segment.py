"""What the front end gives: rotations, layout segments, evidence points, tracks."""

from dataclasses import dataclass

import numpy as np

from floorplan.model.checks import Array, freeze
from floorplan.model.scan import Problem

AXIS_X, AXIS_Y, AXIS_Z = 0, 1, 2
NO_SEGMENT = -1  # an evidence point that lies on no layout segment
NO_TRACK = -1  # a segment too weak to start a track


@dataclass(frozen=True)
class ManhattanFrames:
    """The rotation `R_i` of every frame: `world_from_sensor (F, 3, 3)`, world axes along the walls, z up.

    `yaw_sigma_rad (F,)` its standard deviation about z; `measured (F,)` False where no axis-aligned
    surface was seen and the odometry's yaw was held.
    """

    world_from_sensor: Array
    yaw_sigma_rad: Array
    measured: Array

    def __post_init__(self) -> None:
        freeze(
            self,
            {
                "world_from_sensor": (np.float64, ("F", 3, 3)),
                "yaw_sigma_rad": (np.float64, ("F",)),
                "measured": (np.bool_, ("F",)),
            },
        )


@dataclass(frozen=True)
class Segments:
    """Layout segments of all frames, S rows sorted by frame.

    `frame (S,)`; `axis (S,)` 0, 1, 2; `facing (S,)` +1 or -1, sign of the surface normal along the axis;
    `distance_m (S,)` plane coordinate minus sensor position along the axis (so its sign is `-facing`);
    `sigma_m (S,)`; `pixels (S,)`; `area_m2 (S,)`; `extent_m (S, 3, 2)` box, axis-aligned, relative to the sensor
    position, trimmed to the support; `centroid_sensor_m (S, 3)` and `scatter_sensor_m2 (S, 3, 3)` mean and covariance of
    the inliers in the sensor's axes, from which distances follow anew when a rotation is refined.
    """

    frame: Array
    axis: Array
    facing: Array
    distance_m: Array
    sigma_m: Array
    pixels: Array
    area_m2: Array
    extent_m: Array
    centroid_sensor_m: Array
    scatter_sensor_m2: Array

    def __post_init__(self) -> None:
        freeze(
            self,
            {
                "frame": (np.int32, ("S",)),
                "axis": (np.int8, ("S",)),
                "facing": (np.int8, ("S",)),
                "distance_m": (np.float64, ("S",)),
                "sigma_m": (np.float64, ("S",)),
                "pixels": (np.int32, ("S",)),
                "area_m2": (np.float64, ("S",)),
                "extent_m": (np.float64, ("S", 3, 2)),
                "centroid_sensor_m": (np.float64, ("S", 3)),
                "scatter_sensor_m2": (np.float64, ("S", 3, 3)),
            },
        )

    def __len__(self) -> int:
        return len(self.frame)


@dataclass(frozen=True)
class FreePatches:
    """Upright planar patches that lie off the axes (5 degrees and more), Q rows sorted by frame: outside the Manhattan model.

    `frame (Q,)`; `normal_yaw_rad (Q,)` azimuth of the surface normal (towards the sensor) in the axis-aligned
    world; `start_m (Q, 2)`, `end_m (Q, 2)` ends of the patch in plan, axis-aligned, relative to the sensor
    position; `height_m (Q, 2)` lowest and highest z relative to the sensor; `sigma_m (Q,)`; `pixels (Q,)`.
    """

    frame: Array
    normal_yaw_rad: Array
    start_m: Array
    end_m: Array
    height_m: Array
    sigma_m: Array
    pixels: Array

    def __post_init__(self) -> None:
        freeze(
            self,
            {
                "frame": (np.int32, ("Q",)),
                "normal_yaw_rad": (np.float64, ("Q",)),
                "start_m": (np.float64, ("Q", 2)),
                "end_m": (np.float64, ("Q", 2)),
                "height_m": (np.float64, ("Q", 2)),
                "sigma_m": (np.float64, ("Q",)),
                "pixels": (np.int32, ("Q",)),
            },
        )


@dataclass(frozen=True)
class EvidencePoints:
    """A thinned set of each frame's points, P in all, kept so that no later stage reads depth again.

    Every point is the end of a ray from the sensor: what lies before it was seen through. `start (F + 1,)`
    points of frame i are rows start[i]:start[i + 1]; `point_sensor_m (P, 3) float32` in the sensor's axes;
    `segment (P,)` row of `Segments` or NO_SEGMENT; `weight (P,)` how many pixels of the full image the point stands for.
    """

    start: Array
    point_sensor_m: Array
    segment: Array
    weight: Array

    def __post_init__(self) -> None:
        freeze(
            self,
            {
                "start": (np.int64, ("G",)),
                "point_sensor_m": (np.float32, ("P", 3)),
                "segment": (np.int32, ("P",)),
                "weight": (np.float32, ("P",)),
            },
        )


@dataclass(frozen=True)
class SegmentedScan:
    """Stage `2-segments`: everything later stages know about the depth; `problems` of keyframes that could not be read."""

    frames: ManhattanFrames
    segments: Segments
    free_patches: FreePatches
    evidence: EvidencePoints
    problems: tuple[Problem, ...] = ()


@dataclass(frozen=True)
class Tracks:
    """Initial layout planes: `track_of_segment (S,)` (NO_TRACK where none), `axis (M,)`, `facing (M,)`,
    `extent_m (M, 3, 2)` union of the segments' boxes in dead-reckoned coordinates."""

    track_of_segment: Array
    axis: Array
    facing: Array
    extent_m: Array

    def __post_init__(self) -> None:
        freeze(
            self,
            {
                "track_of_segment": (np.int32, ("S",)),
                "axis": (np.int8, ("M",)),
                "facing": (np.int8, ("M",)),
                "extent_m": (np.float64, ("M", 3, 2)),
            },
        )
