"""The simulator's own truth: exact, repeatable, and a different building for every seed."""

import json
from pathlib import Path

import numpy as np
import pytest

from floorplan.simulate import simulate
from floorplan.simulate.presets import PRESETS
from floorplan.simulate.route import BODY_RADIUS_M, clearance_m
from floorplan.simulate.scene import draw_scene


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
