"""Scores a trajectory on the human-verified relations of a laser log.

    python -m tests.bench.laser_relations TRAJECTORY.tum RELATIONS

A relation says how the robot at t2 is seen from the robot at t1 (Kuemmerle et al. 2009, "On measuring the accuracy of
SLAM algorithms"). Its error is the difference to the same relative pose in the trajectory. The relations refer to a
point some centimetres ahead of the odometry's; one constant offset (forward, left) of the trajectory's reference point
is fitted over all relations, and the errors are given with and without it.
"""

import argparse
import json
import sys
from dataclasses import asdict, dataclass
from pathlib import Path

import numpy as np

from floorplan.geometry import rotation_from_quat_xyzw, wrap_to
from floorplan.model.checks import Array
from floorplan.readers.pose_table import PoseTable, read_tum_trajectory, stamp_ns_from_text, text_lines

FIT_ROUNDS = 30  # of reweighting: the error's norm is what counts, not its square
LEAST_ERROR_M = 1e-4  # so that a perfect relation does not take all the weight
MAX_STAMP_DIFFERENCE_NS = 2_000  # stamps are written with 6 decimals


@dataclass(frozen=True)
class Relations:
    """R relations: `first_ns (R,)`, `second_ns (R,)`, `move_m (R, 2)` and `turn_rad (R,)` of the second seen from the first."""

    first_ns: Array
    second_ns: Array
    move_m: Array
    turn_rad: Array


@dataclass(frozen=True)
class Score:
    """Errors over the relations whose stamps the trajectory has; metres and degrees; *_fitted: with the offset below."""

    relations: int
    missing: int
    mean_m: float
    std_m: float
    median_m: float
    mean_m_fitted: float
    std_m_fitted: float
    median_m_fitted: float
    offset_forward_m: float
    offset_left_m: float
    mean_deg: float
    std_deg: float


def read_relations(path: Path) -> Relations:
    """Lines `t1 t2 dx dy dz roll pitch yaw`."""
    rows = [line.split() for line in text_lines(path)]
    numbers = np.array([[float(cell) for cell in row[2:8]] for row in rows])
    first, second = (np.array([stamp_ns_from_text(row[i]) for row in rows], dtype=np.int64) for i in (0, 1))
    return Relations(first, second, numbers[:, :2], numbers[:, 5])


def score(trajectory: PoseTable, relations: Relations) -> Score:
    """The errors of a trajectory (sorted by stamp, z up) over the relations."""
    rows = [_rows_of(trajectory.stamp_ns, stamps) for stamps in (relations.first_ns, relations.second_ns)]
    known = (rows[0] >= 0) & (rows[1] >= 0)
    first, second = rows[0][known], rows[1][known]
    yaw = _yaw(trajectory)
    turn = yaw[second] - yaw[first]
    back = _rotation(-yaw[first])
    step = trajectory.position_m[second, :2] - trajectory.position_m[first, :2]
    error = np.einsum("rij,rj->ri", back, step) - relations.move_m[known]
    lever = _rotation(turn) - np.eye(2)  # what an offset of the reference point adds: (R(turn) - 1) offset
    offset = _fit(lever, error)
    plain, fitted = np.linalg.norm(error, axis=1), np.linalg.norm(error + lever @ offset, axis=1)
    degrees = np.rad2deg(np.abs(wrap_to(turn - relations.turn_rad[known], 2 * np.pi)))
    return Score(
        relations=int(known.sum()),
        missing=int((~known).sum()),
        mean_m=float(plain.mean()),
        std_m=float(plain.std()),
        median_m=float(np.median(plain)),
        mean_m_fitted=float(fitted.mean()),
        std_m_fitted=float(fitted.std()),
        median_m_fitted=float(np.median(fitted)),
        offset_forward_m=float(offset[0]),
        offset_left_m=float(offset[1]),
        mean_deg=float(degrees.mean()),
        std_deg=float(degrees.std()),
    )


def _rows_of(stamp_ns: Array, wanted_ns: Array) -> Array:
    """Row of each wanted stamp, -1 where the trajectory lacks it."""
    after = np.clip(np.searchsorted(stamp_ns, wanted_ns), 1, len(stamp_ns) - 1)
    nearer = np.where(wanted_ns - stamp_ns[after - 1] < stamp_ns[after] - wanted_ns, after - 1, after)
    return np.where(np.abs(stamp_ns[nearer] - wanted_ns) <= MAX_STAMP_DIFFERENCE_NS, nearer, -1)


def _yaw(trajectory: PoseTable) -> Array:
    rotation = rotation_from_quat_xyzw(trajectory.quat_xyzw)
    return np.arctan2(rotation[:, 1, 0], rotation[:, 0, 0])


def _rotation(angle_rad: Array) -> Array:
    c, s = np.cos(angle_rad), np.sin(angle_rad)
    return np.stack([np.stack([c, -s], axis=-1), np.stack([s, c], axis=-1)], axis=-2)


def _fit(lever: Array, error: Array) -> Array:
    """The offset (2,) that minimises the mean of |error + lever offset|, by reweighted least squares."""
    offset = np.zeros(2)
    for _ in range(FIT_ROUNDS):
        weight = 1.0 / np.maximum(np.linalg.norm(error + lever @ offset, axis=1), LEAST_ERROR_M)
        normal = np.einsum("rij,r,rik->jk", lever, weight, lever)
        offset = np.linalg.lstsq(normal, -np.einsum("rij,r,ri->j", lever, weight, error), rcond=None)[0]
    return offset


def main() -> None:
    """Print the score as JSON."""
    parser = argparse.ArgumentParser(description="Score a trajectory on the relations of a laser log.")
    parser.add_argument("trajectory", type=Path)
    parser.add_argument("relations", type=Path)
    given = parser.parse_args()
    table = read_tum_trajectory(given.trajectory)
    sys.stdout.write(json.dumps(asdict(score(table.rows(np.argsort(table.stamp_ns)), read_relations(given.relations))), indent=1) + "\n")


if __name__ == "__main__":
    main()
