import numpy as np

from floorplan.geometry import rotation_about_z
from floorplan.keyframes import select_keyframes


def chosen(position_x: np.ndarray, yaw_deg: np.ndarray, gap_s: float = 1.0) -> list[int]:
    n = len(position_x)
    position = np.stack([position_x, np.zeros(n), np.zeros(n)], axis=1)
    stamps = (np.arange(n) * 0.1 * 1e9).astype(np.int64)
    return select_keyframes(stamps, position, rotation_about_z(np.deg2rad(yaw_deg)), 0.1, np.deg2rad(4.0), gap_s).tolist()


def test_a_steady_walk_gives_one_keyframe_per_distance() -> None:
    assert chosen(np.arange(11) * 0.051, np.zeros(11)) == [0, 2, 4, 6, 8, 10]


def test_turning_on_the_spot_gives_one_keyframe_per_angle() -> None:
    assert chosen(np.zeros(9), np.arange(9) * 2.01) == [0, 2, 4, 6, 8]


def test_standing_still_gives_one_keyframe_per_second_and_the_last_frame() -> None:
    assert chosen(np.zeros(25), np.zeros(25)) == [0, 10, 20, 24]


def test_angles_add_up_over_slow_turns_and_moves_back_count() -> None:
    assert chosen(np.array([0.0, 0.06, 0.0, -0.06, -0.11]), np.zeros(5)) == [0, 4]
    assert chosen(np.zeros(4), np.array([0.0, 3.0, -0.5, -3.0]))[:2] == [0, 3]


def test_an_empty_recording_has_no_keyframes() -> None:
    assert chosen(np.zeros(0), np.zeros(0)) == []
