"""What a sheet says of a plan calibrated by tape."""

from floorplan.drawings import _calibration_words
from floorplan.model.ties import Calibration, TiedDistance


def tied(used: bool) -> TiedDistance:
    return TiedDistance(1, "D1", 5.0, 0.002, 5.05, 5.001, 5.0, 0.004, used)


def test_a_sheet_says_with_how_many_distances_and_what_factor_the_plan_was_calibrated() -> None:
    words = _calibration_words(Calibration(0.9912, 0.0004, (tied(True), tied(True), tied(False))))
    assert "2 measured distances (1 more left out" in words
    assert "factor 0.99120 +-0.00078" in words


def test_a_sheet_says_that_one_distance_gives_no_factor_and_nothing_without_any() -> None:
    assert _calibration_words(Calibration(1.0, 0.0, (tied(True),))) == "Calibrated by tape with 1 measured distance; no common factor."
    assert _calibration_words(None) == ""
