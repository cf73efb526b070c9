"""Least squares against systems solved by hand and against dense linear algebra."""

import numpy as np
import pytest

from floorplan.config import LeastSquaresConfig
from floorplan.elimination.reduction import reduce_axis
from floorplan.least_squares import least_squares
from floorplan.rows import AxisRows, design_matrix, right_hand_side
from tests.graphs import graph_along_x, loop_graph


def test_a_loop_that_misses_closure_by_three_tenths_gives_each_of_its_three_rows_a_third() -> None:
    graph = graph_along_x([1.3], [(0, 0, 2.0), (1, 0, 1.0)], facing=[-1])
    solution = least_squares(graph, LeastSquaresConfig(method="plain"))
    np.testing.assert_allclose(solution.track_offset_m, [2.1], atol=1e-12)
    np.testing.assert_allclose(solution.position_m[:, 0], [0, 1.2], atol=1e-12)
    np.testing.assert_allclose(solution.position_m[:, 1:], 0, atol=1e-12)
    assert solution.residual == pytest.approx(0.1 * np.sqrt(3), abs=1e-12)


def test_two_planes_and_three_frames_match_their_exact_fractions() -> None:
    # m0 seen from 0, 1; m1 from 1, 2; odometry 1, 1. The only loop is 0-1-m0: its error 3/10 is shared by three rows.
    graph = graph_along_x([1.0, 1.0], [(0, 0, 5.0), (1, 0, 3.7), (1, 1, -2.0), (2, 1, -3.0)], facing=[-1, 1])
    solution = least_squares(graph, LeastSquaresConfig(method="plain"))
    np.testing.assert_allclose(solution.position_m[:, 0], [0, 1.1, 2.1], atol=1e-12)
    np.testing.assert_allclose(solution.track_offset_m, [4.9, -0.9], atol=1e-12)


def test_one_frame_alone_is_solved() -> None:
    graph = graph_along_x([], [(0, 0, 1.9), (0, 0, 2.1)], facing=[-1])
    solution = least_squares(graph, LeastSquaresConfig(method="plain"))
    assert solution.track_offset_m[0] == pytest.approx(2.0)
    assert solution.residual == pytest.approx(0.1 * np.sqrt(2))


def test_exact_rows_give_the_truth_and_no_residual() -> None:
    graph, position, plane = loop_graph(0, sigma_m=0, drift_m=0)
    solution = least_squares(graph, LeastSquaresConfig(method="plain"))
    np.testing.assert_allclose(solution.position_m, position, atol=1e-9)
    for wall in range(10):
        assert np.ptp(solution.track_offset_m[plane == wall]) < 1e-9
    assert solution.residual < 1e-9


@pytest.mark.parametrize("kept", [[], [5], [1, 7, 63, 64, 65, 299]])
def test_elimination_equals_dense_algebra_with_any_weights_and_kept_frames(kept: list[int]) -> None:
    rng = np.random.default_rng(len(kept))
    frames, planes, count = 300, 20, 900
    rows = AxisRows(
        planes,
        rng.integers(0, frames, count),
        rng.integers(0, planes, count),
        rng.normal(size=count),
        rng.uniform(0.5, 2, count),
        rng.normal(size=frames - 1),
        rng.uniform(0.5, 2, frames - 1),
    )
    a = design_matrix(rows).toarray()
    weight = np.concatenate((rows.weight, rows.step_weight))
    normal = a.T @ (weight[:, None] * a)
    expected = np.linalg.solve(normal, a.T @ (weight * np.concatenate((rows.distance_m, rows.step_m))))
    reduced = reduce_axis(rows, np.array(kept, dtype=np.int64))
    solution = reduced.solve(right_hand_side(rows))
    np.testing.assert_allclose(np.concatenate((solution.position_m[1:], solution.offset_m)), expected, atol=1e-11)
    border = np.concatenate((frames - 1 + np.arange(planes), np.array(kept, dtype=np.int64) - 1))
    inner = np.setdiff1d(np.arange(frames - 1 + planes), border)
    schur = normal[np.ix_(border, border)] - normal[np.ix_(border, inner)] @ np.linalg.solve(
        normal[np.ix_(inner, inner)], normal[np.ix_(inner, border)]
    )
    np.testing.assert_allclose(reduced.information, schur, atol=1e-10)
    again = reduced.trajectory(np.concatenate((solution.offset_m, solution.position_m[kept])))
    np.testing.assert_allclose(again.position_m, solution.position_m, atol=1e-11)
