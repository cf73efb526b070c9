from pathlib import Path

import pytest

from floorplan.config import IngestConfig
from floorplan.inspection import Inspection, inspect_scan
from floorplan.readers import open_scan


def inspected(path: Path) -> Inspection:
    return inspect_scan(open_scan(path), IngestConfig())


def test_the_real_meeting_room_in_numbers(shared_data: Path) -> None:
    facts = inspected(shared_data / "phone/meeting_room")
    assert (facts.format, facts.frames, facts.gravity_source, facts.usable) == ("stray", 942, "imu", True)
    assert facts.rate_hz == pytest.approx(60, abs=0.1)
    assert facts.duration_s == pytest.approx(15.7, abs=0.01)
    assert facts.path_length_m == pytest.approx(6.78, abs=0.01)
    assert facts.intrinsics is not None
    assert facts.intrinsics.fx == pytest.approx(1352.0168 * 256 / 1920)
    assert 60 < facts.keyframes < 200


def test_the_real_corridor_says_that_its_gravity_is_estimated(shared_data: Path) -> None:
    facts = inspected(shared_data / "rgbd/corridor")
    assert facts.gravity_source == "estimated from floor and ceiling"
    assert facts.gravity_wander_deg is not None
    assert 1.0 < facts.gravity_wander_deg < 6.0
    assert facts.median_range_m is not None
    assert 2.0 < facts.median_range_m < 5.0


def test_the_real_laser_log_is_level_and_names_its_gap(shared_data: Path) -> None:
    facts = inspected(shared_data / "laser/aces")
    assert (facts.sensor, facts.width, facts.height, facts.intrinsics) == ("laser", 180, 1, None)
    assert facts.gravity_source == "assumed level"
    assert [p.code for p in facts.problems] == ["frame-gap"]
    assert facts.longest_gap_s == pytest.approx(3.03, abs=0.01)
    assert 2500 < facts.keyframes < 4500  # 325 m in steps of at least 10 cm, and the turns on the spot
