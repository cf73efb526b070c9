"""Every frame gets a pose: keyframes exactly theirs, the others by odometry with the closing error spread over the path."""

from pathlib import Path

import numpy as np

from floorplan.geometry import rotation_about_z, rotation_from_vector, vector_from_rotation
from floorplan.model.scan import GravitySource, IngestedScan, NoiseModel, Recording, Sensor, SensorKind, Trajectory
from floorplan.trajectory import PlanFrame, every_frame, in_plan_frame, keyframe_trajectory, odometry_trajectory
from floorplan.writers.tum import write_tum

SENSOR = Sensor(SensorKind.LASER, 1, 180, NoiseModel(0.01), 0.1, 30.0, 0.017)


def walk(frames: int = 41, seed: int = 3) -> tuple[Trajectory, Recording]:
    """A true walk, and a recording whose odometry lies in another world, drifts by 2 % and bends by 0.2 degrees a frame."""
    rng = np.random.default_rng(seed)
    yaw = np.cumsum(rng.normal(0, 0.05, frames))
    rotation = rotation_about_z(yaw)
    steps = rotation[:-1] @ np.array([0.1, 0, 0]) + rng.normal(0, 0.001, (frames - 1, 3))
    position = np.concatenate((np.zeros((1, 3)), np.cumsum(steps, 0)))
    bend = rotation_about_z(np.deg2rad(37 + 0.2 * np.arange(frames)))
    odom_steps = np.einsum("nij,nj->ni", bend[:-1], 1.02 * steps)
    odom_position = np.array([5.0, -3, 1]) + np.concatenate((np.zeros((1, 3)), np.cumsum(odom_steps, 0)))
    stamp = 1_000_000_000_000_000_001 + 33_000_000 * np.arange(frames)
    down = np.tile([0.0, 0, -1], (frames, 1))
    recording = Recording("test", SENSOR, stamp, odom_position, bend @ rotation, down, GravitySource.LEVEL)
    return Trajectory(stamp, position, rotation), recording


def test_keyframes_keep_their_poses_and_the_others_come_within_the_drift_of_one_span() -> None:
    truth, recording = walk()
    scan = IngestedScan(recording, np.arange(0, 41, 5))
    solved = keyframe_trajectory(scan, truth.world_from_sensor[scan.keyframe], truth.position_m[scan.keyframe])
    result = every_frame(scan, solved)
    np.testing.assert_array_equal(result.stamp_ns, recording.stamp_ns)
    np.testing.assert_allclose(result.position_m[scan.keyframe], truth.position_m[scan.keyframe], atol=1e-12)
    np.testing.assert_allclose(result.world_from_sensor, truth.world_from_sensor, atol=5e-4)  # steps differ in length
    error = np.linalg.norm(result.position_m - truth.position_m, axis=1)
    assert 1e-6 < error.max() < 0.5 * np.deg2rad(1.0) * 0.5  # a span bends by one degree over half a metre


def test_frames_outside_the_keyframes_follow_the_odometry() -> None:
    truth, recording = walk()
    scan = IngestedScan(recording, np.array([10, 20]))
    solved = keyframe_trajectory(scan, truth.world_from_sensor[[10, 20]], truth.position_m[[10, 20]])
    result = every_frame(scan, solved)
    for frame, anchor in ((0, 10), (40, 20)):
        walked = np.linalg.norm(recording.position_m[frame] - recording.position_m[anchor])
        np.testing.assert_allclose(np.linalg.norm(result.position_m[frame] - truth.position_m[anchor]), walked, rtol=1e-12)


def test_a_standing_sensor_and_a_single_keyframe_need_no_special_care() -> None:
    recording = Recording(
        "test", SENSOR, np.arange(3), np.zeros((3, 3)), np.tile(np.eye(3), (3, 1, 1)), np.zeros((3, 3)), GravitySource.LEVEL
    )
    for keyframe in ([0], [1], [0, 2]):
        scan = IngestedScan(recording, np.array(keyframe))
        solved = keyframe_trajectory(scan, np.tile(np.eye(3), (len(keyframe), 1, 1)), np.ones((len(keyframe), 3)))
        np.testing.assert_allclose(every_frame(scan, solved).position_m, 1.0)


def test_odometry_is_only_moved_as_a_whole() -> None:
    truth, recording = walk()
    scan = IngestedScan(recording, np.array([0, 40]))
    raw = odometry_trajectory(scan, truth.world_from_sensor[0])
    np.testing.assert_allclose(raw.position_m[0], 0, atol=1e-12)
    np.testing.assert_allclose(raw.world_from_sensor[0], truth.world_from_sensor[0], atol=1e-12)
    steps = np.linalg.norm(np.diff(raw.position_m, axis=0), axis=1)
    np.testing.assert_allclose(steps, np.linalg.norm(np.diff(recording.position_m, axis=0), axis=1), rtol=1e-9)
    end_error = np.linalg.norm(raw.position_m[-1] - truth.position_m[-1])
    assert 0.1 < end_error < 1.0


def test_the_plan_frame_is_a_quarter_turn_and_a_shift() -> None:
    truth, _ = walk(3)
    turned = in_plan_frame(truth, PlanFrame(1, np.array([1.0, 2.0, 3.0])))
    np.testing.assert_array_equal(turned.position_m[:, 0], 1.0 - truth.position_m[:, 1])
    np.testing.assert_array_equal(turned.position_m[:, 1], 2.0 + truth.position_m[:, 0])
    turn = turned.world_from_sensor[1] @ truth.world_from_sensor[1].T
    np.testing.assert_allclose(turn, rotation_about_z(np.array(np.pi / 2)), atol=1e-12)


def test_rotation_vectors_come_back_up_to_half_a_turn() -> None:
    rng = np.random.default_rng(5)
    vector = rng.normal(size=(50, 3))
    vector *= (rng.uniform(0, 3.1, 50) / np.linalg.norm(vector, axis=1))[:, None]
    vector[0] = 0
    vector[1] *= 1e-9
    np.testing.assert_allclose(vector_from_rotation(rotation_from_vector(vector)), vector, atol=1e-9)


def test_written_stamps_are_exact_to_the_nanosecond(tmp_path: Path) -> None:
    truth, _ = walk(2)
    write_tum(truth, tmp_path / "t.tum")
    lines = (tmp_path / "t.tum").read_text().splitlines()
    assert lines[1].startswith("1000000000.000000001 0.000000 0.000000 0.000000 ")
    assert lines[2].startswith("1000000000.033000001 ")
    assert all(len(line.split()) == 8 for line in lines[1:])
