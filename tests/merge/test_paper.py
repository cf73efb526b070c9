"""The published merge against problems solved by hand: feasibility, objective, duals, complementarity."""

import numpy as np
import pytest

from floorplan.config import LeastSquaresConfig, MergeConfig
from floorplan.errors import ConfigError, NoSolutionError
from floorplan.least_squares import least_squares
from floorplan.merge import merge
from floorplan.merge.certificate import certify
from floorplan.merge.hypotheses import Pairs, pairs_within, planes_of_tracks
from floorplan.merge.paper import solve_paper
from floorplan.merge.paper_problem import PaperAnswer, PaperProblem, paper_problem
from floorplan.model.graph import LayoutGraph, MergeResult
from tests.graphs import graph_along_x, loop_graph

ENGINES = ["cvxpy", "reduced"]
# Planes at 2 and 2.5, each seen twice with -+ 0.1: the least squares leaves 0.2 in all.
TWO_PLANES = graph_along_x([], [(0, 0, 1.9), (0, 0, 2.1), (0, 1, 2.4), (0, 1, 2.6)], facing=[-1, -1])
# Seen 0.1 ahead from two places a metre apart: with the signs kept, plane and second place meet at 0.55.
WRONG_SIDE = graph_along_x([1.0], [(0, 0, 0.1), (1, 0, 0.1), (0, 1, 1.9), (0, 1, 2.1)], facing=[-1, -1])


def problem_of(graph: LayoutGraph, radius_m: float = 1.0, eps: float = 0.02) -> PaperProblem:
    return paper_problem(graph, least_squares(graph, LeastSquaresConfig(method="plain")), radius_m, eps)


def merged(graph: LayoutGraph, **settings: float | str) -> MergeResult:
    return merge(graph, least_squares(graph, LeastSquaresConfig(method="plain")), MergeConfig(method="paper", **settings))


@pytest.mark.parametrize("engine", ENGINES)
def test_two_planes_move_towards_each_other_by_half_the_slack_each(engine: str) -> None:
    # delta = 1.25 * 0.2, slack = sqrt(0.25^2 - 0.2^2) = 0.15; weights 2 and 2: each moves 0.15 / 2.
    problem = problem_of(TWO_PLANES, eps=0.25)
    answer, certificate = solve_paper(problem, engine)
    assert problem.slack_m == pytest.approx(0.15)
    np.testing.assert_allclose(answer.track_offset_m, [2.075, 2.425], atol=1e-5)
    assert certificate.objective_m == pytest.approx(0.35, abs=1e-6)
    assert certificate.bound_m == pytest.approx(0.35, abs=1e-6)
    assert certificate.residual_m == pytest.approx(0.25, rel=1e-6)
    np.testing.assert_allclose(answer.pair_dual, [-1], atol=1e-5)  # the gap is negative: its sign
    np.testing.assert_allclose(answer.sign_dual, 0, atol=1e-5)  # no sign row is active


@pytest.mark.parametrize("engine", ENGINES)
def test_a_wide_ball_merges_the_planes_and_leaves_their_dual_inside(engine: str) -> None:
    problem = problem_of(TWO_PLANES, eps=3.0)
    answer, certificate = solve_paper(problem, engine)
    assert certificate.objective_m == pytest.approx(0, abs=1e-5)
    assert np.abs(answer.pair_dual).max() < 1


@pytest.mark.parametrize("engine", ENGINES)
def test_thresholding_by_mu_decides_and_components_follow(engine: str) -> None:
    assert merged(TWO_PLANES, eps=0.25, mu_m=0.34, engine=engine).plane_of_track.tolist() == [0, 1]
    result = merged(TWO_PLANES, eps=0.25, mu_m=0.36, engine=engine)
    assert result.plane_of_track.tolist() == [0, 0]
    assert result.hypotheses.accepted.tolist() == [True]
    assert result.hypotheses.distance_m[0] == pytest.approx(-0.5)
    assert result.hypotheses.solved_distance_m[0] == pytest.approx(-0.35, abs=1e-5)


@pytest.mark.parametrize("engine", ENGINES)
def test_an_empty_ball_is_an_error_that_says_what_to_try(engine: str) -> None:
    with pytest.raises(NoSolutionError, match=r"keeps every measurement's sign.*merge\.eps"):
        merged(WRONG_SIDE, eps=0.02, engine=engine)


@pytest.mark.parametrize("engine", ENGINES)
def test_an_active_sign_row_has_a_positive_dual_and_the_gap_still_closes(engine: str) -> None:
    problem = problem_of(WRONG_SIDE, radius_m=3.0, eps=0.2)
    answer, certificate = solve_paper(problem, engine)
    excess = problem.sign_excess_m(answer.position_m, answer.track_offset_m)
    assert excess.max() == pytest.approx(0, abs=1e-5)
    assert answer.sign_dual[np.argmax(excess)] > 0.1
    assert np.abs(answer.sign_dual * excess).max() < 1e-4
    assert certificate.gap < 1e-5


@pytest.mark.parametrize("engine", ENGINES)
def test_a_noisy_loop_is_solved_to_the_optimum_inside_the_ball(engine: str) -> None:
    problem = problem_of(loop_graph(1, drift_m=0.05)[0], eps=0.001)
    answer, certificate = solve_paper(problem, engine)
    assert certificate.gap < 1e-6
    assert certificate.residual_m == pytest.approx(problem.delta_m, rel=1e-6)
    gap = problem.pairs.gap_m(answer.track_offset_m)
    apart = np.abs(gap) > 1e-3
    np.testing.assert_allclose(answer.pair_dual[apart], np.sign(gap[apart]), atol=1e-3)  # complementarity
    assert certificate.objective_m < problem.objective(problem.least_squares.track_offset_m)


@pytest.mark.parametrize("engine", ENGINES)
def test_rows_that_agree_exactly_give_the_truth(engine: str) -> None:
    graph, position, plane = loop_graph(0, sigma_m=0, drift_m=0)
    result = merged(graph, engine=engine)
    np.testing.assert_allclose(result.position_m, position, atol=1e-9)
    np.testing.assert_array_equal(result.plane_of_track, plane)


def test_answers_that_are_infeasible_or_not_optimal_are_found_out() -> None:
    problem = problem_of(TWO_PLANES, eps=0.25)
    outside = PaperAnswer(np.zeros((1, 3)), np.array([2.2, 2.3]), np.array([-1.0]), np.zeros(4))
    assert any("exceeds the ball" in fault for fault in certify(problem, outside).faults())
    lazy = PaperAnswer(np.zeros((1, 3)), np.array([2.0, 2.5]), np.array([-1.0]), np.zeros(4))
    assert any("not the optimum" in fault for fault in certify(problem, lazy).faults())
    behind = PaperAnswer(np.zeros((1, 3)), np.array([-2.0, 2.5]), np.array([-1.0]), np.zeros(4))
    assert any("wrong side" in fault for fault in certify(problem, behind).faults())
    missing = PaperAnswer(np.zeros((1, 3)), np.array([np.nan, 2.5]), np.array([-1.0]), np.zeros(4))
    assert any("not finite" in fault for fault in certify(problem, missing).faults())


def test_pairs_are_of_equal_axis_and_facing_within_the_radius_after_least_squares() -> None:
    graph = graph_along_x([], [(0, t, d) for t, d in enumerate([2.0, 2.9, 3.1, -2.0, -2.5])], facing=[-1, -1, -1, 1, 1])
    pairs = pairs_within(graph, np.array([2.0, 2.9, 3.1, -2.0, -2.5]), 1.0)
    assert list(zip(pairs.first.tolist(), pairs.second.tolist(), strict=True)) == [(0, 1), (1, 2), (3, 4)]


def test_accepted_pairs_chain_and_planes_are_numbered_by_their_first_track() -> None:
    assert planes_of_tracks(5, Pairs(np.array([1, 2]), np.array([3, 3]))).tolist() == [0, 1, 1, 1, 2]


def test_an_unknown_method_or_engine_is_an_error_of_use() -> None:
    with pytest.raises(ConfigError, match="engine"):
        merged(TWO_PLANES, engine="abacus")
    with pytest.raises(ConfigError, match="method"):
        merge(TWO_PLANES, least_squares(TWO_PLANES, LeastSquaresConfig(method="plain")), MergeConfig(method="abacus"))
