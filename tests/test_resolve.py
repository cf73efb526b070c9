"""The re-solve against systems solved by hand."""

import numpy as np
import pytest

from floorplan.config import LeastSquaresConfig, MergeConfig, ResolveConfig
from floorplan.least_squares import least_squares
from floorplan.merge import merge
from floorplan.model.graph import Hypotheses, LayoutGraph, LayoutSolution, MergeResult
from floorplan.resolve import plane_extents, resolve
from tests.graphs import graph_along_x, loop_graph


def resolved(graph: LayoutGraph, plane_of_track: list[int], covariance: bool = True) -> LayoutSolution:
    nothing = np.zeros(0)
    hypotheses = Hypotheses(nothing, nothing, nothing, nothing, nothing, nothing, ())
    zero = np.zeros((len(graph.stamp_s), 3))
    merged = MergeResult("paper", hypotheses, plane_of_track, np.zeros(len(graph.axis)), zero, 0, 0, 0)
    return resolve(graph, merged, ResolveConfig(covariance=covariance))


def test_merged_tracks_share_one_offset_and_its_variance_follows_from_the_residuals() -> None:
    graph = graph_along_x([], [(0, 0, 1.9), (0, 0, 2.1), (0, 1, 2.4), (0, 1, 2.6)], facing=[-1, -1])
    solution = resolved(graph, [0, 0])
    np.testing.assert_allclose(solution.plane_offset_m, [2.25], atol=1e-12)
    squares = 2 * (0.35**2 + 0.15**2)
    assert solution.residual_m == pytest.approx(np.sqrt(squares))
    assert solution.plane_sigma_m[0] == pytest.approx(np.sqrt(squares / 3 / 4))  # 3 degrees of freedom, 4 rows


def test_an_active_sign_row_holds_the_plane_at_the_sensor() -> None:
    graph = graph_along_x([1.0], [(0, 0, 0.1), (1, 0, 0.1)], facing=[-1])
    free = least_squares(graph, LeastSquaresConfig(method="plain"))
    assert free.track_offset_m[0] < free.position_m[1, 0]  # without signs the plane passes behind the second place
    solution = resolved(graph, [0])
    assert solution.plane_offset_m[0] == pytest.approx(0.55, abs=1e-6)
    assert solution.position_m[1, 0] == pytest.approx(0.55, abs=1e-6)


def test_a_merge_across_a_loop_takes_the_drift_out() -> None:
    graph, position, plane = loop_graph(2)
    before = least_squares(graph, LeastSquaresConfig(method="plain"))
    after = resolved(graph, plane.tolist())
    error_before = np.linalg.norm(before.position_m - position, axis=1).mean()
    error_after = np.linalg.norm(after.position_m - position, axis=1).mean()
    assert 0.001 < error_after < 0.5 * error_before
    assert len(after.plane_offset_m) == 10


def test_plane_sigmas_cover_the_truth_about_as_often_as_they_say() -> None:
    truth = np.array([-6.0, 6.0, -2.0, 8.0, -1.0, 1.0, 2.0, 4.0, -1.4, 1.3])
    score = []
    for seed in range(20):
        graph, _, plane = loop_graph(seed, sigma_m=0.01, drift_m=0.01)
        solution = resolved(graph, plane.tolist())
        score.append((solution.plane_offset_m - truth) / solution.plane_sigma_m)
    assert 0.8 < np.std(score) < 1.25


def test_covariance_is_symmetric_zero_between_axes_and_can_be_left_out() -> None:
    graph, _, plane = loop_graph(3)
    solution = resolved(graph, plane.tolist())
    covariance = solution.plane_covariance_m2
    assert covariance is not None
    np.testing.assert_allclose(covariance, covariance.T, atol=1e-12)
    assert np.abs(covariance[solution.plane_axis[:, None] != solution.plane_axis[None, :]]).max() == 0
    np.testing.assert_allclose(np.sqrt(np.diag(covariance)), solution.plane_sigma_m)
    assert resolved(graph, plane.tolist(), covariance=False).plane_covariance_m2 is None


def test_rows_without_redundancy_still_give_a_positive_sigma() -> None:
    one = graph_along_x([], [(0, 0, 2.0)], facing=[-1])
    assert resolved(one, [0]).plane_sigma_m[0] == pytest.approx(0.01)
    known = graph_along_x([], [(0, 0, 2.0)], facing=[-1], sigma_m=[0.003])
    assert resolved(known, [0]).plane_sigma_m[0] == pytest.approx(0.003)


def test_extents_are_united_at_the_solved_positions_and_flat_along_the_plane_s_axis() -> None:
    graph = graph_along_x([0.0], [(0, 0, 2.0), (1, 1, 2.2)], facing=[-1, -1])
    box = np.array([[[2, 2], [0, 1], [0, 2]], [[2.2, 2.2], [1.5, 3], [np.nan, np.nan]]])
    graph = LayoutGraph(graph.stamp_s, graph.translation_m, graph.frame, graph.track, graph.distance_m, graph.axis, graph.facing, box)
    moved = np.array([[0.0, 0, 0], [0, 0.5, 0]])
    extent = plane_extents(graph, np.array([0, 0]), moved, np.array([2.1]))
    np.testing.assert_allclose(extent, [[[2.1, 2.1], [0, 3.5], [0, 2]]])


def test_the_whole_published_back_end_finds_the_walls_of_a_loop() -> None:
    graph, position, plane = loop_graph(4)
    config = MergeConfig(method="paper", engine="cvxpy")
    merged = merge(graph, least_squares(graph, LeastSquaresConfig(method="plain")), config)
    solution = resolve(graph, merged, ResolveConfig())
    np.testing.assert_array_equal(solution.plane_of_track, plane)
    assert 0.001 < np.linalg.norm(solution.position_m - position, axis=1).mean() < 0.1
