"""The paper's composite figure: the same depth points and path after each step of the method, beside each other."""

from dataclasses import dataclass

import numpy as np

from floorplan.model.checks import Array
from floorplan.model.scan import Trajectory
from floorplan.placed_points import placed_points, points_on_segments
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
    frame = PlanFrame(results.plan.rotation_quarters, results.plan.shift_m)
    raw = in_plan_frame(odometry_trajectory(results.scan, results.segmented.frames.world_from_sensor[0]), frame)
    steps = (
        ("Odometry", "as recorded", raw),
        ("Compass", "yaw from the walls", paths.compass),
        ("Least squares", "walls tracked, none merged", paths.least_squares),
        ("Final", "walls merged", paths.final),
    )
    chosen = points_on_segments(results, DRAWN_POINTS, upright_only=True)
    return tuple(_view(title, note, path, results, chosen) for title, note, path in steps)


def _view(title: str, note: str, path: Trajectory, results: Results, chosen: Array) -> View:
    placed = placed_points(results, path, chosen)
    points = placed.point_m[:, :2]
    walked = path.position_m[:, :2]
    everything = np.vstack((points, walked))
    low, high = np.percentile(everything, (TRIM, 100 - TRIM), axis=0)
    low, high = np.minimum(low, walked.min(axis=0)) - 0.5, np.maximum(high, walked.max(axis=0)) + 0.5
    first, second = (points[placed.axis == k] for k in range(2))
    gap = float(np.linalg.norm(path.position_m[-1] - path.position_m[0]))
    box = float(low[0]), float(-high[1]), float(high[0] - low[0]), float(high[1] - low[1])
    return View(title, note, _dots(first), _dots(second), track(walked), gap, box)


def _dots(points: Array) -> str:
    return "".join(f"M{x:.2f} {-y:.2f}h0" for x, y in points)
