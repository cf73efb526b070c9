"""Values of the model come back from disk exactly, and the same value gives the same bytes."""

import time
from pathlib import Path

import numpy as np
import pytest

from floorplan.model.graph import Hypotheses, LayoutGraph, Verdict
from floorplan.model.plan import Certainty, Face, Plan, PlanPlane
from floorplan.model.scan import GravitySource, IngestedScan, NoiseModel, Problem, Recording, Sensor, SensorKind, Trajectory
from floorplan.work.values import load_value, save_value


def _scan() -> IngestedScan:
    sensor = Sensor(SensorKind.CAMERA, 4, 6, NoiseModel(0.01, 0.0, 0.002), 0.2, float("inf"), 0.01)
    rng = np.random.default_rng(7)
    rotations = np.linalg.qr(rng.normal(size=(5, 3, 3)))[0]
    stamps = 1_600_000_000_123_456_789 + 33_333_333 * np.arange(5)
    down = np.full((5, 3), np.nan)
    problems = (Problem("png-unreadable", "ünreadable", "depth/1.png", 3),)
    recording = Recording("tum", sensor, stamps, rng.normal(size=(5, 3)), rotations, down, GravitySource.UNKNOWN, problems, None)
    return IngestedScan(recording, np.array([0, 3]))


def test_a_scan_comes_back_exactly(tmp_path: Path) -> None:
    scan = _scan()
    save_value(tmp_path, scan)
    back = load_value(tmp_path, IngestedScan)
    np.testing.assert_array_equal(back.recording.stamp_ns, scan.recording.stamp_ns)
    np.testing.assert_array_equal(back.recording.odom_from_sensor, scan.recording.odom_from_sensor)
    assert np.isnan(back.recording.down_sensor).all()
    assert back.recording.sensor == scan.recording.sensor
    assert back.recording.problems == scan.recording.problems
    assert back.recording.gravity_source is GravitySource.UNKNOWN
    assert back.recording.returns_to_start is None


def test_enums_in_tuples_and_missing_arrays_come_back(tmp_path: Path) -> None:
    rows = np.arange(2)
    save_value(tmp_path, Hypotheses(rows, rows, rows, rows, rows, rows, (Verdict.ACCEPTED, Verdict.AMBIGUOUS)))
    assert load_value(tmp_path, Hypotheses).verdict == (Verdict.ACCEPTED, Verdict.AMBIGUOUS)
    empty = np.zeros(0, int)
    graph = LayoutGraph([0.5], np.zeros((0, 3)), empty, empty, empty, empty, empty, np.zeros((0, 3, 2)))
    save_value(tmp_path, graph)
    assert load_value(tmp_path, LayoutGraph).sigma_m is None


def test_nested_tuples_of_a_plan_come_back_as_tuples(tmp_path: Path) -> None:
    trajectory = Trajectory([1], [[0.0, 0, 0]], [np.eye(3)])
    plane = PlanPlane("P1", 0, 1, 1.25, 0.01, ((1.25, 1.25), (0.0, 2.0), (0.1, 2.5)), (0, 4))
    face = Face("F1", "P1", (1.25, 0.1), (1.25, 2.0), Certainty.SEEN, None, 2.0)
    plan = Plan((plane,), (face,), (), trajectory, 1, [0, 0, 1.0])
    save_value(tmp_path, plan)
    back = load_value(tmp_path, Plan)
    assert back.planes == (plane,)
    assert back.faces == (face,)
    assert back.plane_covariance_m2 is None


def test_the_same_value_gives_the_same_bytes_at_another_time(tmp_path: Path) -> None:
    for name in ("one", "two"):
        (tmp_path / name).mkdir()
        save_value(tmp_path / name, _scan())
        time.sleep(0.01)
    for file in ("value.npz", "value.json"):
        assert (tmp_path / "one" / file).read_bytes() == (tmp_path / "two" / file).read_bytes()


def test_a_value_nobody_taught_it_is_refused(tmp_path: Path) -> None:
    with pytest.raises(TypeError, match="cannot be kept"):
        save_value(tmp_path, {"a": object()})
