"""What is seen only through glass is inferred; a mirror image of the room is nothing."""

import numpy as np
import pytest

from floorplan.config import PlanConfig
from floorplan.model.scan import Trajectory
from floorplan.plan.behind_glass import SeenThrough, walls_behind_glass
from floorplan.plan.corners import FaceRun
from floorplan.plan.glazing import GlazedLine
from floorplan.plan.plan_frame import PlanWorld
from floorplan.plan.surface_evidence import FINE_CELLS, PlaneEvidence

COLUMNS, ROWS, STEP_M, UP_M = 80, 30, 0.05, 0.10
GLASS = GlazedLine(0, 5.0, 0.0, 4.0)
NO_FACES: tuple[FaceRun, ...] = ()


def world(plane_offsets: list[float], plane_facings: list[int], sensor_x_m: float = 2.0) -> PlanWorld:
    """Planes normal to x over 0 to 4 m in y, each seen in 9 of 9 frames taken from `sensor_x_m`."""
    n, frames = len(plane_offsets), 9
    position = np.column_stack((np.full(frames, sensor_x_m), np.linspace(1, 3, frames), np.full(frames, 1.4)))
    extent = np.tile([[0.0, 0.0], [0.0, 4.0], [0.0, 2.6]], (n, 1, 1))
    extent[:, 0] = np.array(plane_offsets)[:, None]
    path = Trajectory(np.arange(frames), position, np.tile(np.eye(3), (frames, 1, 1)))
    no_points = np.zeros(0)
    return PlanWorld(
        path,
        np.zeros(n, dtype=int),
        np.array(plane_facings),
        np.array(plane_offsets),
        np.full(n, 0.01),
        extent,
        np.full(n, frames),
        np.zeros((0, 3)),
        no_points,
        no_points,
        no_points,
        no_points,
        heights=True,
    )


def evidence(stopped: float, passed: float) -> PlaneEvidence:
    """Plane 0: rays stopped and passed above 1.9 m, from 1 to 3.5 m along it; nothing lower down."""
    hits, passes = np.zeros((COLUMNS, ROWS)), np.zeros((COLUMNS, ROWS))
    hits[20:70, 22:28], passes[20:70, 22:28] = stopped, passed
    fine = np.zeros(COLUMNS * FINE_CELLS)
    seen = np.argwhere(hits.sum(axis=1)[:, None] * np.ones(9) > 0).astype(np.int32)
    return PlaneEvidence(0, 0.0, STEP_M, -0.3, UP_M, hits, passes, np.zeros_like(hits), fine, fine, seen)


def behind(scene: PlanWorld, item: PlaneEvidence) -> SeenThrough:
    return walls_behind_glass(scene, (item,), NO_FACES, (GLASS,), PlanConfig())


def test_a_wall_that_stopped_what_came_through_the_glass_is_found_without_a_seen_part() -> None:
    (face,) = behind(world([7.5], [-1]), evidence(6.0, 1.0)).faces
    assert (face.start_m, face.end_m) == pytest.approx((1.0, 3.5))
    assert face.run.seen == ()


def test_where_as_many_rays_went_on_there_is_no_wall() -> None:
    assert behind(world([7.5], [-1]), evidence(6.0, 3.0)).faces == ()


def test_a_mirror_image_of_the_rooms_own_wall_is_counted_as_a_reflection() -> None:
    result = behind(world([8.0, 2.05], [-1, 1]), evidence(6.0, 0.0))
    assert result.faces == ()
    (rejection,) = result.rejections
    assert (rejection.count, rejection.length_m) == (1, pytest.approx(2.5))


def test_what_was_seen_from_behind_the_glass_too_is_left_to_the_usual_judgement() -> None:
    assert behind(world([7.5], [-1], sensor_x_m=6.0), evidence(6.0, 0.0)).faces == ()
