"""Ends of walls and the faces they are put onto."""

import pytest

from floorplan.plan.corners import FaceRun, joined_corners
from floorplan.plan.faces import Run


def face(axis: int, facing: int, offset_m: float, start_m: float, end_m: float) -> FaceRun:
    return FaceRun(Run(0, start_m, end_m, ((start_m, end_m),), 0.0, 2.6, 100.0), axis, facing, offset_m, 0.001)


def test_a_wall_ends_at_the_face_that_looks_back_along_it_though_the_other_face_of_that_wall_is_nearer() -> None:
    near, far = face(0, +1, 2.0, 0.0, 4.0), face(0, -1, 1.85, 0.0, 4.0)  # a wall 15 cm thick
    joined = joined_corners((face(1, +1, 1.0, 1.90, 5.0), near, far), 0.3)[0]
    assert joined.start_m == pytest.approx(2.0)
    assert joined.inner == (True, False)
