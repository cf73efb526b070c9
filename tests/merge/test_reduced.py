"""The reduced engine gives the verbatim optimum: objective, planes, trajectory, threshold decisions."""

import numpy as np
import pytest

from floorplan.config import LeastSquaresConfig
from floorplan.least_squares import least_squares
from floorplan.merge.paper import solve_paper
from floorplan.merge.paper_problem import PaperProblem, paper_problem
from tests.bench.scenes import Errors, make_scene, paper_scene, scale_spec
from tests.graphs import graph_along_x, loop_graph

MU_M = 0.30


def problem_of(name: str, seed: int, errors: Errors | None = None, radius_m: float = 1.0, eps: float = 0.02) -> PaperProblem:
    graph = paper_scene(name, seed, errors).graph
    return paper_problem(graph, least_squares(graph, LeastSquaresConfig(method="plain")), radius_m, eps)


@pytest.mark.parametrize(
    ("name", "seed", "errors"),
    [
        ("area1", 2, None),
        ("area4", 3, None),
        ("area5", 4, Errors(sigma_m=0.03, outliers=0.05, track_bias_m=0.012)),
        ("area6", 5, Errors(odometry_factor=2.0)),
    ],
)
def test_it_agrees_with_the_verbatim_problem(name: str, seed: int, errors: Errors | None) -> None:
    problem = problem_of(name, seed, errors)
    (verbatim, reference), (reduced, certificate) = solve_paper(problem, "cvxpy"), solve_paper(problem, "reduced")
    assert abs(certificate.objective_m / reference.objective_m - 1) < 1e-5
    np.testing.assert_allclose(reduced.track_offset_m, verbatim.track_offset_m, atol=1e-3)
    np.testing.assert_allclose(reduced.position_m, verbatim.position_m, atol=1e-3)
    ours, theirs = (np.abs(problem.pairs.gap_m(answer.track_offset_m)) for answer in (reduced, verbatim))
    clear = np.abs(theirs - MU_M) > 1e-3
    np.testing.assert_array_equal((ours <= MU_M)[clear], (theirs <= MU_M)[clear])


@pytest.mark.parametrize("seed", range(6))
def test_every_noise_level_radius_and_eps_closes_the_gap(seed: int) -> None:
    rng = np.random.default_rng(seed)
    graph = loop_graph(seed, rounds=2 + seed % 3, sigma_m=10 ** rng.uniform(-3, -1), drift_m=10 ** rng.uniform(-3, -1))[0]
    problem = paper_problem(graph, least_squares(graph, LeastSquaresConfig(method="plain")), rng.uniform(0.3, 3), 10 ** rng.uniform(-4, 0))
    certificate = solve_paper(problem, "reduced")[1]
    assert certificate.objective_m - certificate.bound_m < 1e-6 + 1e-6 * certificate.objective_m
    assert certificate.residual_m < problem.delta_m * (1 + 1e-9)


def test_sign_rows_that_the_pull_would_violate_enter_and_the_answer_is_still_the_verbatim_one() -> None:
    # Odometry walks 0.3 m through the wall at 2 m, which is seen 5 cm ahead from there, while five panels at 1.3 m pull it back.
    rng = np.random.default_rng(0)
    place = np.concatenate((np.linspace(0, 1.5, 15), np.full(6, 2.3), np.linspace(1.5, 0, 15)))
    rows = [(i, 0, 2.0 - place[i] if place[i] < 2 else 0.05) for i in range(6, 30)]
    rows += [(i, 1 + i % 5, 1.3 - place[i]) for i in (*range(10), *range(26, 36))]
    rows = [(frame, track, max(d + rng.normal(0, 0.01), 0.005)) for frame, track, d in rows]
    graph = graph_along_x(np.diff(place) + rng.normal(0, 0.01, 35), rows, facing=[-1] * 6)
    problem = paper_problem(graph, least_squares(graph, LeastSquaresConfig(method="plain")), 1.0, 0.1)
    (verbatim, reference), (reduced, certificate) = solve_paper(problem, "cvxpy"), solve_paper(problem, "reduced")
    active = problem.sign_excess_m(reduced.position_m, reduced.track_offset_m) > -1e-5
    assert 1 <= active.sum() < 20
    assert (reduced.sign_dual[active] > 1e-4).any()
    assert (reduced.sign_dual[~active] < 1e-4).all()
    assert abs(certificate.objective_m / reference.objective_m - 1) < 1e-5
    np.testing.assert_allclose(reduced.track_offset_m, verbatim.track_offset_m, atol=1e-3)


def test_a_building_of_two_wings_is_solved_and_verified() -> None:
    graph = make_scene(scale_spec(2), 1).graph
    problem = paper_problem(graph, least_squares(graph, LeastSquaresConfig(method="plain")), 1.0, 0.02)
    assert len(problem.pairs) > 10_000
    assert solve_paper(problem, "reduced")[1].gap < 1e-6
