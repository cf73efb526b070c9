"""The paper's composite figure: the same depth points and path after each step of the method, beside each other."""

from dataclasses import dataclass

import numpy as np

from floorplan.model.checks import Array
from floorplan.model.scan import Trajectory
from floorplan.model.segment import AXIS_Z, NO_SEGMENT
from floorplan.report.drawing import track
from floorplan.results import Results, trajectories
from floorplan.trajectory import PlanFrame, in_plan_frame, odometry_trajectory

DRAWN_POINTS = 6000  # per view: a wall still reads as a line, four views stay under half a megabyte
TRIM = 0.5  # per cent of the points cut off each side of the frame: single far readings


@dataclass(frozen=True)
class View:
    """One step: SVG path data of the points by the axis of the wall they lie on and of the sensor's path; `gap_m` start to end."""

    title: str
    note: str
    x: str
    y: str
    path: str
    gap_m: float
    view: tuple[float, float, float, float]


def four_views(results: Results) -> tuple[View, ...]:
    """Raw odometry, compass, least squares, final; all in the plan frame."""
    paths = trajectories(results)
    key = results.scan.keyframe
    frame = PlanFrame(results.plan.rotation_quarters, results.plan.shift_m)
    raw = in_plan_frame(odometry_trajectory(results.scan, results.segmented.frames.world_from_sensor[0]), frame)
    steps = (
        ("Odometry", "as recorded", raw),
        ("Compass", "yaw from the walls", paths.compass),
        ("Least squares", "walls tracked, none merged", paths.least_squares),
        ("Final", "walls merged", paths.final),
    )
    chosen = _chosen(results)
    return tuple(_view(title, note, path, key, results, chosen) for title, note, path in steps)


def _chosen(results: Results) -> Array:
    """An even selection of the points that lie on walls."""
    evidence, segments = results.segmented.evidence, results.segmented.segments
    on_segment = np.flatnonzero(evidence.segment != NO_SEGMENT)
    upright = on_segment[segments.axis[evidence.segment[on_segment]] != AXIS_Z]
    return np.asarray(upright[:: max(1, len(upright) // DRAWN_POINTS)])


def _view(title: str, note: str, path: Trajectory, key: Array, results: Results, chosen: Array) -> View:
    evidence, segments = results.segmented.evidence, results.segmented.segments
    frame = np.searchsorted(evidence.start, chosen, side="right") - 1
    rotation, position = path.world_from_sensor[key[frame]], path.position_m[key[frame]]
    points = (np.einsum("nij,nj->ni", rotation, evidence.point_sensor_m[chosen].astype(float)) + position)[:, :2]
    axis = segments.axis[evidence.segment[chosen]]
    walked = path.position_m[:, :2]
    everything = np.vstack((points, walked))
    low, high = np.percentile(everything, (TRIM, 100 - TRIM), axis=0)
    low, high = np.minimum(low, walked.min(axis=0)) - 0.5, np.maximum(high, walked.max(axis=0)) + 0.5
    turned = results.plan.rotation_quarters % 2
    first, second = (points[axis == (turned + k) % 2] for k in range(2))
    gap = float(np.linalg.norm(path.position_m[-1] - path.position_m[0]))
    box = float(low[0]), float(-high[1]), float(high[0] - low[0]), float(high[1] - low[1])
    return View(title, note, _dots(first), _dots(second), track(walked), gap, box)


def _dots(points: Array) -> str:
    return "".join(f"M{x:.2f} {-y:.2f}h0" for x, y in points)
