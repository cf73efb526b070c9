"""The depth points that every frame kept, placed in the plan frame by a trajectory."""

from dataclasses import dataclass

import numpy as np

from floorplan.model.checks import Array, freeze
from floorplan.model.scan import Trajectory
from floorplan.model.segment import AXIS_Z, NO_SEGMENT
from floorplan.results import Results, trajectories


@dataclass(frozen=True)
class PlacedPoints:
    """Points on layout segments: `point_m (P, 3)` plan frame; `axis (P,)` and `facing (P,)` of their surface, plan frame too."""

    point_m: Array
    axis: Array
    facing: Array

    def __post_init__(self) -> None:
        freeze(self, {"point_m": (np.float64, ("P", 3)), "axis": (np.int8, ("P",)), "facing": (np.int8, ("P",))})


def points_on_segments(results: Results, most: int, upright_only: bool = False) -> Array:
    """Rows of the evidence points that lie on a layout segment, an even selection of about `most` of them."""
    evidence, segments = results.segmented.evidence, results.segmented.segments
    rows = np.flatnonzero(evidence.segment != NO_SEGMENT)
    if upright_only:
        rows = rows[segments.axis[evidence.segment[rows]] != AXIS_Z]
    return np.asarray(rows[:: max(1, len(rows) // most)])


def tape_scale(results: Results) -> float:
    """The common scale that distances measured by hand gave; depth points follow the final path by it."""
    return results.solution.calibration.scale if results.solution.calibration else 1.0


def placed_points(results: Results, path: Trajectory, rows: Array, scale: float = 1.0) -> PlacedPoints:
    """The evidence points of `rows`, times `scale`, placed by a trajectory of every frame in the plan frame."""
    evidence, segments, key = results.segmented.evidence, results.segmented.segments, results.scan.keyframe
    frame = np.searchsorted(evidence.start, rows, side="right") - 1
    rotation, position = path.world_from_sensor[key[frame]], path.position_m[key[frame]]
    point = np.einsum("nij,nj->ni", rotation, scale * evidence.point_sensor_m[rows].astype(float)) + position
    segment = evidence.segment[rows]
    axis, facing = turned_axes(segments.axis[segment], segments.facing[segment], results.plan.rotation_quarters)
    return PlacedPoints(point, axis, facing)


def turned_axes(axis: Array, facing: Array, quarters: int) -> tuple[Array, Array]:
    """Axis and facing (N,) after `quarters` quarter turns counter-clockwise about z: +x becomes +y, +y becomes -x."""
    axis, facing = axis.astype(np.int8), facing.astype(np.int8)
    for _ in range(quarters % 4):
        level = axis != AXIS_Z
        facing = np.where(axis == 1, -facing, facing).astype(np.int8)
        axis = np.where(level, 1 - axis, axis).astype(np.int8)
    return axis, facing


def sensor_rays(results: Results, most: int) -> tuple[Array, Array]:
    """Start and end (R, 3) each of about `most` of the kept rays along the final path, plan frame."""
    evidence, key, path = results.segmented.evidence, results.scan.keyframe, trajectories(results).final
    rows = np.arange(0, len(evidence.segment), max(1, len(evidence.segment) // most))
    frame = key[np.searchsorted(evidence.start, rows, side="right") - 1]
    start = path.position_m[frame]
    run = np.einsum("nij,nj->ni", path.world_from_sensor[frame], tape_scale(results) * evidence.point_sensor_m[rows].astype(float))
    return start, start + run
