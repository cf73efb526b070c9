"""Two Manhattan directions are told; a skewed wall, a round hall and noise are not."""

from dataclasses import replace

import numpy as np
import pytest

from floorplan.model.segment import EvidencePoints, FreePatches, ManhattanFrames, SegmentedScan, Segments
from floorplan.second_direction import direction_problems, second_direction

WALL_PIXELS = 10_000


def scanned(angles_deg: list[float], pixels: list[int]) -> SegmentedScan:
    """One frame with 10 000 pixels of wall along the axes and patches off them."""
    count = len(angles_deg)
    zeros = np.zeros(count)
    patches = FreePatches(
        zeros, np.radians(angles_deg), np.zeros((count, 2)), np.zeros((count, 2)), np.zeros((count, 2)), zeros, np.array(pixels)
    )
    one = np.ones(1)
    segments = Segments(
        one * 0, one * 0, one, -one, one, np.array([WALL_PIXELS]), one, np.zeros((1, 3, 2)), np.zeros((1, 3)), np.zeros((1, 3, 3))
    )
    frames = ManhattanFrames(np.eye(3)[None], one, np.array([True]))
    return SegmentedScan(frames, segments, patches, EvidencePoints(np.array([0, 0]), np.zeros((0, 3)), np.zeros(0), np.zeros(0)))


def test_a_wing_at_thirty_degrees_is_told_with_its_share_and_its_code() -> None:
    wing = scanned([30.2, 120.4, 210.1, 300.3], [2000, 2000, 1000, 1000])
    found = second_direction(wing)
    assert found is not None
    assert found.angle_deg == pytest.approx(30.3, abs=1.5)
    assert found.share == pytest.approx(6 / 16)
    (problem,) = direction_problems(wing)
    assert problem.code == "two-directions"
    assert "38 %" in problem.message


@pytest.mark.parametrize(
    ("angles_deg", "pixels"),
    [
        ([10.0, 190.0], [4000, 4000]),  # one skewed wall, both sides
        (list(np.arange(0.0, 360.0, 10.0)), [300] * 36),  # a round hall
        ([30.0, 120.0], [300, 300]),  # a cupboard put down askew
        ([], []),
    ],
)
def test_what_is_no_second_direction_is_not_told(angles_deg: list[float], pixels: list[int]) -> None:
    assert second_direction(scanned(angles_deg, pixels)) is None


def test_a_direction_across_the_fold_is_one() -> None:
    found = second_direction(scanned([89.0, 91.5, 179.0, 1.5], [1500, 1500, 1500, 1500]))
    assert found is not None
    assert min(found.angle_deg, 90 - found.angle_deg) < 2.0
    assert second_direction(replace(scanned([45.0], [1]))) is None
