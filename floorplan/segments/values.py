"""What the segment stage passes around inside itself."""

from dataclasses import dataclass, field

import numpy as np

from floorplan.model.checks import Array, freeze
from floorplan.model.scan import Problem
from floorplan.model.segment import EvidencePoints, FreePatches, Segments


@dataclass(frozen=True)
class FrameRotation:
    """The rotation under which one frame was labelled, how sure its yaw is, and whether walls were seen."""

    world_from_sensor: Array
    yaw_sigma_rad: float
    measured: bool


@dataclass(frozen=True)
class PlaneRows:
    """The planes of one frame that make its segments (S rows): `label (S,)` axis * 2 + (1 where the surface faces along it), `fit (S, 16)`
    (see `fit.Column`), `extent_m (S, 3, 2)` trimmed box about the sensor, `area_m2 (S,)`."""

    label: Array
    fit: Array
    extent_m: Array
    area_m2: Array


@dataclass(frozen=True)
class ThinnedPoints:
    """Points of one frame `point_m (P, 3) float32`, sensor axes, each with the frame's `segment (P,)` it lies on or NO_SEGMENT, and
    standing for `pixels` of the full image."""

    point_m: Array
    segment: Array
    pixels: float


@dataclass(frozen=True)
class SegmentedFrame:
    """What one keyframe shows, in the rows that a chunk's values are made of: planes, off-axis `patches (Q, 9)` (see `free_patches`),
    thinned points; `labels` and `segment_of_pixel (H, W)` for pictures.

    `frame` counts keyframes; `pixels_per_point`: pixels of the full image per pixel of the grid looked at.
    """

    frame: int
    pixels_per_point: float
    rotation: FrameRotation
    planes: PlaneRows
    patches: Array
    evidence: ThinnedPoints
    labels: Array
    segment_of_pixel: Array


@dataclass(frozen=True)
class SegmentedChunk:
    """The segments of some keyframes: `frame (n,)` indices into the keyframes, increasing; `world_from_sensor (n, 3, 3)` the rotations
    they were labelled under; `ripple_m2 (S,)`: by how much blocks of a segment's pixels lie apart beyond pixel noise (a variance,
    negative by chance); `blocks (S,)` how many there were.
    `Segments.frame` and `FreePatches.frame` count keyframes of the whole scan; `evidence.start` and
    `evidence.segment` count within the chunk. A frame that could not be read is in `problems` and has no segments.
    """

    frame: Array
    world_from_sensor: Array
    yaw_sigma_rad: Array
    measured: Array
    segments: Segments
    ripple_m2: Array
    blocks: Array
    free_patches: FreePatches
    evidence: EvidencePoints
    problems: tuple[Problem, ...] = field(default=())

    def __post_init__(self) -> None:
        freeze(
            self,
            {
                "frame": (np.int64, ("n",)),
                "world_from_sensor": (np.float64, ("n", 3, 3)),
                "yaw_sigma_rad": (np.float64, ("n",)),
                "measured": (np.bool_, ("n",)),
                "ripple_m2": (np.float64, ("S",)),
                "blocks": (np.int32, ("S",)),
            },
        )
