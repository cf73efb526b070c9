from pathlib import Path

import numpy as np
import pytest

from floorplan.config import ReadConfig
from floorplan.errors import ConfigError, InputError, UsageError
from floorplan.model.scan import Frame, GravitySource
from floorplan.readers import open_scan
from tests.readers.folders import FX, Walk, write_tum


@pytest.mark.parametrize("units", [1000.0, 5000.0])
def test_the_depth_scale_of_intrinsics_json_is_used(tmp_path: Path, units: float) -> None:
    (frame,) = open_scan(write_tum(tmp_path, Walk(), units)).frames([0])
    assert isinstance(frame, Frame)
    assert float(np.nanmin(frame.points[..., 2])) == pytest.approx(1.01, abs=0.001)


def test_poses_are_interpolated_to_the_stamps_of_the_depth_images(tmp_path: Path) -> None:
    folder = write_tum(tmp_path, Walk())
    lines = (folder / "depth.txt").read_text().replace("10.100000 depth/1.png", "10.130000 depth/1.png")
    (folder / "depth.txt").write_text(lines)
    recording = open_scan(folder).recording
    assert recording.position_m[1, 0] == pytest.approx(0.5 * 0.13, abs=1e-6)
    turned = recording.odom_from_sensor[0].T @ recording.odom_from_sensor[1]
    assert np.arccos((np.trace(turned) - 1) / 2) == pytest.approx(0.2 * 0.13, abs=1e-6)


def test_odometry_is_preferred_to_ground_truth(tmp_path: Path) -> None:
    folder = write_tum(tmp_path, Walk())
    (folder / "odometry.txt").write_text((folder / "groundtruth.txt").read_text().replace("1.400000000", "1.300000000"))
    np.testing.assert_allclose(open_scan(folder).recording.position_m[:, 2], 1.3)


def test_depth_images_in_a_gap_of_the_poses_are_left_out_and_counted(tmp_path: Path) -> None:
    folder = write_tum(tmp_path, Walk(frames=30))
    lines = (folder / "groundtruth.txt").read_text().splitlines()
    (folder / "groundtruth.txt").write_text("\n".join(lines[:8] + lines[18:]))
    recording = open_scan(folder).recording
    assert [(p.code, p.count, p.where) for p in recording.problems] == [("pose-gap", 10, "10.700000 s")]
    assert len(recording) == 20


def test_a_scan_without_intrinsics_names_the_settings_and_takes_them(tmp_path: Path) -> None:
    folder = write_tum(tmp_path, Walk())
    (folder / "intrinsics.json").unlink()
    with pytest.raises(InputError, match=r"intrinsics missing.*read\.fx, read\.fy, read\.cx, read\.cy"):
        open_scan(folder)
    lens = open_scan(folder, config=ReadConfig(fx=FX, cx=30.0, cy=25.0)).recording.sensor.intrinsics
    assert lens is not None
    assert (lens.fx, lens.fy) == (FX, FX)


def test_up_is_unknown_unless_a_setting_names_it(tmp_path: Path) -> None:
    folder = write_tum(tmp_path, Walk())
    assert open_scan(folder).recording.gravity_source is GravitySource.UNKNOWN
    recording = open_scan(folder, config=ReadConfig(world_up="+z")).recording
    assert recording.gravity_source is GravitySource.WORLD
    np.testing.assert_allclose(recording.down_sensor, np.tile([0.0, 1.0, 0.0], (12, 1)), atol=1e-6)
    with pytest.raises(ConfigError, match=r"read\.world_up"):
        open_scan(folder, config=ReadConfig(world_up="up"))


def test_missing_poses_and_other_clocks_are_said_plainly(tmp_path: Path) -> None:
    folder = write_tum(tmp_path, Walk())
    text = (folder / "groundtruth.txt").read_text()
    (folder / "groundtruth.txt").write_text("\n".join("9" + line for line in text.splitlines()[1:]))
    with pytest.raises(InputError, match="same clock"):
        open_scan(folder)
    (folder / "groundtruth.txt").unlink()
    (problem,) = open_scan(folder).recording.problems
    assert (problem.code, problem.fatal) == ("poses-missing", True)
    assert "odometry.txt" in problem.message


def test_unknown_formats_and_places_say_what_was_looked_for(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="no such file or folder"):
        open_scan(tmp_path / "nowhere")
    with pytest.raises(InputError, match=r"(?s)depth\.txt.*CARMEN"):
        open_scan(tmp_path)
    with pytest.raises(UsageError, match=r"one of stray, tum, .*carmen, ros"):
        open_scan(tmp_path, format="polaroid")


def test_the_real_corridor_is_read_in_millimetres(shared_data: Path) -> None:
    source = open_scan(shared_data / "rgbd/corridor")
    assert len(source.recording) == 220
    assert source.recording.problems == ()
    frames = [f for f in source.frames(range(0, 220, 40), 4) if isinstance(f, Frame)]
    assert 1.0 < float(np.nanmedian([np.nanmedian(f.points[..., 2]) for f in frames])) < 5.0
