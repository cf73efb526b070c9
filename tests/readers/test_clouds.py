"""Folders of LiDAR clouds: the same simulated sweeps in every layout are the same recording; damaged ones say why."""

from pathlib import Path

import numpy as np
import pytest

from floorplan.errors import InputError
from floorplan.geometry import quat_xyzw_from_rotation, rotation_about_z
from floorplan.model.checks import Array
from floorplan.model.scan import Frame, GravitySource, SensorKind
from floorplan.readers import Source, open_scan, reader_for
from floorplan.readers.base import BadFrame
from floorplan.readers.cloud_files import read_cloud
from floorplan.readers.lzf import unpack_lzf
from floorplan.simulate import simulate
from floorplan.simulate.write_clouds import pcd_bytes, ply_bytes

KINDS = ("ply", "pcd", "kitti")


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("clouds")
    for name in (*KINDS, "mcap"):
        simulate(folder / name, "flat", 2, format=name, sensor="lidar16", rate_hz=0.5, image_scale=0.4)
    return folder


def frame(source: Source, row: int) -> Frame:
    read = next(iter(source.frames([row])))
    assert isinstance(read, Frame)
    return read


@pytest.mark.parametrize("kind", KINDS)
def test_every_layout_is_recognised_and_gives_the_grid_and_poses_of_the_bag(folder: Path, kind: str) -> None:
    assert reader_for(folder / kind).name == "clouds"
    source, bag = open_scan(folder / kind), open_scan(folder / "mcap")
    recording, want = source.recording, bag.recording
    assert recording.sensor.kind is SensorKind.LIDAR
    assert (recording.sensor.height, recording.sensor.width) == (want.sensor.height, want.sensor.width) == (16, 360)
    assert (recording.stamp_ns == want.stamp_ns).all()
    np.testing.assert_allclose(recording.position_m, want.position_m, atol=1e-6)
    np.testing.assert_allclose(recording.odom_from_sensor, want.odom_from_sensor, atol=2e-6)
    assert recording.gravity_source is GravitySource.WORLD
    assert recording.problems == ()
    for row in (0, 5, 12):
        np.testing.assert_allclose(frame(source, row).points, frame(bag, row).points, atol=1e-6)
        assert np.isfinite(frame(source, row).points).mean() > 0.5


def cloud() -> Array:
    return np.random.default_rng(7).normal(0, 3, (50, 3)).astype("<f4")


def test_text_big_endian_and_organised_clouds_are_read(tmp_path: Path) -> None:
    points = cloud()
    rows = "\n".join(" ".join(f"{value:.6f}" for value in row) + " 9" for row in points)
    head = "ply\nformat ascii 1.0\ncomment made by hand\nelement vertex 50\n"
    fields = "property float x\nproperty float y\nproperty float z\nproperty uchar ring\nelement face 0\nend_header\n"
    (tmp_path / "a.ply").write_text(head + fields + rows)
    text = read_cloud(tmp_path / "a.ply")
    np.testing.assert_allclose(text.points[0], points, atol=1e-5)
    assert text.ring is not None
    assert (text.ring == 9).all()
    big = ply_bytes(points).replace(b"little", b"big").replace(points.tobytes(), points.astype(">f4").tobytes())
    (tmp_path / "b.ply").write_bytes(big)
    np.testing.assert_array_equal(read_cloud(tmp_path / "b.ply").points[0], points)
    organised = pcd_bytes(points, np.zeros(50)).replace(b"WIDTH 50\nHEIGHT 1", b"WIDTH 25\nHEIGHT 2")
    (tmp_path / "c.pcd").write_bytes(organised)
    assert read_cloud(tmp_path / "c.pcd").points.shape == (2, 25, 3)
    np.testing.assert_array_equal(read_cloud(tmp_path / "c.pcd").points.reshape(-1, 3), points)


def test_compressed_pcd_is_unpacked(tmp_path: Path) -> None:
    points = np.repeat(cloud()[:2], 25, axis=0)
    plain = np.concatenate([np.ascontiguousarray(points[:, k]).view(np.uint8) for k in range(3)])
    packed = b"".join(bytes([len(run) - 1]) + run.tobytes() for run in np.array_split(plain, 60))  # literal runs
    head = b"FIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nCOUNT 1 1 1\nWIDTH 50\nHEIGHT 1\nPOINTS 50\nDATA binary_compressed\n"
    (tmp_path / "a.pcd").write_bytes(head + np.array([len(packed), len(plain)], "<u4").tobytes() + packed)
    np.testing.assert_array_equal(read_cloud(tmp_path / "a.pcd").points[0], points)
    out = np.zeros(12, np.uint8)
    assert unpack_lzf(np.array([2, 65, 66, 67, 0b11100000, 0, 2], np.uint8), out) == 12  # ABC, then nine bytes from three back
    assert out.tobytes() == b"ABCABCABCABC"
    assert unpack_lzf(np.array([2, 65, 66, 67, 0b00100000, 9], np.uint8), out) == -1


def test_kittis_camera_poses_are_turned_into_the_lidars_by_its_calibration(tmp_path: Path) -> None:
    camera_from_lidar = np.array([[0.0, -1, 0, 0.1], [0, 0, -1, -0.2], [1, 0, 0, -0.3], [0, 0, 0, 1]])
    lidar = np.tile(np.eye(4), (3, 1, 1))
    lidar[:, :3, :3] = rotation_about_z(np.array([0.0, 0.1, 0.2]))
    lidar[:, 0, 3] = [0.0, 1.0, 2.0]
    camera = camera_from_lidar @ lidar @ np.linalg.inv(camera_from_lidar)
    (tmp_path / "velodyne").mkdir()
    for k in range(3):
        (tmp_path / "velodyne" / f"{k:06d}.bin").write_bytes(np.column_stack((cloud(), np.zeros(50, "f4"))).astype("<f4").tobytes())
    (tmp_path / "poses.txt").write_text("\n".join(" ".join(map(str, pose[:3].ravel())) for pose in camera))
    (tmp_path / "calib.txt").write_text("P0: 1 2 3\nTr: " + " ".join(map(str, camera_from_lidar[:3].ravel())) + "\n")
    recording = open_scan(tmp_path).recording
    np.testing.assert_allclose(recording.position_m, lidar[:, :3, 3], atol=1e-9)
    np.testing.assert_allclose(quat_xyzw_from_rotation(recording.odom_from_sensor), quat_xyzw_from_rotation(lidar[:, :3, :3]), atol=1e-9)
    assert np.diff(recording.stamp_ns).tolist() == [100_000_000, 100_000_000]


BROKEN = [
    ("a.ply", b"solid nonsense", "no PLY header"),
    ("a.ply", ply_bytes(cloud())[:-10], "cut off: 49 of 50 points"),
    ("a.ply", ply_bytes(cloud()).replace(b"property float z", b"property list uchar int z"), "is no number"),
    ("a.ply", ply_bytes(cloud()).replace(b"float z", b"float w"), "no x, y, z"),
    ("a.ply", ply_bytes(cloud()).replace(b"float z", b"float y"), "have one name"),
    ("a.pcd", pcd_bytes(cloud(), np.zeros(50)).replace(b"DATA binary", b"DATA zipped"), "PCD data are 'zipped'"),
    ("a.pcd", pcd_bytes(cloud(), np.zeros(50)).replace(b"SIZE 4 4 4 2", b"SIZE 4 4 2"), "do not match"),
    ("a.bin", b"12345", "no whole number of points"),
]


@pytest.mark.parametrize(("name", "content", "told"), BROKEN)
def test_a_damaged_cloud_is_named_with_what_is_wrong(tmp_path: Path, name: str, content: bytes, told: str) -> None:
    (tmp_path / name).write_bytes(content)
    with pytest.raises(InputError, match=told) as raised:
        read_cloud(tmp_path / name)
    assert name in str(raised.value)


def test_damaged_clouds_are_bad_frames_and_missing_poses_are_counted(folder: Path, tmp_path: Path) -> None:
    (tmp_path / "clouds").mkdir()
    clouds = sorted((folder / "pcd" / "clouds").iterdir())
    for k, path in enumerate(clouds):
        (tmp_path / "clouds" / path.name).write_bytes(path.read_bytes()[: 300 if k in (0, 4) else None])
    lines = (folder / "pcd" / "trajectory.tum").read_text().splitlines()
    (tmp_path / "trajectory.tum").write_text("\n".join(lines[:-2]))
    source = open_scan(tmp_path)
    assert {p.code: p.count for p in source.recording.problems} == {"pose-gap": 2, "cloud-unreadable": 1}
    assert [isinstance(read, BadFrame) for read in source.frames([3, 4, 5])] == [False, True, False]


def test_more_clouds_than_poses_are_refused(folder: Path, tmp_path: Path) -> None:
    (tmp_path / "velodyne").symlink_to(folder / "kitti" / "velodyne")
    (tmp_path / "poses.txt").write_text("1 0 0 0 0 1 0 0 0 0 1 0\n")
    with pytest.raises(InputError, match="1 poses for"):
        open_scan(tmp_path)
