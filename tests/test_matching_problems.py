"""Problems of a matched trajectory, and none where there are none."""

from dataclasses import replace

import numpy as np

from floorplan.loop_closing import ClosedLoops
from floorplan.matching_problems import matching_problems
from floorplan.model.scan import Recording, Wheels, WheelTurn
from floorplan.sweep_matching import MatchedSweeps, RefinedOdometry
from tests.sweep_matching.swept_room import box, swept_room


def refined(matched: list[float], turn: WheelTurn | None = None) -> MatchedSweeps:
    count = len(matched)
    nothing = np.zeros((count, 3, 3))
    steps = RefinedOdometry(np.zeros((count, 3)), np.array(matched), nothing, nothing, np.zeros(0, dtype=np.int64), ())
    return MatchedSweeps(steps, Wheels(None, turn))


def driven() -> Recording:
    still = swept_room(np.zeros((3, 3)), np.zeros((3, 3)), box(-1.0, -1.0, 1.0, 1.0)).recording
    return replace(still, position_m=np.eye(3))


def closed(joined: int, rejected: int) -> ClosedLoops:
    return ClosedLoops(np.zeros((1, 3)), np.ones(1), joined, rejected)


def test_sweeps_that_fit_nothing_for_a_while_are_counted_and_one_alone_is_not() -> None:
    assert matching_problems(driven(), refined([0.0, 0.9, 0.1, 0.95, 0.9]), None) == ()
    (lost,) = matching_problems(driven(), refined([0.0, 0.9, 0.1, 0.2, 0.0, 0.9]), closed(9, 1))
    assert (lost.code, lost.count, lost.where, lost.fatal) == ("sweeps-lost", 3, "sweep 2", False)


def test_a_fifth_of_the_loops_may_contradict_the_others_and_more_are_reported() -> None:
    assert matching_problems(driven(), refined([0.0, 0.9]), closed(80, 20)) == ()
    (wrong,) = matching_problems(driven(), refined([0.0, 0.9]), closed(70, 30))
    assert (wrong.code, wrong.count) == ("loops-contradict", 30)


def test_wheels_that_turn_too_far_are_told_when_they_were_mended() -> None:
    assert matching_problems(driven(), refined([0.0, 0.9], WheelTurn(0.05, -0.03, 0.001, 0.001, applied=False)), None) == ()
    (mended,) = matching_problems(driven(), refined([0.0, 0.9], WheelTurn(0.05, -0.03, 0.001, 0.001, applied=True)), None)
    assert mended.code == "odometry-mended"
    assert "+2.9 degrees a metre" in mended.message


def test_odometry_that_stands_while_the_sweeps_move_is_told_and_a_tripod_is_not() -> None:
    still = replace(driven(), position_m=np.zeros((3, 3)))
    sweeps = refined([0.0, 0.9, 0.9])
    assert matching_problems(still, sweeps, None) == ()
    gone = replace(sweeps, refined=replace(sweeps.refined, pose=np.array([(0.0, 0.0, 0.0), (0.4, 0.0, 0.0), (0.8, 0.0, 0.0)])))
    (told,) = matching_problems(still, gone, None)
    assert (told.code, told.count) == ("odometry-still", 3)
    assert matching_problems(driven(), gone, None) == ()
