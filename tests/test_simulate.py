"""The simulator's own truth: exact, repeatable, and a different building for every seed."""

import itertools
import json
from pathlib import Path

import numpy as np
import pytest

from floorplan.errors import UsageError
from floorplan.geometry import rotation_from_quat_xyzw
from floorplan.model.scan import Frame
from floorplan.readers import open_scan
from floorplan.simulate import simulate
from floorplan.simulate.building import BoxKind, SpaceKind
from floorplan.simulate.odometry import drifting_odometry
from floorplan.simulate.presets import PRESETS
from floorplan.simulate.route import BODY_RADIUS_M, clearance_m, walkable
from floorplan.simulate.scene import draw_scene
from floorplan.simulate.works import NO_PARTITION


@pytest.mark.parametrize("name", PRESETS)
def test_every_preset_returns_to_its_start(name: str) -> None:
    walk = draw_scene(name, 3).walk
    assert np.linalg.norm(walk.position_m[-1] - walk.position_m[0]) < 0.02


def test_the_same_seed_gives_the_same_bytes(tmp_path: Path) -> None:
    for name in ("a", "b"):
        simulate(tmp_path / name, "flat", 2, rate_hz=1.0, image_scale=0.2)
    files = sorted(p.relative_to(tmp_path / "a") for p in (tmp_path / "a").rglob("*") if p.is_file())
    assert len(files) > 20
    assert all((tmp_path / "a" / f).read_bytes() == (tmp_path / "b" / f).read_bytes() for f in files)
    assert json.loads((tmp_path / "a" / "truth.json").read_text())["returns_to_start"] is True


def test_the_walker_never_touches_a_wall() -> None:
    scene = draw_scene("office", 4)
    assert clearance_m(scene.building, scene.walk.position_m[::5, :2]) > BODY_RADIUS_M / 2


@pytest.mark.parametrize("form", ["tum", "stray"])
def test_depth_lies_on_true_faces_when_read_and_placed_by_the_true_pose(form: str, tmp_path: Path) -> None:
    simulate(tmp_path / "scan", "flat", 1, rate_hz=0.3, image_scale=0.5, format=form)
    truth = json.loads((tmp_path / "scan" / "truth.json").read_text())
    pose = np.array(truth["trajectory"]["pose"])
    rotation = rotation_from_quat_xyzw(pose[:, 3:])
    source = open_scan(tmp_path / "scan")
    assert len(source.recording) == len(pose)
    for frame in source.frames(range(len(pose))):
        assert isinstance(frame, Frame)
        world = frame.points[np.isfinite(frame.points[..., 0])] @ rotation[frame.index].T + pose[frame.index, :3]
        off = np.full(len(world), np.inf)
        for axis in (0, 1, 2):
            offsets = np.array([plane["offset"] for plane in truth["planes"] if plane["axis"] == axis])
            off = np.minimum(off, np.abs(world[:, axis, None] - offsets).min(axis=1))
        assert 0.0005 < np.median(off) < 0.008
        assert np.mean(off < 0.05) > 0.97


def test_gravity_of_a_stray_export_is_the_true_one(tmp_path: Path) -> None:
    simulate(tmp_path / "scan", "flat", 1, rate_hz=2.0, image_scale=0.05, format="stray")
    truth = json.loads((tmp_path / "scan" / "truth.json").read_text())
    down = -rotation_from_quat_xyzw(np.array(truth["trajectory"]["pose"])[:, 3:])[:, 2, :]
    error = np.degrees(np.arccos(np.clip(np.sum(down * open_scan(tmp_path / "scan").recording.down_sensor, axis=1), -1, 1)))
    assert 0.0 < np.median(error) < 0.5


def test_laser_sweeps_end_on_true_walls(tmp_path: Path) -> None:
    simulate(tmp_path / "scan", "area1", 1, format="carmen", rate_hz=0.5)
    truth = json.loads((tmp_path / "scan" / "truth.json").read_text())
    pose = np.array(truth["trajectory"]["pose"])
    rotation = rotation_from_quat_xyzw(pose[:, 3:])
    for frame in open_scan(tmp_path / "scan").frames(range(len(pose))):
        assert isinstance(frame, Frame)
        world = frame.points[np.isfinite(frame.points[..., 0])] @ rotation[frame.index].T + pose[frame.index, :3]
        offsets = [np.array([plane["offset"] for plane in truth["planes"] if plane["axis"] == axis]) for axis in (0, 1)]
        off = np.minimum(*[np.abs(world[:, axis, None] - offsets[axis]).min(axis=1) for axis in (0, 1)])
        assert np.mean(off < 0.04) > 0.95


def test_every_door_can_be_walked_through_and_seeds_are_different_buildings() -> None:
    areas = set()
    for seed in (1, 2, 3):
        building = draw_scene("area1", seed).building
        free = walkable(building)
        assert all(free.buffer(1e-3).contains(door.rect.polygon) for door in building.doors)
        rooms = [space for space in building.spaces if space.kind is SpaceKind.ROOM]
        reached = {space for door in building.doors for space in door.spaces}
        assert {room.id for room in rooms} <= reached
        areas.add(tuple(round(room.outline.area, 2) for room in rooms))
    assert len(areas) == 3


@pytest.mark.parametrize("name", ["area1", "area4"])
def test_raw_odometry_drifts_as_the_published_table_says(name: str) -> None:
    scene = draw_scene(name, 1)
    odometry = drifting_odometry(scene.walk, np.random.default_rng(5), error=None, drift_m=scene.preset.drift_m)
    drift = np.linalg.norm(odometry.position_m[-1] - odometry.position_m[0])
    assert drift == pytest.approx(scene.preset.drift_m, rel=0.02)
    assert np.allclose(odometry.position_m[0], 0)


def test_odometry_without_error_moves_as_the_walker_did() -> None:
    scene = draw_scene("flat", 1)
    odometry = drifting_odometry(scene.walk, np.random.default_rng(5), error=0.0, drift_m=None)
    moved = np.linalg.norm(np.diff(odometry.position_m, axis=0), axis=1)
    assert np.allclose(moved, np.linalg.norm(np.diff(scene.walk.position_m, axis=0), axis=1), atol=1e-9)


def test_hard_adds_tall_cabinets_and_open_door_leaves_and_nothing_in_the_way() -> None:
    scene = draw_scene("office", 3, hard=True)
    kinds = [box.kind for box in scene.building.boxes]
    assert kinds.count(BoxKind.CABINET) >= 4
    assert kinds.count(BoxKind.LEAF) >= 2
    standing = [box.outline.buffer(-1e-6) for box in scene.building.boxes if box.z1_m > 1.3]
    assert not any(a.intersects(b) for a, b in itertools.combinations(standing, 2))
    assert clearance_m(scene.building, scene.walk.position_m[::5, :2]) > BODY_RADIUS_M / 2


def test_an_unknown_preset_or_format_names_the_choices(tmp_path: Path) -> None:
    with pytest.raises(UsageError, match="area1"):
        simulate(tmp_path / "a", "castle", 1)
    with pytest.raises(UsageError, match="stray"):
        simulate(tmp_path / "b", "flat", 1, format="bag")


def test_the_bundled_flat_is_the_one_its_command_makes() -> None:
    folder = Path(__file__).parents[1] / "samples" / "flat"
    truth = json.loads((folder / "truth.json").read_text())
    walk = draw_scene("flat", 1, rate_hz=3.0).walk
    assert truth["trajectory"]["stamp_ns"] == walk.stamp_ns.tolist()
    assert len(list((folder / "depth").iterdir())) == len(walk)
    assert sum(file.stat().st_size for file in (folder / "depth").iterdir()) < 8_000_000


def test_works_that_have_no_place_are_told() -> None:
    assert draw_scene("flat", 1, works=True).left_out == (NO_PARTITION,)
    assert draw_scene("office", 1, works=True).left_out == ()
    assert draw_scene("flat", 1).left_out == ()
