"""Advice follows from measured facts, and a good walk gets none."""

import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from typer.testing import CliRunner

from floorplan.build import Job, build
from floorplan.cli import app
from floorplan.export import read_results
from floorplan.model.scan import Recording
from floorplan.recording_advice import recording_advice, walking_speed_m_s
from floorplan.recording_checks import motion_of
from floorplan.survey_advice import survey_advice
from tests.box_room import camera_scan

SAMPLE = Path(__file__).resolve().parents[1] / "samples" / "flat"


def walk(speed_m_s: float = 0.8, turn_deg_s: float = 10.0, back: bool = True, seconds: float = 30.0) -> Recording:
    """Ten frames a second along a line, and back."""
    count = int(10 * seconds)
    along = speed_m_s * np.arange(count) / 10
    if back:
        along = np.minimum(along, along[-1] - along)
    yaw = np.radians(turn_deg_s) * np.arange(count) / 10
    cos, sin, nil = np.cos(yaw), np.sin(yaw), np.zeros(count)
    rotation = np.stack((np.stack((cos, nil, sin), 1), np.stack((sin, nil, -cos), 1), np.stack((nil, nil + 1, nil), 1)), 1)
    down = np.tile((0.0, 1.0, 0.0), (count, 1))
    position = np.stack((along, nil, nil), 1)
    stamps = (np.arange(count) * 100_000_000).astype(np.int64)
    return replace(
        camera_scan(frames=2).recording, stamp_ns=stamps, position_m=position, odom_from_sensor=rotation, down_sensor=down
    )


def codes(recording: Recording, filled: float | None = 0.9) -> list[str]:
    return [one.code for one in recording_advice(recording, filled)]


def test_a_slow_closed_walk_gets_no_advice() -> None:
    assert codes(walk()) == []


@pytest.mark.parametrize(
    ("recording", "filled", "code"),
    [
        (walk(speed_m_s=2.0), 0.9, "speed"),
        (walk(turn_deg_s=500.0), 0.9, "turns"),
        (walk(back=False), 0.9, "loop"),
        (walk(), 0.3, "empty-pixels"),
    ],
)
def test_each_fault_is_told_by_its_measured_size(recording: Recording, filled: float, code: str) -> None:
    assert codes(recording, filled) == [code]
    (one,) = recording_advice(recording, filled)
    assert any(digit in one.fact for digit in "123456789")


def test_a_gap_is_told_with_its_length_and_the_way_lost() -> None:
    whole = walk()
    rows = np.r_[0:100, 140:300]
    gapped = replace(
        whole,
        stamp_ns=whole.stamp_ns[rows],
        position_m=whole.position_m[rows],
        odom_from_sensor=whole.odom_from_sensor[rows],
        down_sensor=whole.down_sensor[rows],
    )
    (one,) = recording_advice(gapped, 0.9)
    assert one.code == "gaps"
    assert "1 gap of up to 4.1 s" in one.fact


def test_the_speed_is_that_of_the_walk() -> None:
    assert walking_speed_m_s(motion_of(walk(speed_m_s=1.2))) == pytest.approx(1.2, abs=0.01)


def test_a_finished_sample_says_what_the_next_build_does_and_where_the_plan_is_weak(tmp_path: Path) -> None:
    build(Job(SAMPLE, tmp_path / "work"))
    found = {one.code: one for one in survey_advice(read_results(tmp_path / "work"))}
    assert set(found) <= {"loop", "blind-frames", "seen-once", "inferred", "least-certain", "unvisited"}
    worst = max(read_results(tmp_path / "work").plan.dimensions, key=lambda dimension: dimension.sigma_m)
    assert ("least-certain" in found) == (1.96 * worst.sigma_m > max(0.015, 0.01 * worst.distance_m))
    answer = json.loads(CliRunner().invoke(app, ["status", str(tmp_path / "work"), "--json"]).stdout)
    assert [one["code"] for one in answer["advice"]] == list(found)
    assert "everything is up to date" in CliRunner().invoke(app, ["status", str(tmp_path / "work")]).stdout
