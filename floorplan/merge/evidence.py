"""`merge.method = "evidence"`: tracks are one plane where that is the likelier story, with every number kept."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from floorplan.merge.evidence_bias import PRIOR_BIAS_M, bias_sigma_m, merged_bias_sigma_m
from floorplan.merge.evidence_greedy import Decision, Question, decide
from floorplan.merge.evidence_pairs import Planes, gated_pairs, log_prior, pair_variance_m2, seen_apart
from floorplan.merge.evidence_verdicts import join_hypotheses, system_hypotheses
from floorplan.merge.hypotheses import Pairs
from floorplan.model.checks import Array
from floorplan.model.graph import Hypotheses, LayoutGraph, LeastSquaresSolution, MergeResult
from floorplan.model.noise import ScanNoise
from floorplan.noise import estimate_noise, with_steps
from floorplan.weighted import KnownSystem, known_systems
from floorplan.weighted_resolve import weighted_resolve

SMALLEST_BIAS_M = 0.0015  # for decisions: a millimetre taken for granted makes one false "seen apart" in a thousand pairs


@dataclass(frozen=True)
class _Decided:
    """One round over one system: its pairs, what was asked, what was decided."""

    pairs: Pairs
    question: Question
    decision: Decision


def merge_evidence(graph: LayoutGraph, least_squares: LeastSquaresSolution) -> MergeResult:
    """Best-first merging gated by the joint covariance of the planes; see docs/back-end.md, "Evidence"."""
    noise = least_squares.noise or estimate_noise(graph)
    known = known_systems(graph, noise)
    systems = _planes_of_systems(graph, known)
    apart = [seen_apart(graph, noise.sigma_m, PRIOR_BIAS_M, planes) for planes in systems]
    noise = replace(noise, bias_sigma_m=bias_sigma_m(systems, apart))
    first = [_decided(graph, noise, planes, None) for planes in systems]
    noise = replace(noise, bias_sigma_m=merged_bias_sigma_m(systems, [made.decision.plane for made in first], noise.bias_sigma_m))
    second = [_decided(graph, noise, planes, made.decision.plane) for planes, made in zip(systems, first, strict=True)]
    noise = replace(noise, bias_sigma_m=merged_bias_sigma_m(systems, [made.decision.plane for made in second], noise.bias_sigma_m))
    label = np.arange(len(graph.axis))
    for planes, made in zip(systems, second, strict=True):
        label[planes.tracks] = planes.tracks[made.decision.plane]
    parts = [system_hypotheses(planes, made.pairs, made.question, made.decision) for planes, made in zip(systems, second, strict=True)]
    plane_of_track = _numbered(label)
    return _result(graph, noise, plane_of_track, join_hypotheses(parts), known)


def _planes_of_systems(graph: LayoutGraph, known: Sequence[KnownSystem]) -> list[Planes]:
    """The planes of each system before any merge, their boxes at solved positions; bias not yet in the covariance."""
    place = np.vstack([np.zeros(3), np.cumsum(graph.translation_m, axis=0)])
    dead = place.copy()
    for one in known:
        place[:, list(one.system.axes)] = one.solution.position_m
    extent = graph.extent_m + _mean_shift(graph, place - dead)[:, :, None]
    return [
        Planes(tracks, graph.axis[tracks], graph.facing[tracks], one.solution.offset_m, one.covariance_m2, extent[tracks])
        for one in known
        for tracks in (one.system.tracks,)
    ]


def _mean_shift(graph: LayoutGraph, correction: Array) -> Array:
    """Mean correction (M, 3) of the frames that saw each track: extents are in dead-reckoned coordinates."""
    seen = np.maximum(np.bincount(graph.track, minlength=len(graph.axis)), 1)
    sums = [np.bincount(graph.track, correction[graph.frame, k], len(graph.axis)) for k in range(3)]
    return np.asarray(np.stack(sums, axis=1) / seen[:, None])


def _with_bias(planes: Planes, bias_m: float) -> Planes:
    covariance = planes.covariance_m2.copy()
    np.fill_diagonal(covariance, covariance.diagonal() + bias_m**2)
    return replace(planes, covariance_m2=covariance)


def _decided(graph: LayoutGraph, noise: ScanNoise, planes: Planes, known: Array | None) -> _Decided:
    """One round of merging under `noise`; `known (T,)` is the round before, to count distinct planes by."""
    noise = replace(noise, bias_sigma_m=max(noise.bias_sigma_m, SMALLEST_BIAS_M))
    planes = _with_bias(planes, noise.bias_sigma_m)
    pairs = gated_pairs(planes)
    variance = pair_variance_m2(planes, pairs)
    apart = seen_apart(graph, noise.sigma_m, noise.bias_sigma_m, planes)
    count = len(planes.tracks)
    barred = np.isin(pairs.first * count + pairs.second, apart.first * count + apart.second)
    delta = planes.offset_m[pairs.first] - planes.offset_m[pairs.second]
    question = Question(pairs.first, pairs.second, delta, variance, log_prior(planes, pairs, variance, known), barred)
    return _Decided(pairs, question, decide(question, planes.covariance_m2))


def _numbered(label: Array) -> Array:
    """Labels 0..L-1 in order of their first track."""
    _, first, inverse = np.unique(label, return_index=True, return_inverse=True)
    rank = np.empty(len(first), dtype=np.int64)
    rank[np.argsort(first)] = np.arange(len(first))
    return np.asarray(rank[inverse])


def _result(
    graph: LayoutGraph, noise: ScanNoise, plane_of_track: Array, hypotheses: Hypotheses, known: Sequence[KnownSystem]
) -> MergeResult:
    solved = weighted_resolve(graph, plane_of_track, noise, known=known)
    offset = solved.plane_offset_m[plane_of_track]
    return MergeResult(
        method="evidence",
        hypotheses=hypotheses,
        plane_of_track=plane_of_track,
        track_offset_m=offset,
        position_m=solved.position_m,
        objective=float(np.abs(offset[hypotheses.first] - offset[hypotheses.second]).sum()),
        delta_m=solved.residual_m,
        residual_m=solved.residual_m,
        noise=with_steps(noise, solved.position_m),
    )

