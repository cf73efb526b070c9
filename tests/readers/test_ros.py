from pathlib import Path

import numpy as np
import pytest

from floorplan.config import ReadConfig
from floorplan.errors import InputError
from floorplan.model.scan import Frame, GravitySource, SensorKind
from floorplan.readers import open_scan
from tests.readers.bags import KINDS, Bag, base_walk
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


def test_several_depth_topics_are_listed_with_the_setting_that_chooses(tmp_path: Path) -> None:
    bag = depth_bag("db3")
    bag.add_depth(WALK, topic="/rear/depth/image")
    path = bag.write(tmp_path / "two")
    with pytest.raises(InputError, match=r"/camera/depth/image.*/rear/depth/image.*read\.range_topic"):
        open_scan(path)
    assert len(open_scan(path, config=ReadConfig(range_topic="/rear/depth/image")).recording) == 12


def test_a_bag_without_metadata_is_read_by_its_files(tmp_path: Path) -> None:
    folder = depth_bag("mcap").write(tmp_path / "scan")
    (folder / "metadata.yaml").unlink()
    assert len(open_scan(folder).recording) == 12


def test_a_bag_without_poses_and_one_that_is_none_say_so(tmp_path: Path) -> None:
    bag = Bag("bag")
    bag.add_depth(WALK)
    with pytest.raises(InputError, match="no topic holds poses"):
        open_scan(bag.write(tmp_path / "still"))
    (tmp_path / "not.bag").write_bytes(b"#ROSBAG V2.0\n but nothing else")
    with pytest.raises(InputError, match="cannot be opened"):
        open_scan(tmp_path / "not.bag")


@pytest.mark.parametrize(("kind", "remedy"), [("bag", "rosbag reindex"), ("db3", r"\.recover"), ("mcap", "mcap recover")])
def test_a_bag_cut_in_half_is_refused_with_the_tool_that_mends_it(tmp_path: Path, kind: str, remedy: str) -> None:
    bag = Bag(kind)
    bag.add_depth(Walk(frames=40))
    bag.add_odometry(Walk(frames=40))
    whole = bag.write(tmp_path / "whole")
    file = whole if whole.is_file() else next(f for f in whole.iterdir() if f.suffix != ".yaml")
    data = file.read_bytes()
    (tmp_path / f"cut.{kind}").write_bytes(data[: len(data) // 2])
    with pytest.raises(InputError, match=remedy):
        open_scan(tmp_path / f"cut.{kind}")


def test_the_real_bag_without_depth_lists_its_topics(shared_data: Path) -> None:
    with pytest.raises(InputError, match=r"no topic holds depth images.*/crazyflie2/state_xyzv"):
        open_scan(shared_data / "bag/rice.bag")
