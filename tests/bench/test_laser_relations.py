from pathlib import Path

import numpy as np
import pytest

from floorplan.geometry import quat_xyzw_from_rotation, rotation_about_z
from floorplan.readers import open_scan
from floorplan.readers.pose_table import PoseTable
from tests.bench.laser_relations import Relations, read_relations, score


def curved_walk(offset_m: tuple[float, float] = (0.0, 0.0)) -> PoseTable:
    """200 poses on a winding path, of a point that lies `offset_m` (forward, left) behind the true one."""
    t = np.arange(200) * 0.1
    yaw = 2.0 * np.sin(t)
    position = np.stack([np.cumsum(np.cos(yaw)), np.cumsum(np.sin(yaw)), 0 * t], axis=1) * 0.05
    rotation = rotation_about_z(yaw)
    position = position - np.einsum("nij,j->ni", rotation, np.array([*offset_m, 0.0]))
    return PoseTable(np.round(t * 1e9).astype(np.int64), position, quat_xyzw_from_rotation(rotation))


def relations_of(walk: PoseTable, lag: int) -> Relations:
    first, second = np.arange(0, 200 - lag), np.arange(lag, 200)
    yaw = 2.0 * np.sin(walk.stamp_ns * 1e-9)
    step = np.einsum("nji,nj->ni", rotation_about_z(yaw[first]), walk.position_m[second] - walk.position_m[first])
    return Relations(walk.stamp_ns[first], walk.stamp_ns[second], step[:, :2], yaw[second] - yaw[first])


def test_a_true_trajectory_has_no_error() -> None:
    result = score(curved_walk(), relations_of(curved_walk(), 7))
    assert result.mean_m < 1e-9
    assert result.mean_deg < 1e-6
    assert (result.relations, result.missing) == (193, 0)


def test_a_constant_offset_of_the_reference_point_is_found_and_taken_out() -> None:
    result = score(curved_walk((0.043, -0.02)), relations_of(curved_walk(), 7))
    assert result.mean_m > 0.01
    assert result.mean_m_fitted < 1e-6
    assert (result.offset_forward_m, result.offset_left_m) == pytest.approx((0.043, -0.02), abs=1e-6)


@pytest.mark.parametrize(("name", "mean_m"), [("aces", 0.549), ("fr079", 6.504)])
def test_raw_odometry_has_the_error_that_others_measured(shared_data: Path, name: str, mean_m: float) -> None:
    recording = open_scan(shared_data / "laser" / name).recording
    poses = PoseTable(recording.stamp_ns, recording.position_m, quat_xyzw_from_rotation(recording.odom_from_sensor))
    result = score(poses, read_relations(shared_data / "laser" / name / f"{name}.relations"))
    assert result.missing == 0
    assert result.mean_m == pytest.approx(mean_m, abs=0.001)
