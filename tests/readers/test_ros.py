from contextlib import suppress
from pathlib import Path

import numpy as np
import pytest

from floorplan.config import ReadConfig
from floorplan.errors import InputError
from floorplan.model.checks import Array
from floorplan.model.scan import Frame, GravitySource, SensorKind
from floorplan.readers import open_scan
from floorplan.readers.base import BadFrame
from tests.readers.bags import BASE_FROM_CAMERA, KINDS, Bag, base_walk
from tests.readers.folders import Walk, write_tum

WALK = Walk()


def depth_bag(kind: str, encoding: str = "16UC1") -> Bag:
    bag = Bag(kind)
    bag.add_depth(WALK, encoding)
    bag.add_odometry(WALK)
    return bag


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("encoding", ["16UC1", "32FC1"])
def test_a_bag_gives_what_the_same_scan_as_tum_folder_gives(tmp_path: Path, kind: str, encoding: str) -> None:
    bag = open_scan(depth_bag(kind, encoding).write(tmp_path / "scan"))
    tum = open_scan(write_tum(tmp_path / "tum", WALK, units_per_metre=1000.0))
    np.testing.assert_array_equal(bag.recording.stamp_ns, tum.recording.stamp_ns)
    np.testing.assert_allclose(bag.recording.position_m, tum.recording.position_m, atol=1e-8)
    np.testing.assert_allclose(bag.recording.odom_from_sensor, tum.recording.odom_from_sensor, atol=1e-8)
    assert bag.recording.sensor == tum.recording.sensor
    assert bag.recording.problems == ()
    for from_bag, from_tum in zip(bag.frames([0, 5, 3, 11], 2), tum.frames([0, 5, 3, 11], 2), strict=True):
        assert isinstance(from_bag, Frame)
        assert isinstance(from_tum, Frame)
        assert from_bag.index == from_tum.index
        np.testing.assert_allclose(from_bag.points, from_tum.points, atol=1e-3 if encoding == "32FC1" else 2e-6)


def test_a_compressed_depth_image_is_the_same_png(tmp_path: Path) -> None:
    bag = Bag("db3")
    bag.add_compressed_depth(WALK)
    bag.add_odometry(WALK)
    (compressed,) = open_scan(bag.write(tmp_path / "a")).frames([4])
    (plain,) = open_scan(depth_bag("db3").write(tmp_path / "b")).frames([4])
    assert isinstance(compressed, Frame)
    assert isinstance(plain, Frame)
    np.testing.assert_array_equal(compressed.points, plain.points)


@pytest.mark.parametrize("pose_by", ["odometry", "tf"])
def test_a_camera_on_a_robot_is_posed_through_its_static_mounting(tmp_path: Path, pose_by: str) -> None:
    bag, (position, rotation) = Bag("mcap"), base_walk(WALK)
    bag.add_depth(WALK)
    bag.add_mounting(WALK.stamp_s[0] - 1)
    for stamp, p, r in zip(WALK.stamp_s.tolist(), position, rotation, strict=True):
        bag.add_tf("odom", "base_link", stamp, p, r)
        bag.add_tf("map", "odom", stamp, np.array([stamp, 0, 0]), np.eye(3))  # jumps about: must not be used
    if pose_by == "odometry":
        moving = Walk()
        object.__setattr__(moving, "position_m", position)
        object.__setattr__(moving, "rotation", rotation)
        bag.add_odometry(moving, child="base_link")
    recording = open_scan(bag.write(tmp_path / "robot")).recording
    np.testing.assert_allclose(recording.position_m, WALK.position_m, atol=1e-9)
    np.testing.assert_allclose(recording.odom_from_sensor, WALK.rotation, atol=1e-9)


def test_an_unknown_mounting_is_a_problem(tmp_path: Path) -> None:
    bag = Bag("db3")
    bag.add_depth(WALK)
    bag.add_odometry(WALK, child="base_link")
    assert [p.code for p in open_scan(bag.write(tmp_path / "a")).recording.problems] == ["transform-missing"]


@pytest.mark.parametrize("kind", KINDS)
def test_sweeps_are_level_grids_of_one_row(tmp_path: Path, kind: str) -> None:
    bag, ranges = Bag(kind), np.linspace(1.0, 5.0, 41)
    ranges[3], ranges[7] = np.inf, 20.0
    bag.add_sweeps(WALK, ranges)
    bag.add_odometry(Walk(), child="laser")
    source = open_scan(bag.write(tmp_path / "laser"))
    assert (source.recording.sensor.kind, source.recording.gravity_source) == (SensorKind.LASER, GravitySource.LEVEL)
    (frame,) = source.frames([2])
    assert isinstance(frame, Frame)
    assert frame.points.shape == (1, 41, 3)
    assert np.flatnonzero(np.isnan(frame.points[0, :, 0])).tolist() == [3, 7]
    np.testing.assert_allclose(frame.points[0, 20], [ranges[20], 0, 0], atol=1e-5)
    assert frame.points[0, 40, 1] == pytest.approx(5.0 * np.sin(1.0), abs=1e-5)  # counter-clockwise


@pytest.mark.parametrize("type", ["PoseStamped", "PoseWithCovarianceStamped", "TransformStamped"])
def test_poses_come_from_every_type_that_holds_them(tmp_path: Path, type: str) -> None:
    bag = Bag("mcap")
    bag.add_depth(WALK)
    bag.add_poses(WALK, type)
    recording = open_scan(bag.write(tmp_path / "scan")).recording
    np.testing.assert_allclose(recording.position_m, WALK.position_m, atol=1e-9)
    np.testing.assert_allclose(recording.odom_from_sensor, WALK.rotation, atol=1e-9)


@pytest.mark.parametrize("imu_from_camera", [np.eye(3), BASE_FROM_CAMERA])
def test_gravity_comes_from_the_imu_through_its_mounting(tmp_path: Path, imu_from_camera: Array) -> None:
    bag, walk = Bag("db3"), Walk(frames=60)
    bag.add_depth(walk)
    bag.add_odometry(walk)
    up_world = np.array([0.3, -0.5, 0.8]) / np.linalg.norm([0.3, -0.5, 0.8])
    bag.add_imu(walk, 9.81 * np.einsum("ij,nkj,k->ni", imu_from_camera, walk.rotation, up_world))
    bag.add_tf("camera_optical", "imu", walk.stamp_s[0] - 1, np.zeros(3), imu_from_camera.T, "/tf_static")
    recording = open_scan(bag.write(tmp_path / "scan")).recording
    assert (recording.gravity_source, recording.problems) == (GravitySource.IMU, ())
    down_world = np.einsum("nij,nj->ni", recording.odom_from_sensor, recording.down_sensor)
    np.testing.assert_allclose(down_world, np.tile(-up_world, (60, 1)), atol=1e-9)


def test_an_imu_whose_mounting_is_unknown_is_not_used(tmp_path: Path) -> None:
    bag = depth_bag("mcap")
    bag.add_imu(WALK, np.tile([0.0, 0.0, 9.81], (12, 1)))
    recording = open_scan(bag.write(tmp_path / "scan")).recording
    assert recording.gravity_source is GravitySource.UNKNOWN
    assert [p.code for p in recording.problems] == ["transform-missing"]


def test_a_gap_of_the_odometry_leaves_frames_out_and_is_reported_with_its_length(tmp_path: Path) -> None:
    bag, walk = Bag("db3"), Walk(frames=60)
    bag.add_depth(walk)
    bag.add_odometry(walk, skip=range(20, 40))
    recording = open_scan(bag.write(tmp_path / "scan")).recording
    assert 38 <= len(recording) <= 42
    (problem,) = [p for p in recording.problems if p.code == "pose-gap"]
    assert problem.count == 60 - len(recording)
    assert f"{walk.stamp_s[40] - walk.stamp_s[19]:.1f} s" in problem.message


def test_an_organised_cloud_is_its_own_grid(tmp_path: Path) -> None:
    points = np.random.default_rng(3).uniform(1, 4, (16, 90, 3)).astype(np.float32)
    points[2, 5] = 0.0
    bag = Bag("mcap")
    bag.add_cloud(WALK, points)
    bag.add_odometry(WALK, child="lidar")
    source = open_scan(bag.write(tmp_path / "lidar"))
    (frame,) = source.frames([0])
    assert isinstance(frame, Frame)
    assert source.recording.sensor.kind is SensorKind.LIDAR
    assert np.isnan(frame.points[2, 5]).all()
    points[2, 5] = np.nan
    np.testing.assert_array_equal(frame.points, points)


@pytest.mark.parametrize("told", [True, False])
def test_a_cloud_without_a_grid_is_put_on_rings_and_columns(tmp_path: Path, told: bool) -> None:
    rng = np.random.default_rng(4)
    up = np.deg2rad(np.linspace(-15, 15, 16))[:, None]
    around = (-np.pi + 2 * np.pi * (np.arange(180) + 0.5) / 180)[None]
    rays = np.stack(np.broadcast_arrays(np.cos(up) * np.cos(around), np.cos(up) * np.sin(around), np.sin(up)), axis=-1)
    expected = (rays * rng.uniform(1, 9, (16, 180, 1))).astype(np.float32)
    expected[rng.random((16, 180)) < 0.2] = np.nan
    seen = np.flatnonzero(np.isfinite(expected[..., 0]))
    rng.shuffle(seen)
    bag = Bag("db3")
    bag.add_loose_cloud(WALK, expected.reshape(-1, 3)[seen], seen // 180 if told else None)
    bag.add_odometry(WALK, child="lidar")
    source = open_scan(bag.write(tmp_path / "lidar"))
    (frame,) = source.frames([1])
    assert isinstance(frame, Frame)
    assert source.recording.gravity_source is GravitySource.WORLD
    np.testing.assert_array_equal(frame.points, expected)


def test_a_definition_that_cannot_be_parsed_hides_no_other_topic(tmp_path: Path) -> None:
    walk = Walk()
    plain, odd = Bag("mcap"), Bag("mcap", unreadable_definition=True)
    for bag in (plain, odd):
        bag.add_depth(walk)
        bag.add_odometry(walk)
    want, got = open_scan(plain.write(tmp_path / "plain")), open_scan(odd.write(tmp_path / "odd"))
    assert len(got.recording) == len(want.recording) == len(walk.stamp_s)
    assert got.recording.problems == want.recording.problems
    for a, b in zip(got.frames([0, 5]), want.frames([0, 5]), strict=True):
        assert isinstance(a, Frame)
        assert isinstance(b, Frame)
        np.testing.assert_array_equal(a.points, b.points)


def test_a_git_lfs_pointer_in_place_of_a_bag_is_told_as_such(tmp_path: Path) -> None:
    (tmp_path / "walk.mcap").write_text("version https://git-lfs.github.com/spec/v1\noid sha256:0\nsize 1\n")
    with pytest.raises(InputError, match="git lfs pull"):
        open_scan(tmp_path / "walk.mcap")


def test_several_depth_topics_are_listed_with_the_setting_that_chooses(tmp_path: Path) -> None:
    bag = depth_bag("db3")
    bag.add_depth(WALK, topic="/rear/depth/image")
    path = bag.write(tmp_path / "two")
    with pytest.raises(InputError, match=r"/camera/depth/image.*/rear/depth/image.*--topic depth=.*read\.range_topic"):
        open_scan(path)
    assert len(open_scan(path, config=ReadConfig(range_topic="/rear/depth/image")).recording) == 12


def test_a_bag_without_poses_and_one_that_is_none_say_so(tmp_path: Path) -> None:
    bag = Bag("bag")
    bag.add_depth(WALK)
    with pytest.raises(InputError, match="no topic holds poses"):
        open_scan(bag.write(tmp_path / "still"))
    (tmp_path / "not.bag").write_bytes(b"#ROSBAG V2.0\n but nothing else")
    with pytest.raises(InputError, match="cannot be opened"):
        open_scan(tmp_path / "not.bag")


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("share", [0.5, 0.97])
def test_a_cut_bag_gives_the_frames_before_the_cut_and_says_how_many_messages_there_were(tmp_path: Path, kind: str, share: float) -> None:
    bag, walk = Bag(kind), Walk(frames=80)
    bag.add_depth(walk)
    bag.add_odometry(walk)
    whole = open_scan(bag.write(tmp_path / "whole"))
    cut = open_scan(cut_copy(bag.write(tmp_path / "again"), tmp_path / f"cut.{kind}", share))
    count = len(cut.recording)
    assert (share - 0.1) * 80 <= count <= (share + 0.05) * 80  # what is not frames is at the file's ends
    np.testing.assert_array_equal(cut.recording.stamp_ns, whole.recording.stamp_ns[:count])
    np.testing.assert_allclose(cut.recording.position_m, whole.recording.position_m[:count], atol=1e-9)
    (problem,) = [p for p in cut.recording.problems if p.code == "bag-cut"]
    assert f"{3 * count}" in problem.message or f"{3 * count + 1}" in problem.message or f"{3 * count + 2}" in problem.message
    for mine, theirs in zip(cut.frames([0, count - 1, 1]), whole.frames([0, count - 1, 1]), strict=True):
        assert isinstance(mine, Frame)
        assert isinstance(theirs, Frame)
        np.testing.assert_array_equal(mine.points, theirs.points)


@pytest.mark.parametrize("kind", ["db3", "mcap"])
@pytest.mark.parametrize("seed", range(4))
def test_bytes_that_rotted_anywhere_cost_frames_and_no_traceback(tmp_path: Path, kind: str, seed: int) -> None:
    bag, walk = Bag(kind), Walk(frames=30)
    bag.add_depth(walk)
    bag.add_odometry(walk)
    file = next(f for f in bag.write(tmp_path / "scan").iterdir() if f.suffix != ".yaml")
    data, random = bytearray(file.read_bytes()), np.random.default_rng(seed)
    start, size = int(random.integers(len(data))), int(random.choice([20, 2000, 20000]))
    hole = random.integers(0, 256, size, dtype=np.uint8).tobytes()
    data[start : start + size] = hole[: len(data) - start]
    file.write_bytes(data)
    with suppress(InputError):
        source = open_scan(file)
        assert 0 < len(list(source.frames(range(len(source.recording))))) <= 30


def cut_copy(bag: Path, to: Path, share: float) -> Path:
    """The first part of the bag's file, without metadata."""
    file = bag if bag.is_file() else next(f for f in bag.iterdir() if f.suffix != ".yaml")
    data = file.read_bytes()
    to.write_bytes(data[: int(len(data) * share)])
    return to


def test_a_cut_bag_in_its_folder_is_measured_by_the_metadata(tmp_path: Path) -> None:
    folder = depth_bag("db3").write(tmp_path / "scan")
    file = next(folder.glob("*.db3"))
    file.write_bytes(file.read_bytes()[: file.stat().st_size // 2])
    (problem,) = open_scan(folder).recording.problems
    assert "of 36 messages" in problem.message


@pytest.mark.parametrize("kind", ["db3", "mcap"])
def test_a_folder_without_metadata_is_read_by_its_files(tmp_path: Path, kind: str) -> None:
    folder = depth_bag(kind).write(tmp_path / "scan")
    (folder / "metadata.yaml").unlink()
    assert open_scan(folder).recording.problems == ()


def test_the_real_bag_without_depth_lists_its_topics(shared_data: Path) -> None:
    with pytest.raises(InputError, match=r"no topic holds depth images.*/crazyflie2/state_xyzv"):
        open_scan(shared_data / "bag/rice.bag")


def test_a_first_message_that_is_damaged_costs_one_frame_and_all_of_them_say_why(tmp_path: Path) -> None:
    bag, walk = Bag("mcap"), Walk(frames=12)
    bag.add_depth(walk)
    bag.add_odometry(walk)
    images = [value for _, type, _, value in bag.written if type.endswith("msg/Image")]
    whole = images[0].data
    images[0].data = whole[:100]
    source = open_scan(bag.write(tmp_path / "one"))
    assert [isinstance(frame, BadFrame) for frame in source.frames(range(12))] == [True] + 11 * [False]
    for image in images:
        image.data = whole[:100]
    with pytest.raises(InputError, match="holds 100 bytes, not"):
        open_scan(bag.write(tmp_path / "all"))


def test_sweeps_without_an_angle_between_their_beams_are_refused(tmp_path: Path) -> None:
    bag, walk = Bag("mcap"), Walk(frames=12)
    bag.add_sweeps(walk, np.linspace(1.0, 5.0, 90))
    bag.add_odometry(walk, child="laser")
    for _, type, _, value in bag.written:
        if type.endswith("LaserScan"):
            value.angle_increment = 0.0
    with pytest.raises(InputError, match="no angle between its beams"):
        open_scan(bag.write(tmp_path / "flat"))
