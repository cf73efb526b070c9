"""A simulated scan is the same scan in every format, and a bag that was cut in half is the first half of it."""

import json
from pathlib import Path

import numpy as np
import pytest

from floorplan.build import Job, build
from floorplan.errors import UsageError
from floorplan.results import Results
from floorplan.simulate import simulate
from floorplan.simulate.formats import BAG_KINDS


def simulated(folder: Path, format: str) -> Path:
    simulate(folder, "flat", 1, rate_hz=0.8, image_scale=0.25, format=format)
    return folder


def built(folder: Path) -> Results:
    results = build(Job(folder, folder.with_suffix(".work")))
    assert results is not None
    return results


def test_a_tum_folder_and_three_kinds_of_bag_give_the_same_plan(tmp_path: Path) -> None:
    expected = built(simulated(tmp_path / "tum", "tum")).plan
    assert len(expected.planes) > 10
    for kind in BAG_KINDS:
        plan = built(simulated(tmp_path / kind, kind)).plan
        assert [(p.axis, p.facing) for p in plan.planes] == [(p.axis, p.facing) for p in expected.planes]
        np.testing.assert_allclose([p.offset_m for p in plan.planes], [p.offset_m for p in expected.planes], atol=1e-4)
        assert len(plan.walls) == len(expected.walls)


def test_a_bag_cut_in_half_gives_the_plan_of_the_first_half(tmp_path: Path) -> None:
    file = next(simulated(tmp_path / "cut", "db3").glob("*.db3"))
    file.write_bytes(file.read_bytes()[: file.stat().st_size // 2])
    results = built(tmp_path / "cut")
    frames = len(results.scan.recording)
    assert 25 <= frames <= 33  # of 64
    assert len(results.plan.walls) >= 3
    (problem,) = [p for p in results.scan.recording.problems if p.code == "bag-cut"]
    assert "of 192 messages" in problem.message


def test_unknown_sensors_and_formats_they_are_not_written_in_are_refused(tmp_path: Path) -> None:
    with pytest.raises(UsageError, match="lidar16"):
        simulate(tmp_path / "a", "flat", 1, sensor="sonar")
    with pytest.raises(UsageError, match="ros1, db3, mcap"):
        simulate(tmp_path / "b", "flat", 1, format="stray", sensor="lidar16")


def test_a_spinning_lidar_gives_a_plan_with_true_distances(tmp_path: Path) -> None:
    simulate(tmp_path / "lidar", "flat", 1, rate_hz=0.8, image_scale=0.7, format="mcap", sensor="lidar16")
    plan = built(tmp_path / "lidar").plan
    truth = json.loads((tmp_path / "lidar" / "truth.json").read_text())
    offsets = [np.array([plane["offset"] for plane in truth["planes"] if plane["axis"] == axis]) for axis in (0, 1)]
    true_m = np.concatenate([np.abs(np.subtract.outer(o, o)).ravel() for o in offsets])
    assert len(plan.walls) >= 8
    assert len(plan.rooms) >= 1
    assert len(plan.dimensions) >= 2
    for dimension in plan.dimensions:
        assert np.abs(true_m - dimension.distance_m).min() < 0.02
