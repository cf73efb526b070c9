"""Record3D recordings: the same simulated scan as a Stray Scanner export; LZFSE streams; broken archives."""

import json
import sys
import zipfile
import zlib
from pathlib import Path

import numpy as np
import pytest

from floorplan.errors import InputError
from floorplan.model.scan import Frame, GravitySource
from floorplan.readers import open_scan, reader_for
from floorplan.readers.base import BadFrame
from floorplan.readers.lzfse import stored, unpacked
from floorplan.simulate import simulate


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("record3d")
    for name in ("stray", "record3d"):
        simulate(folder / name, "flat", 3, format=name, rate_hz=1.0, image_scale=0.25)
    return folder


def rewritten(source: Path, target: Path, changed: dict[str, bytes]) -> Path:
    """The archive with some members replaced."""
    with zipfile.ZipFile(source) as old, zipfile.ZipFile(target, "w") as new:
        for name in old.namelist():
            new.writestr(name, changed.get(name, old.read(name)))
    return target


def test_a_recording_gives_the_poses_and_points_of_the_same_scan_in_another_format(folder: Path) -> None:
    path = folder / "record3d" / "scan.r3d"
    assert reader_for(path).name == "record3d"
    source, stray = open_scan(path), open_scan(folder / "stray")
    assert len(source.recording) == len(stray.recording)
    np.testing.assert_allclose(source.recording.position_m, stray.recording.position_m, atol=1e-6)
    np.testing.assert_allclose(source.recording.odom_from_sensor, stray.recording.odom_from_sensor, atol=1e-6)
    assert source.recording.gravity_source is GravitySource.WORLD
    assert (np.diff(source.recording.stamp_ns) - np.diff(stray.recording.stamp_ns)).max() <= 1
    assert source.recording.problems == ()
    for got, want in zip(source.frames([0, 9, 20], 2), stray.frames([0, 9, 20], 2), strict=True):
        assert isinstance(got, Frame)
        assert isinstance(want, Frame)
        np.testing.assert_allclose(got.points, want.points, atol=2e-3)  # whole millimetres there
        np.testing.assert_array_equal(got.confidence, want.confidence)


def test_lzfse_streams_are_unpacked_and_what_needs_the_library_says_so(monkeypatch: pytest.MonkeyPatch) -> None:
    assert unpacked(stored(b"depth"), 5, "x") == b"depth"
    assert unpacked(zlib.compress(b"depth"), 5, "x") == b"depth"
    assert unpacked(b"depth", 5, "x") == b"depth"
    with pytest.raises(InputError, match="5 bytes where 7 belong"):
        unpacked(stored(b"depth"), 7, "x")
    monkeypatch.setitem(sys.modules, "liblzfse", None)
    with pytest.raises(InputError, match="pip install pyliblzfse"):
        unpacked(b"bvx2" + bytes(20), 5, "x")


def test_damaged_depth_is_a_bad_frame_and_broken_metadata_an_error(folder: Path, tmp_path: Path) -> None:
    path = folder / "record3d" / "scan.r3d"
    hurt = rewritten(path, tmp_path / "hurt.r3d", {"rgbd/4.depth": stored(b"short")})
    assert [isinstance(read, BadFrame) for read in open_scan(hurt).frames([3, 4, 5])] == [False, True, False]
    with zipfile.ZipFile(path) as archive:
        tree = json.loads(archive.read("metadata"))
    for key, value, told in (("poses", [[1, 2]], "poses in its metadata"), ("K", [0] * 9, "intrinsics missing"), ("dw", "wide", "dw|wide")):
        broken = rewritten(path, tmp_path / f"{key}.r3d", {"metadata": json.dumps({**tree, key: value}).encode()})
        with pytest.raises(InputError, match=told):
            open_scan(broken)
    with zipfile.ZipFile(tmp_path / "flipped.r3d", "w", zipfile.ZIP_DEFLATED) as new:
        new.writestr("metadata", json.dumps(tree))
    packed = bytearray((tmp_path / "flipped.r3d").read_bytes())
    packed[60:80] = bytes(20)  # within the packed metadata
    (tmp_path / "flipped.r3d").write_bytes(packed)
    with pytest.raises(InputError, match="metadata cannot be read"):
        open_scan(tmp_path / "flipped.r3d")
    (tmp_path / "cut.r3d").write_bytes(path.read_bytes()[:5000])
    with pytest.raises(InputError, match="no ZIP file, or cut off"):
        open_scan(tmp_path / "cut.r3d")


def test_intrinsics_per_frame_win_over_the_common_matrix(folder: Path, tmp_path: Path) -> None:
    path = folder / "record3d" / "scan.r3d"
    with zipfile.ZipFile(path) as archive:
        tree = json.loads(archive.read("metadata"))
    k = tree["K"]
    rows = [[k[0] * (1 + 0.001 * row), k[4], k[6], k[7]] for row in range(len(tree["poses"]))]
    told = rewritten(path, tmp_path / "told.r3d", {"metadata": json.dumps({**tree, "perFrameIntrinsicCoeffs": rows, "K": None}).encode()})
    first, last = (read.points for read in open_scan(told).frames([0, 20]) if isinstance(read, Frame))
    whole = [read.points for read in open_scan(path).frames([0, 20]) if isinstance(read, Frame)]
    np.testing.assert_allclose(first, whole[0], rtol=1e-6)
    np.testing.assert_allclose(last[..., 0], whole[1][..., 0] / 1.02, rtol=1e-4)
    assert np.isfinite(last).mean() > 0.3
