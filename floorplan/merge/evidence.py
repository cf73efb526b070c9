"""`merge.method = "evidence"`: tracks are one plane where that is the likelier story, with every number kept."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from floorplan.config import MergeConfig
from floorplan.merge.evidence_bias import PRIOR_BIAS_M, PRIOR_SHARE, Bias, bias_before_merging, bias_of_merged
from floorplan.merge.evidence_greedy import Decision, Question, decide
from floorplan.merge.evidence_moves import move_tracks
from floorplan.merge.evidence_pairs import Planes, gated_pairs, log_prior, pair_variance_m2, seen_apart
from floorplan.merge.evidence_verdicts import join_hypotheses, system_hypotheses
from floorplan.merge.hypotheses import Pairs
from floorplan.merge_slack import slack_m
from floorplan.model.checks import Array
from floorplan.model.graph import Hypotheses, LayoutGraph, LeastSquaresSolution, MergeResult
from floorplan.model.merges_made import MergesMade, join_merges
from floorplan.model.noise import ScanNoise
from floorplan.model.plane_moves import PlaneMove
from floorplan.noise import estimate_noise, with_steps
from floorplan.track_bias import row_sigma_m
from floorplan.weighted import KnownSystem, known_systems
from floorplan.weighted_resolve import weighted_resolve

SMALLEST_BIAS_M = 0.0015  # for decisions: one short track in a hundred is off by more than four sigma of anything smaller


@dataclass(frozen=True)
class _Decided:
    """One round over one system: its pairs, what was asked, what was decided, what was moved afterwards (tracks of the system)."""

    pairs: Pairs
    question: Question
    decision: Decision
    moves: tuple[PlaneMove, ...]


def merge_evidence(graph: LayoutGraph, least_squares: LeastSquaresSolution, config: MergeConfig) -> MergeResult:
    """Best-first merging gated by the joint covariance of the planes; see docs/back-end.md, "Evidence"."""
    noise = least_squares.noise or estimate_noise(graph)
    known = known_systems(graph, noise)
    systems = _planes_of_systems(graph, noise, known)
    usual = Bias(PRIOR_BIAS_M, PRIOR_SHARE)
    apart = [seen_apart(graph, noise.sigma_m, usual.of(planes.row_sigma_m), planes) for planes in systems]
    bias = bias_before_merging(systems, apart)
    first = [_decided(graph, noise, bias, planes, None, config) for planes in systems]
    bias = bias_of_merged(systems, [made.decision.plane for made in first], bias)
    second = [_decided(graph, noise, bias, planes, made.decision.plane, config) for planes, made in zip(systems, first, strict=True)]
    bias = bias_of_merged(systems, [made.decision.plane for made in second], bias)
    noise = replace(noise, bias_sigma_m=bias.constant_m, bias_share=bias.share)
    label = np.arange(len(graph.axis))
    for planes, made in zip(systems, second, strict=True):
        label[planes.tracks] = planes.tracks[made.decision.plane]
    parts = [system_hypotheses(planes, made.pairs, made.question, made.decision) for planes, made in zip(systems, second, strict=True)]
    plane_of_track = _numbered(label)
    merges = _merges_made([(planes, one.pairs, one.decision) for planes, one in zip(systems, second, strict=True)])
    moves = tuple(_of_graph(move, planes.tracks) for planes, one in zip(systems, second, strict=True) for move in one.moves)
    return replace(_result(graph, noise, plane_of_track, join_hypotheses(parts), known, merges), moves=moves)


def _planes_of_systems(graph: LayoutGraph, noise: ScanNoise, known: Sequence[KnownSystem]) -> list[Planes]:
    """The planes of each system before any merge, their boxes at solved positions; bias not yet in the covariance."""
    sigma = row_sigma_m(graph, noise)
    place = np.vstack([np.zeros(3), np.cumsum(graph.translation_m, axis=0)])
    dead = place.copy()
    for one in known:
        place[:, list(one.system.axes)] = one.solution.position_m
    extent = graph.extent_m + _mean_shift(graph, place - dead)[:, :, None]
    return [
        Planes(tracks, graph.axis[tracks], graph.facing[tracks], one.solution.offset_m, one.covariance_m2, extent[tracks], sigma[tracks])
        for one in known
        for tracks in (one.system.tracks,)
    ]


def _mean_shift(graph: LayoutGraph, correction: Array) -> Array:
    """Mean correction (M, 3) of the frames that saw each track: extents are in dead-reckoned coordinates."""
    seen = np.maximum(np.bincount(graph.track, minlength=len(graph.axis)), 1)
    sums = [np.bincount(graph.track, correction[graph.frame, k], len(graph.axis)) for k in range(3)]
    return np.asarray(np.stack(sums, axis=1) / seen[:, None])


def _with_bias(planes: Planes, bias_m: Array) -> Planes:
    covariance = planes.covariance_m2.copy()
    np.fill_diagonal(covariance, covariance.diagonal() + bias_m**2)
    return replace(planes, covariance_m2=covariance)


def _decided(graph: LayoutGraph, noise: ScanNoise, bias: Bias, planes: Planes, known: Array | None, config: MergeConfig) -> _Decided:
    """One round of merging under `noise` and `bias`; `known (T,)` is the round before, to count distinct planes by."""
    each_m = np.maximum(bias.of(planes.row_sigma_m), SMALLEST_BIAS_M)
    planes = _with_bias(planes, each_m)
    pairs = gated_pairs(planes)
    variance = pair_variance_m2(planes, pairs)
    apart = seen_apart(graph, noise.sigma_m, each_m, planes)
    count = len(planes.tracks)
    barred = np.isin(pairs.first * count + pairs.second, apart.first * count + apart.second)
    delta = planes.offset_m[pairs.first] - planes.offset_m[pairs.second]
    question = Question(pairs.first, pairs.second, delta, variance, log_prior(planes, pairs, variance, known), barred)
    decision = decide(question, planes.covariance_m2)
    if known is None or not config.moves:  # the first round, unmoved, gives the larger bias of the two, which is the safer one
        return _Decided(pairs, question, decision, ())
    moved = move_tracks(question, decision, planes.offset_m, planes.covariance_m2)
    return _Decided(pairs, question, moved.decision, moved.moves)


def _numbered(label: Array) -> Array:
    """Labels 0..L-1 in order of their first track."""
    _, first, inverse = np.unique(label, return_index=True, return_inverse=True)
    rank = np.empty(len(first), dtype=np.int64)
    rank[np.argsort(first)] = np.arange(len(first))
    return np.asarray(rank[inverse])


def _merges_made(systems: Sequence[tuple[Planes, Pairs, Decision]]) -> MergesMade:
    """All systems' merges, in tracks of the graph."""
    parts = []
    for planes, pairs, decision in systems:
        rows = decision.made
        slack = slack_m(decision.made_odds, decision.delta_m[rows], decision.variance_m2[rows])
        parts.append(MergesMade(planes.tracks[pairs.first[rows]], planes.tracks[pairs.second[rows]], decision.made_odds, slack))
    return join_merges(parts)


def _of_graph(move: PlaneMove, tracks: Array) -> PlaneMove:
    """A move of a system's columns in tracks of the graph."""
    source, target = (None if column is None else int(tracks[column]) for column in (move.source, move.target))
    return replace(move, tracks=tuple(int(tracks[column]) for column in move.tracks), source=source, target=target)


def _result(
    graph: LayoutGraph, noise: ScanNoise, plane_of_track: Array, hypotheses: Hypotheses, known: Sequence[KnownSystem], made: MergesMade
) -> MergeResult:
    solved = weighted_resolve(graph, plane_of_track, noise, keep_covariance=False, known=known)  # no doubt moves a plane
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
        made=made,
    )
