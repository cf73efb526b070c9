"""Two surveys of the two rooms: the same, turned, noisy, and after works."""

from dataclasses import replace

import numpy as np
import pytest

from floorplan.cli.compare_command import alignment_warnings, opening_words
from floorplan.compare import Survey, compare_surveys
from floorplan.compare.openings import OpeningState
from floorplan.compare.survey import Rays
from floorplan.compare.turn import turned_plan
from floorplan.errors import InputError
from floorplan.model.checks import Array
from floorplan.model.plan import Certainty, Face, Opening, OpeningKind, Plan, PlanPlane
from tests.laser.plans import EAST, MID_EAST, MID_WEST, NORTH, SOUTH, WEST, two_rooms

NO_RAYS = Rays(np.zeros((0, 3)), np.zeros((0, 3)))
SHIFT = np.array([31.2, -7.7, 0.0])


def survey(plan: Plan, rays: Rays = NO_RAYS) -> Survey:
    return Survey("survey", plan, rays)


def moved(plan: Plan, number: int, by_m: float) -> Plan:
    """The plan with one plane, and its faces, moved along its axis."""
    plane = plan.planes[number]
    shifted = {f.id: replace(f, start=_along(f.start, plane, by_m), end=_along(f.end, plane, by_m)) for f in plan.faces}
    faces = [shifted[f.id] if f.plane == plane.id else f for f in plan.faces]
    planes = [replace(p, offset_m=p.offset_m + by_m) if p.id == plane.id else p for p in plan.planes]
    return replace(plan, planes=tuple(planes), faces=tuple(faces))


def _along(point: tuple[float, float], plane: PlanPlane, by_m: float) -> tuple[float, float]:
    return (point[0] + by_m, point[1]) if plane.axis == 0 else (point[0], point[1] + by_m)


def partition() -> Plan:
    """The two rooms with a partition of one face, 1.2 m long, in the west room."""
    plan = two_rooms()
    plane = PlanPlane("P7", 0, 1, 2.0, 0.01, ((2.0, 2.0), (1.0, 2.2), (0.0, 2.5)), (6,), 10)
    face = Face("F7", "P7", (2.0, 1.0), (2.0, 2.2), Certainty.SEEN)
    return replace(plan, planes=(*plan.planes, plane), faces=(*plan.faces, face), plane_covariance_m2=1e-4 * np.eye(7))


def rays_across(x0: float, x1: float, y: Array) -> Rays:
    """Level rays from x0 to x1 at each y."""
    height = np.full(len(y), 1.5)
    return Rays(np.column_stack((np.full(len(y), x0), y, height)), np.column_stack((np.full(len(y), x1), y, height)))


@pytest.mark.parametrize("quarters", range(4))
def test_the_same_plan_turned_and_shifted_is_laid_back_and_nothing_moved(quarters: int) -> None:
    plan = two_rooms()
    comparison = compare_surveys(survey(plan), survey(turned_plan(plan, quarters, SHIFT)))
    assert comparison.alignment.quarters == -quarters % 4
    assert not comparison.alignment.ambiguous
    assert [wall.moved_m for wall in comparison.walls] == pytest.approx([0.0] * 6, abs=1e-9)
    assert [d.difference_m for d in comparison.distances] == pytest.approx([0.0] * 3, abs=1e-9)
    assert not comparison.changed
    assert [f.start for f in comparison.second_plan.faces] == [pytest.approx(f.start, abs=1e-9) for f in plan.faces]


def test_one_wall_that_moved_is_found_and_pulls_no_other() -> None:
    comparison = compare_surveys(survey(two_rooms()), survey(turned_plan(moved(two_rooms(), 3, 0.15), 1, SHIFT)))
    walls = {wall.first: wall for wall in comparison.walls}
    assert comparison.walls[0] is walls[("F4",)]
    assert walls[("F4",)].moved_m == pytest.approx(0.15, abs=1e-9)
    assert 0.01 < walls[("F4",)].interval_m < 0.06
    assert [wall.moved for wall in comparison.walls] == [True] + [False] * 5
    changed = [d for d in comparison.distances if d.moved]
    assert [(d.first, d.second) for d in changed] == [("D2", "D2")]
    assert changed[0].difference_m == pytest.approx(0.15, abs=1e-9)
    assert changed[0].interval_m == pytest.approx(1.96 * 0.01 * np.sqrt(2), rel=1e-6)


def test_noise_of_the_stated_size_stays_inside_the_combined_interval_as_often_as_it_should() -> None:
    rng, plan, shares = np.random.default_rng(5), two_rooms(), []
    root = np.linalg.cholesky(plan.plane_covariance_m2)
    for _ in range(60):
        noisy = [plan, plan]
        for which in range(2):
            for number, by_m in enumerate(root @ rng.normal(size=6)):
                noisy[which] = moved(noisy[which], number, float(by_m))
        comparison = compare_surveys(survey(noisy[0]), survey(noisy[1]))
        shares += [not wall.moved for wall in comparison.walls]
    assert 0.92 < np.mean(shares) < 0.98


def test_a_partition_is_new_only_where_the_first_survey_looked_through_its_place() -> None:
    old, new = two_rooms(), partition()
    through = rays_across(1.0, 3.9, np.linspace(0.5, 4.5, 400))
    found = compare_surveys(survey(old, through), survey(new))
    assert [(piece.wall, round(piece.length_m, 2)) for piece in found.new] == [("F7", 1.2)]
    assert found.gone == ()
    assert compare_surveys(survey(new), survey(old, through)).gone[0].wall == "F7"
    blind = compare_surveys(survey(old), survey(new))
    assert blind.new == ()
    assert blind.unseen_m == pytest.approx(1.2, abs=0.06)
    surface = compare_surveys(survey(old, rays_across(1.0, 2.02, np.linspace(0.5, 4.5, 400))), survey(new))
    assert (surface.new, surface.unseen_m) == ((), 0.0)  # something stood there, drawn or not


def test_a_door_is_moved_widened_or_closed() -> None:
    door = Opening("O1", OpeningKind.DOOR, ((MID_WEST + MID_EAST) / 2, 2.0), 1, 0.9, 0.01)
    before = replace(two_rooms(), openings=(door,))
    wider = replace(before, openings=(replace(door, width_m=1.0, centre=(door.centre[0], 2.05)),))
    (change,) = compare_surveys(survey(before), survey(turned_plan(wider, 2, SHIFT))).openings
    assert (change.state, change.first, change.second) == (OpeningState.MOVED, "O1", "O1")
    assert (change.moved_m, change.width_difference_m) == (pytest.approx(0.05), pytest.approx(0.1))
    (closed,) = compare_surveys(survey(before), survey(two_rooms())).openings
    assert (closed.state, closed.first, closed.second) == (OpeningState.CLOSED, "O1", "")
    assert [c.state for c in compare_surveys(survey(two_rooms()), survey(before)).openings] == [OpeningState.NEW]


def test_a_window_that_became_a_door_is_named_as_such() -> None:
    window = Opening("O1", OpeningKind.WINDOW, ((MID_WEST + MID_EAST) / 2, 2.0), 1, 0.9, 0.01)
    before = replace(two_rooms(), openings=(window,))
    (change,) = compare_surveys(survey(before), survey(replace(before, openings=(replace(window, kind=OpeningKind.DOOR),)))).openings
    assert (change.state, change.moved) == (OpeningState.CHANGED, True)
    assert opening_words(change) == "changed: window, now door"
    passage = replace(before, openings=(replace(window, kind=OpeningKind.PASSAGE),))
    door = replace(before, openings=(replace(window, kind=OpeningKind.DOOR),))
    assert [c.state for c in compare_surveys(survey(passage), survey(door)).openings] == [OpeningState.SAME]


def test_an_alignment_that_may_be_chance_is_told_loudly() -> None:
    sure = compare_surveys(survey(two_rooms()), survey(two_rooms()))
    assert sure.alignment.share == pytest.approx(1.0)
    assert alignment_warnings(sure) == ()
    doubtful = replace(sure, alignment=replace(sure.alignment, share=0.4, matched_m=20.0), unseen_m=72.7)
    assert [word in text for word, text in zip(("only 40 %", "72.7 m"), alignment_warnings(doubtful), strict=True)] == [True, True]


def test_surveys_without_a_wall_in_common_are_refused() -> None:
    plan = two_rooms()
    unseen = replace(plan, faces=tuple(replace(face, certainty=Certainty.INFERRED) for face in plan.faces))
    with pytest.raises(InputError, match="different floors"):
        compare_surveys(survey(plan), survey(unseen))


def test_repeatability_is_the_median_and_the_95th_percentile_of_the_differences() -> None:
    comparison = compare_surveys(survey(two_rooms()), survey(moved(moved(two_rooms(), 0, 0.02), 4, -0.01)))
    agreed = comparison.wall_repeatability
    assert agreed is not None
    assert agreed.count == 6
    assert agreed.median_m == pytest.approx(0.0051, abs=0.002)
    assert 0.01 < agreed.p95_m < 0.02
    assert agreed.share_within == 1.0


def test_the_rooms_are_as_this_test_takes_them() -> None:
    assert (WEST, EAST, SOUTH, NORTH) == (0.0, 7.12, 0.0, 5.0)
