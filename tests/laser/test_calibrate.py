"""Calibration by tape, on a graph whose walls and scale are known."""

from dataclasses import replace

import numpy as np
import pytest

from floorplan.config import LeastSquaresConfig, MergeConfig, ResolveConfig
from floorplan.laser.calibrate import calibrate, scaled_graph
from floorplan.laser.spans import Span
from floorplan.laser.table import LaserRow
from floorplan.least_squares import least_squares
from floorplan.merge import merge
from floorplan.model.graph import LayoutGraph, LayoutSolution, MergeResult
from floorplan.model.scan import RangeAccuracy
from floorplan.model.ties import DistanceTies
from floorplan.resolve import resolve
from floorplan.weighted_resolve import weighted_resolve
from tests.graphs import loop_graph

TRUE_SPANS = ((0, -6.0, 6.0), (1, -2.0, 8.0), (0, -6.0, -1.0), (0, 1.0, 6.0), (1, -2.0, 2.0), (1, 4.0, 8.0), (2, -1.4, 1.3))


def solved(graph: LayoutGraph) -> tuple[MergeResult, LayoutSolution]:
    merged = merge(graph, least_squares(graph, LeastSquaresConfig()), MergeConfig())
    return merged, resolve(graph, merged, ResolveConfig())


def spans_of(solution: LayoutSolution, scale: float, wrong_m: dict[int, float] | None = None) -> tuple[Span, ...]:
    """The true distances of the box of `loop_graph`, found in a solution that is `scale` times too large."""
    spans = []
    for k, (axis, low, high) in enumerate(TRUE_SPANS):
        mine = np.flatnonzero(solution.plane_axis == axis)
        ends = [int(mine[np.argmin(np.abs(solution.plane_offset_m[mine] - scale * value))]) for value in (low, high)]
        length = high - low + (wrong_m or {}).get(k, 0.0)
        plan_m = float(solution.plane_offset_m[ends[1]] - solution.plane_offset_m[ends[0]])
        spans.append(Span(LaserRow(k + 2, length, f"D{k + 1}"), *ends, axis, plan_m, 0.01, 0.002, (0, 0), (0, 0)))
    return tuple(spans)


def test_a_common_scale_is_found_and_taken_out() -> None:
    graph = scaled_graph(loop_graph(1)[0], 1.01)
    merged, plain = solved(graph)
    result = calibrate(graph, merged, plain, spans_of(plain, 1.01)[:5])
    assert result.calibration is not None
    assert result.calibration.scale == pytest.approx(1 / 1.01, abs=0.002)
    before = [abs(row.before_m - row.measured_m) for row in result.calibration.rows]
    after = [abs(row.after_m - row.measured_m) for row in result.calibration.rows]
    assert np.mean(after) < np.mean(before) / 5
    left = [plain.plane_offset_m[s.upper] - plain.plane_offset_m[s.lower] - s.row.measured_m for s in spans_of(plain, 1.01)[5:]]
    right = [result.plane_offset_m[s.upper] - result.plane_offset_m[s.lower] - s.row.measured_m for s in spans_of(plain, 1.01)[5:]]
    assert np.abs(right).max() < np.abs(left).max() / 2


def test_a_scale_is_found_that_the_sensor_may_well_have_and_its_bias_stays_in_the_intervals() -> None:
    accuracy = RangeAccuracy(scale_sigma=0.005, bias_sigma_m=0.004)
    graph = replace(scaled_graph(loop_graph(1)[0], 1.01), range_accuracy=accuracy)
    merged, plain = solved(graph)
    result = calibrate(graph, merged, plain, spans_of(plain, 1.01)[:5])
    assert result.calibration is not None
    assert result.calibration.scale == pytest.approx(1 / 1.01, abs=0.003)
    assert result.plane_sigma_m.min() >= 0.004
    assert np.median(result.plane_sigma_m) < np.median(plain.plane_sigma_m)
    wrong = calibrate(graph, merged, plain, spans_of(plain, 1.01)[:2])
    assert wrong.calibration is not None
    assert wrong.calibration.scale == 1.0  # two distances are too few to tell


def test_without_a_scale_error_none_is_made_up() -> None:
    graph = loop_graph(2)[0]
    merged, plain = solved(graph)
    result = calibrate(graph, merged, plain, spans_of(plain, 1.0))
    assert result.calibration is not None
    assert result.calibration.scale == 1.0
    assert all(row.used for row in result.calibration.rows)
    assert not result.calibration.warnings


def test_distances_that_find_no_scale_error_narrow_the_intervals_all_the_same() -> None:
    graph = replace(loop_graph(2)[0], range_accuracy=RangeAccuracy(scale_sigma=0.005, bias_sigma_m=0.004))
    merged, plain = solved(graph)
    spans = spans_of(plain, 1.0)
    result = calibrate(graph, merged, plain, spans[1:])
    assert result.calibration is not None
    assert result.calibration.scale == 1.0
    assert 0.0002 < result.calibration.scale_sigma < 0.0025
    before, after = (sigma_of(solution, spans[0]) for solution in (plain, result))
    assert after < before / 2  # 12 m, measured by no tape
    assert abs(result.plane_offset_m[spans[0].upper] - result.plane_offset_m[spans[0].lower] - 12.0) < 3 * after
    assert sigma_of(result, spans[1]) == pytest.approx(0.002, rel=0.2)  # no better and no worse than the meter


def sigma_of(solution: LayoutSolution, span: Span) -> float:
    assert solution.plane_covariance_m2 is not None
    row = np.zeros(len(solution.plane_offset_m))
    row[[span.upper, span.lower]] = 1.0, -1.0
    return float(np.sqrt(row @ solution.plane_covariance_m2 @ row))


def test_a_single_distance_far_off_the_plan_is_believed_with_a_warning() -> None:
    graph = loop_graph(3)[0]
    merged, plain = solved(graph)
    span = spans_of(plain, 1.0, {0: 0.5})[0]
    result = calibrate(graph, merged, plain, (span,))
    assert result.calibration is not None
    assert result.calibration.rows[0].used
    assert "it was believed" in result.calibration.warnings[0]


def test_a_mistyped_distance_is_left_out_with_a_warning_and_the_others_hold() -> None:
    graph = loop_graph(3)[0]
    merged, plain = solved(graph)
    result = calibrate(graph, merged, plain, spans_of(plain, 1.0, {1: -0.9}))
    assert result.calibration is not None
    assert [row.used for row in result.calibration.rows] == [k != 1 for k in range(len(TRUE_SPANS))]
    assert "line 3: D2" in result.calibration.warnings[0]
    span = spans_of(plain, 1.0)[1]
    assert result.plane_offset_m[span.upper] - result.plane_offset_m[span.lower] == pytest.approx(10.0, abs=0.05)


def test_no_distance_changes_nothing() -> None:
    graph = loop_graph(4)[0]
    merged, plain = solved(graph)
    assert calibrate(graph, merged, plain, ()) is plain


def test_a_tie_is_a_row_of_the_least_squares() -> None:
    graph = loop_graph(5)[0]
    merged, plain = solved(graph)
    span = spans_of(plain, 1.0)[0]
    assert merged.noise is not None
    loose, firm = (
        weighted_resolve(graph, merged.plane_of_track, merged.noise, ties=ties, made=merged.made)
        for ties in (DistanceTies([span.lower], [span.upper], [12.1], [sigma]) for sigma in (1e3, 1e-6))
    )
    np.testing.assert_allclose(loose.plane_offset_m, plain.plane_offset_m, atol=1e-6)
    np.testing.assert_allclose(loose.position_m, plain.position_m, atol=1e-6)
    assert firm.plane_offset_m[span.upper] - firm.plane_offset_m[span.lower] == pytest.approx(12.1, abs=1e-5)
    assert firm.residual_m > plain.residual_m
    assert plain.plane_covariance_m2 is not None
    assert firm.plane_covariance_m2 is not None
    assert (np.diag(firm.plane_covariance_m2) <= np.diag(plain.plane_covariance_m2) + 1e-12).all()


def test_the_sensor_moves_with_the_planes_it_measured() -> None:
    graph = loop_graph(6)[0]
    merged, plain = solved(graph)
    assert merged.noise is not None
    spans = spans_of(plain, 1.0)[:1]
    ties = DistanceTies([spans[0].lower], [spans[0].upper], [12.2], [1e-4])
    firm = weighted_resolve(graph, merged.plane_of_track, merged.noise, ties=ties)
    plane, sensor = firm.plane_offset_m[firm.plane_of_track[graph.track]], firm.position_m[graph.frame, graph.axis[graph.track]]
    seen = graph.distance_m - (plane - sensor)
    assert np.sqrt(np.mean(seen**2)) < 0.1  # the 20 cm go into the walk between the walls, not into the rows
