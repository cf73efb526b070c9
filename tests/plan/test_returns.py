"""Steps of a wall whose short face was not seen."""

import numpy as np
import pytest

from floorplan.config import PlanConfig
from floorplan.plan.free_space import CELL_M, FreeSpace
from floorplan.plan.returns import step_barriers, steps, with_steps
from tests.plan.test_closures import face

CONFIG = PlanConfig()


def space(free: bool) -> FreeSpace:
    """Ten metres square, crossed by rays everywhere or nowhere."""
    cells = np.full((round(10 / CELL_M),) * 2, free)
    integral = np.zeros((cells.shape[0] + 1, cells.shape[1] + 1))
    integral[1:, 1:] = cells.cumsum(axis=0).cumsum(axis=1)
    return FreeSpace(np.zeros(2), integral)


def test_a_pier_before_a_wall_is_closed_up_to_where_the_wall_was_seen() -> None:
    pier, wall = face(1, 1, 5.3, 2.0, 3.0), face(1, 1, 5.0, 3.1, 6.0)
    (step,) = steps((pier, wall), space(free=False), CONFIG)
    assert (step.axis, step.at_m, step.low_m, step.high_m) == (0, 3.0, 5.0, 5.3)
    ends = [(b.axis, b.offset_m, b.start_m, b.end_m) for b in step_barriers((step,))]
    assert ends == [(0, 3.0, 5.0, 5.3), (1, 5.0, 3.0, pytest.approx(3.1))]
    (drawn,) = with_steps((), (step,))
    assert (drawn.seen, drawn.inferred) == ((), (((3.0, 5.3), (3.0, 5.0), (3.1, 5.0)),))


def test_no_step_is_drawn_where_rays_went_through_or_a_face_was_seen_or_the_surfaces_do_not_meet() -> None:
    pier, wall = face(1, 1, 5.3, 2.0, 3.0), face(1, 1, 5.0, 3.1, 6.0)
    assert steps((pier, wall), space(free=True), CONFIG) == ()
    assert steps((pier, wall, face(0, 1, 3.0, 5.0, 5.3)), space(free=False), CONFIG) == ()
    assert steps((pier, face(1, 1, 5.0, 3.8, 6.0)), space(free=False), CONFIG) == ()
    assert steps((pier, face(1, 1, 4.5, 3.1, 6.0)), space(free=False), CONFIG) == ()
    assert steps((pier, face(1, 1, 5.26, 3.1, 6.0)), space(free=False), CONFIG) == ()
    assert steps((pier, face(1, 1, 5.0, 1.0, 6.0)), space(free=False), CONFIG) == ()
