from pathlib import Path

import numpy as np
import pytest

from floorplan.errors import InputError
from floorplan.model.scan import Frame, GravitySource
from floorplan.readers import open_scan
from tests.readers.folders import CX, CY, FX, FY, Walk, write_stray

DOWN_OF_A_LEVEL_CAMERA = [0.0, 1.0, 0.0]


@pytest.mark.parametrize("per_frame_lens", [False, True])
def test_both_versions_of_odometry_csv_give_the_intrinsics_of_the_depth_image(tmp_path: Path, per_frame_lens: bool) -> None:
    source = open_scan(write_stray(tmp_path, Walk(), per_frame_lens))
    lens = source.recording.sensor.intrinsics
    assert lens is not None
    assert (lens.fx, lens.fy, lens.cx, lens.cy) == pytest.approx((FX, FY, CX, CY), abs=1e-9)


@pytest.mark.parametrize(("imu", "gravity"), [("rows", GravitySource.IMU), ("header", GravitySource.WORLD), ("", GravitySource.WORLD)])
def test_gravity_comes_from_the_imu_unless_it_has_no_rows(tmp_path: Path, imu: str, gravity: GravitySource) -> None:
    recording = open_scan(write_stray(tmp_path, Walk(), imu=imu)).recording
    assert recording.gravity_source is gravity
    np.testing.assert_allclose(recording.down_sensor, np.tile(DOWN_OF_A_LEVEL_CAMERA, (12, 1)), atol=1e-6)


def test_an_imu_that_contradicts_the_world_is_reported_and_not_believed(tmp_path: Path) -> None:
    folder = write_stray(tmp_path, Walk())
    header, *rows = (folder / "imu.csv").read_text().splitlines()
    swapped = [", ".join([r.split(",")[0], *reversed(r.split(",")[1:4])]) for r in rows]
    (folder / "imu.csv").write_text("\n".join([header, *swapped]))
    recording = open_scan(folder).recording
    assert recording.gravity_source is GravitySource.WORLD
    assert [p.code for p in recording.problems] == ["gravity-contradictory"]


def test_stamps_positions_and_confidence_come_through(tmp_path: Path) -> None:
    walk = Walk()
    source = open_scan(write_stray(tmp_path, walk))
    np.testing.assert_array_equal(source.recording.stamp_ns, np.round(walk.stamp_s * 1e9).astype(np.int64))
    np.testing.assert_allclose(np.diff(source.recording.position_m[:, 0]), 0.05, atol=1e-8)
    np.testing.assert_allclose(source.recording.position_m[:, 1], 1.4)  # +y is up in ARKit's world
    confidences = [f.confidence for f in source.frames(range(3)) if isinstance(f, Frame)]
    assert [int(c.max()) for c in confidences if c is not None] == [0, 1, 2]


def test_missing_poses_doubled_and_unsorted_stamps_are_counted_and_mended(tmp_path: Path) -> None:
    folder = write_stray(tmp_path, Walk())
    lines = (folder / "odometry.csv").read_text().splitlines()
    lines[4] = ", ".join([*lines[4].split(", ")[:2], *["nan"] * 7])
    lines[6], lines[7] = lines[7], lines[6]
    lines.append(lines[10])
    (folder / "odometry.csv").write_text("\n".join(lines))
    recording = open_scan(folder).recording
    assert {p.code: p.count for p in recording.problems} == {"pose-missing": 1, "stamp-unsorted": 2, "stamp-doubled": 1}
    assert next(p.where for p in recording.problems if p.code == "pose-missing") == "odometry.csv, row 5"
    assert len(recording) == 11
    assert (np.diff(recording.stamp_ns) > 0).all()


@pytest.mark.parametrize("rows", [slice(1, 5), slice(8, None)])
def test_depth_images_whose_rows_were_lost_are_counted(tmp_path: Path, rows: slice) -> None:
    folder = write_stray(tmp_path, Walk())
    lines = (folder / "odometry.csv").read_text().splitlines()
    lost = len(lines[rows])
    del lines[rows]
    (folder / "odometry.csv").write_text("\n".join(lines))
    (problem,) = open_scan(folder).recording.problems
    assert (problem.code, problem.count) == ("frame-unposed", lost)
    assert f"of {12}" in problem.message


def test_a_header_that_is_not_the_apps_is_told(tmp_path: Path) -> None:
    folder = write_stray(tmp_path, Walk())
    (folder / "odometry.csv").write_text("\n".join(["a,b,c", *(folder / "odometry.csv").read_text().splitlines()[1:]]))
    recording = open_scan(folder).recording
    assert [p.code for p in recording.problems] == ["header-unknown"]
    assert len(recording) == 12


def test_a_missing_camera_matrix_names_the_settings_to_use(tmp_path: Path) -> None:
    folder = write_stray(tmp_path, Walk())
    (folder / "camera_matrix.csv").unlink()
    with pytest.raises(InputError, match=r"intrinsics missing.*read\.fx"):
        open_scan(folder)


def test_the_real_newer_odometry_has_its_own_intrinsics_per_frame(tmp_path: Path, shared_data: Path) -> None:
    folder = write_stray(tmp_path, Walk(frames=7))
    newer = shared_data / "formats/stray_newer"
    (folder / "odometry.csv").write_text((newer / "odometry_head.csv").read_text())
    (folder / "camera_matrix.csv").unlink()
    lens = open_scan(folder).recording.sensor.intrinsics
    assert lens is not None
    assert lens.fx == pytest.approx(1597.9 * 64 / 1920, rel=1e-3)


@pytest.mark.parametrize(("name", "frames", "path_m"), [("meeting_room", 942, 6.78), ("small_room", 580, 3.49)])
def test_the_real_phone_recordings_are_read_whole(shared_data: Path, name: str, frames: int, path_m: float) -> None:
    recording = open_scan(shared_data / "phone" / name).recording
    assert len(recording) == frames
    assert recording.gravity_source is GravitySource.IMU
    assert float(np.linalg.norm(np.diff(recording.position_m, axis=0), axis=1).sum()) == pytest.approx(path_m, abs=0.01)
    assert recording.problems == ()
