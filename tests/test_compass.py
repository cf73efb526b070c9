"""The compass against rendered rooms whose yaw is known."""

import importlib
from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest

from floorplan.compass import CompassPrior, survey
from floorplan.compass.directions import BINS
from floorplan.compass.entropy import projection_entropy
from floorplan.compass.path import best_path
from floorplan.compass.smoothing import smooth_angle
from floorplan.config import CompassConfig
from floorplan.errors import InputError
from floorplan.geometry import rotation_about_z
from floorplan.model.checks import Array
from floorplan.model.scan import IngestedScan
from tests.box_room import BoxScan, camera_scan, laser_scan, yaw_error_rad


def _error_deg(box: BoxScan, prior: CompassPrior) -> Array:
    return np.degrees(yaw_error_rad(rotation_about_z(prior.yaw_rad) @ prior.level_from_sensor, box.world_from_sensor))


@pytest.mark.parametrize("start_yaw_deg", [0.0, 17.0, 44.0, 89.7])
def test_the_prior_yaw_is_right_wherever_the_odometry_starts(start_yaw_deg: float) -> None:
    box = camera_scan(start_yaw_deg=start_yaw_deg)
    error = _error_deg(box, survey(box.scan, box, CompassConfig()))
    assert 1e-6 < np.abs(error).max() < 0.6


def test_a_drifting_heading_is_followed() -> None:
    box = camera_scan(frames=60, odometry_yaw_drift_deg=0.5)
    error = _error_deg(box, survey(box.scan, box, CompassConfig()))
    assert np.abs(error).max() < 0.8


def test_clutter_hardly_moves_the_prior() -> None:
    box = replace(camera_scan(), clutter_share=0.3)
    assert np.abs(_error_deg(box, survey(box.scan, box, CompassConfig()))).max() < 1.0


def test_a_laser_whose_odometry_slips_keeps_its_quarter_turn() -> None:
    box = laser_scan(frames=60, odometry_yaw_drift_deg=3.0)
    prior = survey(box.scan, box, CompassConfig())
    assert np.abs(_error_deg(box, prior)).max() < 3.0
    assert np.ptp(np.degrees(prior.yaw_rad)) == pytest.approx(59 * 3.0, abs=5.0)


def test_the_published_search_finds_the_yaw_too() -> None:
    box = camera_scan()
    prior = survey(box.scan, box, CompassConfig(method="entropy"))
    error = _error_deg(box, prior)
    assert prior.final
    assert prior.measured.all()
    assert 1e-6 < np.sqrt((error**2).mean()) < 0.15


def test_entropy_is_least_when_walls_are_aligned_and_does_not_care_for_bin_edges() -> None:
    along = np.linspace(0, 3, 400)
    for offset in (2.0, 2.01, 2.004):  # on an edge of the 2 cm bins, between, beside
        points = np.concatenate((np.stack((along, 0 * along + offset, 0 * along), 1), np.stack((0 * along + offset, along, 0 * along), 1)))
        yaw = np.radians(np.arange(-3.0, 3.01, 0.5))
        entropy = projection_entropy(points, yaw)
        assert abs(yaw[entropy.argmin()]) < 1e-9


def test_unknown_gravity_is_refused_with_advice() -> None:
    box = camera_scan(frames=3)
    recording = replace(box.recording, down_sensor=np.full((3, 3), np.nan))
    with pytest.raises(InputError, match="gravity"):
        survey(IngestedScan(recording, np.arange(3)), box, CompassConfig())


def test_the_path_crosses_a_gap_without_evidence_and_keeps_the_quarter_turn() -> None:
    histograms = np.zeros((40, BINS))
    for k in range(40):
        if not 10 <= k < 30:
            histograms[k, (170 + k) % BINS] = 0.8  # half a degree per frame, over the quarter turn's edge
    path = np.degrees(best_path(histograms, np.full(39, np.radians(1.0))))
    assert path[9] == pytest.approx(89.5, abs=0.6)
    assert path[-1] == pytest.approx(104.5, abs=0.6)
    assert np.abs(np.diff(path)).max() < 3.0


def test_smoothing_learns_its_noise_and_is_better_than_the_readings() -> None:
    random = np.random.default_rng(3)
    truth = np.cumsum(random.normal(scale=0.0005, size=400))
    reading = truth + random.normal(scale=0.004, size=400)
    reading[::40] += 0.1  # outliers
    smooth = smooth_angle(reading, np.full(400, 0.002), np.ones(399))  # the readings claim half their noise
    error = smooth.angle_rad - truth
    assert 0.0005 < np.sqrt((error**2).mean()) < 0.002
    assert 0.5 < np.sqrt((error**2 / smooth.sigma_rad**2).mean()) < 1.6


def test_smoothing_holds_the_angle_through_a_gap_and_says_so() -> None:
    sigma = np.full(100, 0.001)
    sigma[40:60] = np.inf
    smooth = smooth_angle(np.full(100, 0.3), sigma, np.ones(99))
    assert np.abs(smooth.angle_rad - 0.3).max() < 1e-6
    assert smooth.sigma_rad[50] >= smooth.sigma_rad[10]


def test_a_slip_is_not_spread_over_its_neighbours_and_a_stray_reading_is_no_slip() -> None:
    random = np.random.default_rng(4)
    truth = np.where(np.arange(200) < 90, 0.0, np.radians(15.0))
    reading = truth + random.normal(scale=0.001, size=200)
    reading[40] += np.radians(15.0)
    smooth = smooth_angle(reading, np.full(200, 0.001), np.ones(199), slips=True, most_scale=1.0)
    error = np.degrees(np.abs(smooth.angle_rad - truth))
    assert 1e-6 < error.max() < 0.4  # readings alone: 0.2; the stray one is off by 15


@pytest.mark.parametrize(("scan", "share"), [(camera_scan, 9), (laser_scan, 3)])
def test_a_recording_too_long_for_memory_keeps_fewer_directions_and_finds_the_same_yaw(
    scan: Callable[[], BoxScan], share: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    box = scan()
    every = survey(box.scan, box, CompassConfig())
    pixels = box.recording.sensor.width * box.recording.sensor.height * len(box.recording)
    monkeypatch.setattr(importlib.import_module("floorplan.compass.survey"), "_MOST_DIRECTIONS", pixels // share)
    few = survey(box.scan, box, CompassConfig())
    assert 0 < np.degrees(np.abs(few.yaw_rad - every.yaw_rad).max()) < 0.5
    assert few.noise.pixel == every.noise.pixel
