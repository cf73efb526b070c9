"""How bad data is told."""

from floorplan.model.scan import Problem
from floorplan.reporting import problem_words


def test_a_problem_says_its_place_and_count_where_it_has_them() -> None:
    here = Problem("frame-gap", "gaps between frames", "4.000 s", 2, "walk again")
    assert problem_words(here) == "frame-gap: gaps between frames (2x, first: 4.000 s); walk again"
    whole = Problem("odometry-mended", "wheels mended", advice="look")
    assert problem_words(whole) == "odometry-mended: wheels mended; look"
    assert "(3x);" in problem_words(Problem("odd", "odd", "", 3, "look"))
