"""What is odd about a laser log's columns: ranges that are no metres, headings in degrees, odometry that stands still."""

from dataclasses import dataclass

import numpy as np

from floorplan.model.checks import Array
from floorplan.model.scan import Problem

FARTHEST_USUAL_M = 60.0  # half of a level laser's beams indoors end within a few metres, in the largest halls within tens
TYPICAL_M = (0.5, 20.0)
COMMON_SCALES = (100.0, 1000.0)  # centimetres, millimetres
LEAST_STEP_M = 0.02  # motion whose direction is worth looking at
FEWEST_STEPS = 20
AHEAD, ASTRAY = 0.9, 0.7  # mean squared cosine between motion and heading: wheels roll ahead or back, a random heading gives 0.5


@dataclass(frozen=True)
class Headings:
    """`yaw_rad (N,)` and the problem that was mended, if there was one."""

    yaw_rad: Array
    problems: tuple[Problem, ...]


def range_unit_problems(ranges: Array, where: str) -> tuple[Problem, ...]:
    """A fatal problem where sweeps `ranges (N, B)`, read as metres, see further than any building is wide."""
    seen = ranges[np.isfinite(ranges)]
    median = float(np.median(seen)) if seen.size else 0.0
    if median <= FARTHEST_USUAL_M:
        return ()
    fitting = next((scale for scale in COMMON_SCALES if TYPICAL_M[0] <= median / scale <= TYPICAL_M[1]), None)
    advice = "set read.depth_scale (range units per metre)"
    advice += f"; with {fitting:g} half of the readings would lie beyond {median / fitting:.2f} m" if fitting else ""
    message = f"half of the readings lie beyond {median:.0f} m: they are not metres"
    return (Problem("range-unit", message, where, advice=advice, fatal=True),)


def headings_in_radians(pose_xy_yaw: Array, where: str) -> Headings:
    """The headings of poses (N, 3), turned into radians where they are degrees: only then does the robot drive the way it looks."""
    yaw = pose_xy_yaw[:, 2]
    known = np.isfinite(pose_xy_yaw).all(axis=1)
    widest = np.abs(yaw[known]).max(initial=0.0)
    as_written, as_degrees = (_ahead(pose_xy_yaw[known], unit) for unit in (1.0, np.pi / 180))
    if widest <= 2 * np.pi or as_written > ASTRAY or as_degrees < AHEAD:
        return Headings(yaw, ())
    message = "headings are degrees, not radians: read as such, the robot drives the way it looks"
    return Headings(np.deg2rad(yaw), (Problem("heading-unit", message, where, advice="write headings in radians"),))


def _ahead(pose: Array, unit_rad: float) -> float:
    """Mean squared cosine between motion and heading; 1 where too little moves to tell."""
    step = np.diff(pose[:, :2], axis=0)
    far = np.hypot(step[:, 0], step[:, 1]) > LEAST_STEP_M
    if far.sum() < FEWEST_STEPS:
        return 1.0
    heading = 0.5 * unit_rad * (pose[:-1, 2] + pose[1:, 2])
    off = np.arctan2(step[far, 1], step[far, 0]) - heading[far]
    return float(np.mean(np.cos(off) ** 2))


def stands_still(pose_xy_yaw: Array) -> bool:
    """Whether poses (N, 3) of more than one sweep are all the same."""
    return len(pose_xy_yaw) > 1 and bool((pose_xy_yaw == pose_xy_yaw[:1]).all())
