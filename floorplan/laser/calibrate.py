"""Calibration by tape: measured distances as further rows of the weighted re-solve, and one scale where they agree on it.

The planes of the plain re-solve are Gaussian, `m ~ N(m_0, C)`; a distance `H m = L` of sigma `s` conditions them (E11):
`m = m_0 + C H^T (H C H^T + s^2)^-1 (L - H m_0)`. A scale `c` that depth and odometry share is invisible to the scan itself;
the measured distances see it: `L = c H m_0 + error`.
"""

from dataclasses import dataclass, replace

import numpy as np
from scipy.linalg import cho_factor, cho_solve

from floorplan.laser.spans import Span
from floorplan.model.checks import Array
from floorplan.model.graph import LayoutGraph, LayoutSolution, MergeResult
from floorplan.model.normal import MAD_TO_SIGMA, NORMAL_95
from floorplan.model.scan import RangeAccuracy
from floorplan.model.ties import Calibration, DistanceTies, TiedDistance
from floorplan.weighted_resolve import weighted_resolve

MIN_FOR_SCALE = 3  # fewer distances that agree may agree by chance
SCALE_SIGMAS = 3.0  # the common scale is believed beyond this ...
EACH_LEFT_OUT_SIGMAS = 2.0  # ... and beyond this whichever distance is left out: no single one carries it
CONTRADICTED_SIGMAS = 5.0  # off everything else by more, in the spread that the others show: mistyped, or not that wall
CONTRADICTED_M = 0.05  # and by more than walls are crooked
SURPRISING_SIGMAS = 3.0  # off everything else by more than three in a thousand are: believed, but not without a word


@dataclass(frozen=True)
class _Question:
    """Everything in distances alone: `plan_m (T,)` = H m_0, its `covariance_m2 (T, T)` but for a common scale, the meter's word and sigmas.

    `scale_sigma`: how well the sensor's scale is known without any tape.
    """

    plan_m: Array
    covariance_m2: Array
    length_m: Array
    sigma_m: Array
    scale_sigma: float

    def only(self, kept: Array) -> "_Question":
        covariance = self.covariance_m2[np.ix_(kept, kept)]
        return _Question(self.plan_m[kept], covariance, self.length_m[kept], self.sigma_m[kept], self.scale_sigma)

    @property
    def with_any_scale(self) -> Array:
        """The covariance (T, T) as long as nobody has found the scale."""
        return np.asarray(self.covariance_m2 + self.scale_sigma**2 * np.outer(self.plan_m, self.plan_m))


@dataclass(frozen=True)
class _Scale:
    value: float
    sigma: float

    @property
    def sigmas(self) -> float:
        return abs(self.value - 1) / self.sigma


@dataclass(frozen=True)
class _Prediction:
    """What the other distances and the plan say of each one, (T,) each."""

    length_m: Array
    sigma_m: Array


def calibrate(graph: LayoutGraph, merged: MergeResult, plain: LayoutSolution, spans: tuple[Span, ...]) -> LayoutSolution:
    """The re-solve with the measured distances; `calibration` tells what each one did. `plain` is the re-solve without them.

    Spans to planes that the solution does not know (glimpsed ones, which the plan adds) say nothing of it and are left out.
    """
    spans = tuple(span for span in spans if max(span.lower, span.upper) < len(plain.plane_offset_m))
    if not spans or plain.plane_covariance_m2 is None or merged.noise is None:
        return plain
    ties = _ties(plain, spans)
    H = ties.matrix(len(plain.plane_offset_m))
    accuracy = graph.range_accuracy or RangeAccuracy(0.0, 0.0)
    covariance = H @ _without_scale(plain, plain.plane_covariance_m2, accuracy) @ H.T
    question = _Question(H @ plain.plane_offset_m, covariance, ties.length_m, ties.sigma_m, accuracy.scale_sigma)
    used = _uncontradicted(question)
    believing = question.only(np.flatnonzero(used))
    scale = _common_scale(believing) or _Scale(1.0, _scale_left(believing))
    rows = replace(ties.only(used), scale_sigma=scale.sigma, bias_sigma_m=accuracy.bias_sigma_m)
    solved = weighted_resolve(scaled_graph(graph, scale.value), merged.plane_of_track, merged.noise, ties=rows, made=merged.made)
    after, prediction = H @ solved.plane_offset_m, _predictions(question, used)
    numbers = np.stack((ties.length_m, ties.sigma_m, question.plan_m, after, prediction.length_m, prediction.sigma_m), axis=1)
    tied = tuple(_tied_distance(span, row, bool(kept)) for span, row, kept in zip(spans, numbers, used, strict=True))
    calibration = Calibration(scale.value, scale.sigma, tied, tuple(_warnings(tied)))
    return replace(solved, calibration=calibration)


def _without_scale(plain: LayoutSolution, covariance: Array, accuracy: RangeAccuracy) -> Array:
    """The planes' covariance without the scale error that `with_range_errors` put into it."""
    same_axis = plain.plane_axis[:, None] == plain.plane_axis[None, :]
    return np.asarray(covariance - accuracy.scale_sigma**2 * np.outer(plain.plane_offset_m, plain.plane_offset_m) * same_axis)


def _tied_distance(span: Span, numbers: Array, used: bool) -> TiedDistance:
    measured, sigma, before, after, predicted, predicted_sigma = map(float, numbers)
    return TiedDistance(span.row.line, span.row.name, measured, sigma, before, after, predicted, predicted_sigma, used)


def scaled_graph(graph: LayoutGraph, scale: float) -> LayoutGraph:
    """All lengths of the graph times `scale`."""
    return replace(
        graph, translation_m=scale * graph.translation_m, distance_m=scale * graph.distance_m, extent_m=scale * graph.extent_m
    )


def _ties(plain: LayoutSolution, spans: tuple[Span, ...]) -> DistanceTies:
    """The spans between planes of the solution: its axes may point the other way than the plan's."""
    first, second = np.array([span.lower for span in spans]), np.array([span.upper for span in spans])
    up = plain.plane_offset_m[second] >= plain.plane_offset_m[first]
    lower, upper = np.where(up, first, second), np.where(up, second, first)
    sigma = [span.laser_sigma_m for span in spans]
    return DistanceTies(lower, upper, np.array([span.row.measured_m for span in spans]), np.array(sigma))


def _common_scale(question: _Question) -> _Scale | None:
    """The scale that all distances share; None where too few say so."""
    count = len(question.plan_m)
    if count < MIN_FOR_SCALE:
        return None
    whole = _fitted_scale(question)
    without = [_fitted_scale(question.only(np.delete(np.arange(count), k))) for k in range(count)]
    agreed = all(part.sigmas > EACH_LEFT_OUT_SIGMAS and (part.value > 1) == (whole.value > 1) for part in without)
    return whole if whole.sigmas > SCALE_SIGMAS and agreed else None


def _scale_left(question: _Question) -> float:
    """How well the scale is known where none is taken out: as the sensor's, or as well as the distances say that there is none."""
    if len(question.plan_m) < MIN_FOR_SCALE:
        return question.scale_sigma
    fitted = _fitted_scale(question)
    return min(question.scale_sigma, float(np.hypot(fitted.sigma, fitted.value - 1)))


def _fitted_scale(question: _Question) -> _Scale:
    """Generalised least squares of `L = c plan + error`; the sigma grows where the errors are larger than they should be."""
    factor = cho_factor(question.covariance_m2 + np.diag(question.sigma_m**2), lower=True)
    heavy = cho_solve(factor, question.plan_m)
    information = float(question.plan_m @ heavy)
    value = float(heavy @ question.length_m) / information
    left = question.length_m - value * question.plan_m
    freedom = max(len(left) - 1, 1)
    inflation = max(1.0, float(left @ cho_solve(factor, left)) / freedom)
    return _Scale(value, float(np.sqrt(inflation / information)))


def _predictions(question: _Question, used: Array) -> _Prediction:
    """Every distance from the plan and the used ones but itself."""
    count = len(question.plan_m)
    length, sigma = np.zeros(count), np.zeros(count)
    for k in range(count):
        others = np.flatnonzero(used & (np.arange(count) != k))
        part = question.only(others)
        scale = _common_scale(part)
        c = scale.value if scale is not None else 1.0
        whole = question.with_any_scale if scale is None else question.covariance_m2
        felt = whole[k, others]
        gain = np.linalg.solve(whole[np.ix_(others, others)] + np.diag(part.sigma_m**2), felt) if len(others) else felt
        length[k] = c * question.plan_m[k] + gain @ (part.length_m - c * part.plan_m)
        scale_part = question.plan_m[k] * scale.sigma if scale is not None else 0.0
        sigma[k] = np.sqrt(max(whole[k, k] - gain @ felt, 0.0) + scale_part**2)
    return _Prediction(length, sigma)


def _uncontradicted(question: _Question) -> Array:
    """Boolean (T,): False for distances that everything else contradicts, the worst one first."""
    used = np.ones(len(question.plan_m), dtype=bool)
    while used.sum() >= MIN_FOR_SCALE:
        candidates = [_without(question, used, int(k)) for k in np.flatnonzero(used)]
        worst = max(candidates, key=lambda one: one.sigmas)
        if worst.sigmas < CONTRADICTED_SIGMAS or worst.error_m < CONTRADICTED_M:
            break
        used[worst.row] = False
    return used


@dataclass(frozen=True)
class _LeftOut:
    row: int
    error_m: float
    sigmas: float


def _without(question: _Question, used: Array, row: int) -> _LeftOut:
    """How far one distance is off the others, in the spread that those show among themselves."""
    others = used.copy()
    others[row] = False
    prediction = _predictions(question, others)
    error = np.abs(question.length_m - prediction.length_m)
    z = error / np.hypot(prediction.sigma_m, question.sigma_m)
    spread = max(1.0, MAD_TO_SIGMA * float(np.median(z[others])))
    return _LeftOut(row, float(error[row]), float(z[row] / spread))


def _warnings(rows: tuple[TiedDistance, ...]) -> list[str]:
    doubted = [row for row in rows if not row.used or _is_surprising(row)]
    return [
        f"line {row.line}: {row.name} is {row.measured_m:.3f} m, everything else says {row.predicted_m:.3f} m "
        f"(+-{NORMAL_95 * row.predicted_sigma_m:.3f}); "
        + ("it was believed" if row.used else "it was left out")
        + ": mistyped, another wall, or a wrong merge there; measure it again"
        for row in doubted
    ]


def _is_surprising(row: TiedDistance) -> bool:
    """Whether a distance is off what everything else says by more than a few in a thousand are."""
    return abs(row.measured_m - row.predicted_m) > SURPRISING_SIGMAS * float(np.hypot(row.predicted_sigma_m, row.sigma_m))
