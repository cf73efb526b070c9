import numpy as np

from floorplan.geometry import rotation_about_z
from floorplan.model.checks import Array
from floorplan.model.scan import GravitySource, NoiseModel, Recording, Sensor, SensorKind
from floorplan.recording_checks import frozen_start, motion_problems


def recording(position_x: Array, stamp_s: Array, yaw_rad: Array | None = None, kind: SensorKind = SensorKind.CAMERA) -> Recording:
    n = len(position_x)
    sensor = Sensor(kind, 4, 4, NoiseModel(0.01), 0.1, 5.0, 0.01)
    position = np.stack([position_x, np.zeros(n), np.zeros(n)], axis=1)
    stamps = np.round(np.asarray(stamp_s) * 1e9).astype(np.int64)
    rotation = rotation_about_z(np.zeros(n) if yaw_rad is None else yaw_rad)
    return Recording("test", sensor, stamps, position, rotation, np.full((n, 3), np.nan), GravitySource.UNKNOWN)


def codes(scan: Recording) -> dict[str, int]:
    return {problem.code: problem.count for problem in motion_problems(scan)}


WALK = 0.05 * np.arange(100) + 0.0001 * np.sin(np.arange(100))
CLOCK = 0.1 * np.arange(100)


def test_a_walk_has_no_problems() -> None:
    assert codes(recording(WALK, CLOCK)) == {}


def test_gaps_are_counted_and_the_longest_named() -> None:
    late = CLOCK + 3.0 * (np.arange(100) > 40) + 1.5 * (np.arange(100) > 60)
    (problem,) = motion_problems(recording(WALK, late))
    assert (problem.code, problem.count, problem.where) == ("frame-gap", 2, "4.000 s")
    assert "3.1 s" in problem.message


def test_jumps_and_spins_are_problems_but_a_brisk_walk_is_none() -> None:
    assert codes(recording(WALK + 0.9 * (np.arange(100) > 50), CLOCK)) == {"pose-jump": 1}
    assert codes(recording(WALK, CLOCK, 1.8 * (np.arange(100) > 50))) == {"pose-jump": 1}
    assert codes(recording(WALK * 4, CLOCK)) == {}


def test_positions_in_millimetres_are_fatal() -> None:
    problems = {p.code: p for p in motion_problems(recording(WALK * 1000, CLOCK))}
    assert problems["pose-unit"].fatal
    assert "pose-unit" not in codes(recording(WALK * 10, CLOCK))


def test_a_camera_whose_pose_repeats_exactly_had_no_odometry() -> None:
    late_start = np.concatenate([np.zeros(20), WALK[1:81]])
    assert codes(recording(late_start, CLOCK)) == {"pose-frozen": 19}
    assert frozen_start(recording(late_start, CLOCK)) == 19
    assert frozen_start(recording(WALK, CLOCK)) == 0


def test_a_robot_that_stands_still_is_no_problem() -> None:
    standing = recording(np.zeros(100), CLOCK, kind=SensorKind.LASER)
    assert codes(standing) == {}
    assert frozen_start(standing) == 0
