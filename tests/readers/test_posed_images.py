"""Phone apps' and ScanNet's folders: the same simulated scan, written in each, is the same recording; broken ones say why."""

import json
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pytest

from floorplan.config import ReadConfig
from floorplan.errors import InputError
from floorplan.model.checks import Array
from floorplan.model.scan import Frame, GravitySource
from floorplan.readers import Source, open_scan, reader_for
from floorplan.readers.base import BadFrame
from floorplan.simulate import simulate

FORMATS = ("scanner3d", "polycam", "arkitscenes", "scannet")
LEVEL = {"scanner3d", "polycam"}  # formats that promise a level world


@dataclass(frozen=True)
class Scans:
    """One scan in every format, by name."""

    folder: Path

    def open(self, name: str) -> Source:
        return open_scan(self.folder / name)


@pytest.fixture(scope="module")
def scans(tmp_path_factory: pytest.TempPathFactory) -> Scans:
    folder = tmp_path_factory.mktemp("formats")
    for name in ("stray", *FORMATS):
        simulate(folder / name, "flat", 3, format=name, rate_hz=1.0, image_scale=0.25)
    return Scans(folder)


def relative(source: Source) -> Array:
    """Each pose (N, 4, 4) as seen from the first one."""
    pose = np.tile(np.eye(4), (len(source.recording), 1, 1))
    pose[:, :3, :3], pose[:, :3, 3] = source.recording.odom_from_sensor, source.recording.position_m
    return np.asarray(np.linalg.inv(pose[0]) @ pose)


def frame(source: Source, row: int) -> Frame:
    read = next(iter(source.frames([row])))
    assert isinstance(read, Frame)
    return read


@pytest.mark.parametrize("name", FORMATS)
def test_each_format_is_recognised_and_gives_the_same_poses_and_points(scans: Scans, name: str) -> None:
    assert reader_for(scans.folder / name).name == name
    source, stray = scans.open(name), scans.open("stray")
    assert len(source.recording) == len(stray.recording) > 20
    assert np.abs(relative(source) - relative(stray)).max() < 2e-6
    for row in (0, 7, 20):
        got, want = frame(source, row), frame(stray, row)
        np.testing.assert_allclose(got.points, want.points, atol=2e-4)
        assert np.nanmax(np.abs(got.points)) > 1.0
        if name != "scannet":
            assert got.confidence is not None
            assert (got.confidence == want.confidence).all()


def test_all_three_levels_of_confidence_arrive_in_every_format_that_has_them(scans: Scans) -> None:
    for name in FORMATS[:3]:
        source = scans.open(name)
        read = [f.confidence for f in source.frames(range(len(source.recording))) if isinstance(f, Frame) and f.confidence is not None]
        assert set(np.unique(read)) == {0, 1, 2}


@pytest.mark.parametrize("name", FORMATS)
def test_stamps_and_gravity_are_what_the_format_promises(scans: Scans, name: str) -> None:
    recording, stray = scans.open(name).recording, scans.open("stray").recording
    steps, want = np.diff(recording.stamp_ns), np.diff(stray.stamp_ns)
    assert np.abs(steps - want).max() <= {"scannet": 34_000_000, "polycam": 1_000}.get(name, 200)
    assert (steps > 0).all()
    assert recording.gravity_source is (GravitySource.WORLD if name in LEVEL else GravitySource.UNKNOWN)
    if name in LEVEL:
        np.testing.assert_allclose(recording.down_sensor, stray.down_sensor, atol=0.02)
    assert recording.problems == ()


def copied(source: Path, target: Path) -> Path:
    target.mkdir()
    for path in sorted(source.rglob("*")):
        if path.is_file():
            (target / path.relative_to(source)).parent.mkdir(parents=True, exist_ok=True)
            (target / path.relative_to(source)).write_bytes(path.read_bytes())
    return target


def test_frames_that_lost_tracking_are_left_out_and_counted(scans: Scans, tmp_path: Path) -> None:
    folder = copied(scans.folder / "scannet", tmp_path / "lost")
    poses = sorted((folder / "pose").glob("*.txt"))
    poses[3].write_text("\n".join(["-inf -inf -inf -inf"] * 4))
    poses[5].unlink()
    recording = open_scan(folder).recording
    assert len(recording) == len(poses) - 2
    assert [(p.code, p.count) for p in recording.problems] == [("pose-missing", 2)]


def test_polycams_optimised_poses_are_preferred(scans: Scans, tmp_path: Path) -> None:
    folder = copied(scans.folder / "polycam", tmp_path / "corrected")
    corrected = folder / "keyframes" / "corrected_cameras"
    corrected.mkdir()
    for file in sorted((folder / "keyframes" / "cameras").glob("*.json"))[:10]:
        tree = json.loads(file.read_text())
        (corrected / file.name).write_text(json.dumps({**tree, "t_03": tree["t_03"] + 5.0}))
    recording = open_scan(folder).recording
    assert len(recording) == 10
    assert np.allclose(recording.position_m[:, 0], scans.open("polycam").recording.position_m[:10, 0] + 5.0)


BROKEN = [
    ("scanner3d", "frame_00003.json", "{]", "cannot be read"),
    ("scanner3d", "frame_00003.json", '{"cameraPoseARFrame": [1, 2]}', "cameraPoseARFrame is no list of 16 numbers"),
    ("arkitscenes", "lowres_wide.traj", "no numbers here\n", "no pose could be read"),
    ("scannet", "intrinsic/intrinsic_depth.txt", "1 2 3\n", "not a 3 x 3 or 4 x 4 camera matrix"),
]


@pytest.mark.parametrize(("name", "file", "text", "told"), BROKEN)
def test_a_broken_file_is_named_with_what_is_wrong(scans: Scans, tmp_path: Path, name: str, file: str, text: str, told: str) -> None:
    folder = copied(scans.folder / name, tmp_path / "broken")
    (folder / file).write_text(text)
    with pytest.raises(InputError, match=told) as raised:
        open_scan(folder)
    assert Path(file).name in str(raised.value)


def test_missing_depth_images_and_confidence_are_problems_not_errors(scans: Scans, tmp_path: Path) -> None:
    folder = copied(scans.folder / "scanner3d", tmp_path / "gaps")
    (folder / "depth_00004.png").unlink()
    (folder / "conf_00006.png").unlink()
    source = open_scan(folder, config=ReadConfig())
    assert {p.code: p.count for p in source.recording.problems} == {"frame-missing": 1, "confidence-missing": 1}
    assert not any(isinstance(read, BadFrame) for read in source.frames(range(5)))
