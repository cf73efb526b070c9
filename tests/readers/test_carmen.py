import bz2
import gzip
from pathlib import Path

import numpy as np
import pytest

from floorplan.config import ReadConfig
from floorplan.errors import InputError
from floorplan.model.scan import Frame, GravitySource
from floorplan.readers import open_scan
from floorplan.readers.carmen import no_return_range_m

WALL_M = 2.0  # a wall to the left of the robot, parallel to its way


def flaser(count: int, x: float, y: float, stamp: float, no_return_m: float = 50.0) -> str:
    """A sweep of a robot that looks along +x, beside a wall at y = WALL_M."""
    step = 180 / (count - 1 if count % 2 else count)
    angle = np.deg2rad(-90 + step * np.arange(count))
    distance = np.where(angle > 0.1, (WALL_M - y) / np.maximum(np.sin(angle), 1e-9), no_return_m)
    ranges = " ".join(f"{r:.4f}" for r in distance)
    return f"FLASER {count} {ranges} {x + 9} {y + 9} 0 {x} {y} 0 {stamp:.6f} host {stamp + 77:.6f}"


def robotlaser(count: int, x: float, y: float, stamp: float) -> str:
    ranges = " ".join(flaser(count, x, y, stamp, 81.9).split()[2 : 2 + count])
    step = np.pi / count
    fan, robot = f"{-np.pi / 2} {np.pi} {step}", f"{x - 1} {y} 0 0 0 0 0 0"
    return f"ROBOTLASER1 0 {fan} 81.9 0.01 0 {count} {ranges} 0 {x} {y} 0 {robot} {stamp:.6f} host 1.0"


def log_text(count: int, line: object = flaser) -> str:
    head = "# CARMEN Logfile\nPARAM robot_use_laser on 0 h 0\nODOM 0 0 0 0 0 0 1.0 h 1.0\n"
    write = robotlaser if line is robotlaser else flaser
    return head + "\n".join(write(count, 0.1 * i, 0.0, 100 + 0.1 * i) for i in range(20)) + "\n"


@pytest.mark.parametrize(("line", "count"), [*((flaser, n) for n in (180, 181, 360, 361)), (robotlaser, 180), (robotlaser, 360)])
def test_the_wall_beside_the_robot_is_straight_and_to_its_left(tmp_path: Path, count: int, line: object) -> None:
    (tmp_path / "walk.clf").write_text(log_text(count, line))
    source = open_scan(tmp_path)
    for frame in source.frames(range(20)):
        assert isinstance(frame, Frame)
        assert frame.points.shape == (1, count, 3)
        seen = np.isfinite(frame.points[0, :, 0])
        assert 0.4 * count < seen.sum() < 0.5 * count  # the others met nothing
        np.testing.assert_allclose(frame.points[0, seen, 1], WALL_M, atol=2e-3)
        np.testing.assert_array_equal(frame.points[0, seen, 2], 0.0)


@pytest.mark.parametrize("name", ["a.log", "a.clf", "a.clf.gz", "a.log.bz2"])
def test_packed_and_plain_logs_read_the_same(tmp_path: Path, name: str) -> None:
    data = log_text(180).encode()
    (tmp_path / name).write_bytes(bz2.compress(data) if name.endswith("bz2") else gzip.compress(data) if name.endswith("gz") else data)
    recording = open_scan(tmp_path / name).recording
    np.testing.assert_array_equal(recording.stamp_ns, 100_000_000_000 + 100_000_000 * np.arange(20))  # `time`, not the logger's
    np.testing.assert_allclose(recording.position_m[:, 0], 0.1 * np.arange(20))  # odom_x, not x
    assert recording.gravity_source is GravitySource.LEVEL
    np.testing.assert_array_equal(recording.down_sensor, np.tile([0.0, 0.0, -1.0], (20, 1)))


def test_a_log_cut_off_gives_the_sweeps_before_the_cut(tmp_path: Path) -> None:
    plain = log_text(180)
    (tmp_path / "a.clf").write_text(plain[: len(plain) - 300])
    recording = open_scan(tmp_path / "a.clf").recording
    assert len(recording) == 19
    assert [p.code for p in recording.problems] == ["line-unreadable"]
    (tmp_path / "b.clf.gz").write_bytes(gzip.compress(plain.encode())[:-200])
    source = open_scan(tmp_path / "b.clf.gz")
    assert "file-damaged" in [p.code for p in source.recording.problems]
    assert 5 < len(source.recording) < 20


def test_a_folder_with_two_logs_asks_for_one(tmp_path: Path) -> None:
    (tmp_path / "a.clf").write_text(log_text(180))
    (tmp_path / "b.clf").write_text(log_text(180))
    with pytest.raises(InputError, match=r"(?s)a\.clf .*b\.clf "):
        open_scan(tmp_path)


def test_a_log_file_that_is_no_carmen_log_is_not_taken_for_one(tmp_path: Path) -> None:
    (tmp_path / "server.log").write_text("started\nstopped\n")
    with pytest.raises(InputError, match="not recognised"):
        open_scan(tmp_path)


def test_the_code_for_no_return_is_told_from_a_far_wall() -> None:
    rng = np.random.default_rng(1)
    walls = np.round(rng.uniform(0.5, 12.0, 20000), 2).astype(np.float32)
    assert no_return_range_m(walls, np.inf) == np.inf
    with_code = np.concatenate([walls, np.full(100, 29.99, dtype=np.float32)])
    assert no_return_range_m(with_code, np.inf) == pytest.approx(29.99)
    assert no_return_range_m(walls, 8.0) == 8.0


@pytest.mark.parametrize(("name", "sweeps", "beams", "path_m"), [("aces", 7374, 180, 325.2), ("fr079", 4934, 360, 391.6)])
def test_the_real_logs_are_read_whole_and_every_relation_has_its_stamps(
    shared_data: Path, name: str, sweeps: int, beams: int, path_m: float
) -> None:
    recording = open_scan(shared_data / "laser" / name).recording
    assert (len(recording), recording.sensor.width) == (sweeps, beams)
    assert float(np.linalg.norm(np.diff(recording.position_m, axis=0), axis=1).sum()) == pytest.approx(path_m, abs=0.1)
    lines = (shared_data / "laser" / name / f"{name}.relations").read_text().split("\n")
    stamps = {cell for line in lines for cell in line.split()[:2]}
    assert {int(s.replace(".", "") + "000") for s in stamps} <= set(recording.stamp_ns.tolist())
    assert 30 < recording.sensor.max_range_m < 81


def test_a_packed_log_is_unpacked_whatever_its_name_says(tmp_path: Path) -> None:
    marked = bz2.compress(b"\xef\xbb\xbf" + log_text(180).encode())
    for name, data in (("a.log", gzip.compress(log_text(180).encode())), ("b.log.gz", marked)):
        (tmp_path / name).write_bytes(data)
        assert len(open_scan(tmp_path / name).recording) == 20
    (tmp_path / "c.clf.bz2").write_bytes(bz2.compress(log_text(180).encode())[:500])
    with pytest.raises(InputError, match="copy the log again"):
        open_scan(tmp_path / "c.clf.bz2")


def test_a_log_of_other_scanners_or_damaged_lines_says_what_it_holds(tmp_path: Path) -> None:
    (tmp_path / "rear.log").write_text(log_text(180).replace("FLASER", "RLASER"))
    with pytest.raises(InputError, match="20 are RLASER"):
        open_scan(tmp_path / "rear.log")
    (tmp_path / "comma.log").write_text(log_text(180).replace(".", ","))
    with pytest.raises(InputError, match="20 are cut off or damaged, the first is line 4"):
        open_scan(tmp_path / "comma.log")


def test_ranges_in_other_units_stop_the_build_and_can_be_told(tmp_path: Path) -> None:
    cells = [line.split() for line in log_text(180).splitlines()]
    lines = [" ".join([*c[:2], *(str(float(r) * 1000) for r in c[2:182]), *c[182:]]) if c[0] == "FLASER" else " ".join(c) for c in cells]
    (tmp_path / "mm.log").write_text("\n".join(lines))
    (wrong,) = open_scan(tmp_path / "mm.log").recording.problems
    assert (wrong.code, wrong.fatal) == ("range-unit", True)
    assert "with 1000" in wrong.advice
    right = open_scan(tmp_path / "mm.log", config=ReadConfig(depth_scale=1000.0))
    assert right.recording.problems == ()
    frame = next(iter(right.frames([0])))
    assert isinstance(frame, Frame)
    assert np.nanmax(frame.points[0, :, 1]) == pytest.approx(WALL_M, abs=2e-3)


def circle(unit: float) -> str:
    """Sweeps of a robot that drives in a circle, with headings in `unit` per radian."""
    angle = 0.1 * np.arange(80)
    lines = (flaser(180, float(np.sin(a)), float(1 - np.cos(a)), 100 + float(a)).split() for a in angle)
    return "\n".join(" ".join([*c[:-4], f"{unit * a:.6f}", *c[-3:]]) for c, a in zip(lines, angle, strict=True))


def test_headings_in_degrees_are_turned_into_radians_and_others_left(tmp_path: Path) -> None:
    found = []
    for name, unit in (("rad.log", 1.0), ("deg.log", 180 / np.pi)):
        (tmp_path / name).write_text(circle(unit))
        found.append(open_scan(tmp_path / name).recording)
    assert found[0].problems == ()
    assert [p.code for p in found[1].problems] == ["heading-unit"]
    np.testing.assert_allclose(found[1].odom_from_sensor, found[0].odom_from_sensor, atol=1e-5)


def test_poses_beside_an_odometry_that_never_moves_are_read_instead(tmp_path: Path) -> None:
    cells = [line.split() for line in log_text(180).splitlines()]
    lines = [" ".join([*c[:-6], "0", "0", "0", *c[-3:]]) if c[0] == "FLASER" else " ".join(c) for c in cells]
    (tmp_path / "corrected.log").write_text("\n".join(lines))
    recording = open_scan(tmp_path / "corrected.log").recording
    assert [p.code for p in recording.problems] == ["odometry-still"]
    np.testing.assert_allclose(np.diff(recording.position_m[:, 0]), 0.1, atol=1e-9)


def test_sweeps_without_stamps_of_their_own_stop_the_build(tmp_path: Path) -> None:
    cells = [line.split() for line in log_text(180).splitlines()]
    lines = [" ".join([*c[:-3], "0.000000", *c[-2:]]) if c[0] == "FLASER" else " ".join(c) for c in cells]
    (tmp_path / "timeless.log").write_text("\n".join(lines))
    (lost,) = open_scan(tmp_path / "timeless.log").recording.problems
    assert (lost.code, lost.count, lost.fatal) == ("stamp-doubled", 19, True)
