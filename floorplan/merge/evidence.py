"""`merge.method = "evidence"`: tracks are one plane where that is the likelier story, with every number kept."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from floorplan.config import MergeConfig
from floorplan.elimination.weighted import KnownSystem, known_systems
from floorplan.merge.evidence_bias import USUAL, Bias, bias_before_merging, bias_of_merged
from floorplan.merge.evidence_candidates import choose_planes
from floorplan.merge.evidence_greedy import Decision, Question, decide
from floorplan.merge.evidence_pairs import Planes, gated_pairs, log_prior, pair_variance_m2, seen_apart
from floorplan.merge.evidence_verdicts import join_hypotheses, system_hypotheses
from floorplan.merge.hypotheses import Pairs, numbered
from floorplan.merge_slack import slack_m
from floorplan.model.checks import Array
from floorplan.model.graph import Hypotheses, LayoutGraph, LeastSquaresSolution, MergeResult
from floorplan.model.merges_made import MergesMade, join_merges
from floorplan.model.noise import ScanNoise
from floorplan.model.plane_moves import AxisChoice, PlaneMove
from floorplan.noise.estimate import estimate_noise, with_steps
from floorplan.noise.track_bias import row_sigma_m, square_range_m2
from floorplan.weighted_resolve import weighted_resolve

SMALLEST_BIAS_M = 0.0015  # for decisions: one short track in a hundred is off by more than four sigma of anything smaller


@dataclass(frozen=True)
class _Asked:
    """What both rounds are about."""

    graph: LayoutGraph
    noise: ScanNoise
    config: MergeConfig


@dataclass(frozen=True)
class _Decided:
    """One round over one system: its pairs, what was asked, what was decided, moved and chosen (tracks of the system)."""

    pairs: Pairs
    question: Question
    decision: Decision
    moves: tuple[PlaneMove, ...]
    choices: tuple[AxisChoice, ...]
    outvoted: Array


def merge_evidence(graph: LayoutGraph, least_squares: LeastSquaresSolution, config: MergeConfig, never: Pairs) -> MergeResult:
    """Best-first merging gated by the joint covariance of the planes; see docs/back-end.md, "Evidence". Pairs of `never` stay apart."""
    noise = least_squares.noise or estimate_noise(graph)
    known = known_systems(graph, noise)
    systems = _planes_of_systems(graph, noise, known)
    apart = [seen_apart(graph, noise.sigma_m, USUAL.of(planes), planes) for planes in systems]
    bias = bias_before_merging(systems, apart)
    barred = [_of_system(never, planes, len(graph.axis)) for planes in systems]
    asked = _Asked(graph, noise, config)
    first = [_decided(asked, bias, planes, bars, None) for planes, bars in zip(systems, barred, strict=True)]
    bias = bias_of_merged(systems, [made.decision.plane for made in first], bias)
    second = [_decided(asked, bias, planes, bars, made.decision.plane) for planes, bars, made in zip(systems, barred, first, strict=True)]
    bias = bias_of_merged(systems, [made.decision.plane for made in second], bias)
    noise = replace(noise, bias_sigma_m=bias.constant_m, bias_share=bias.share, bias_far_per_m=bias.far_per_m)
    label = np.arange(len(graph.axis))
    for planes, made in zip(systems, second, strict=True):
        label[planes.tracks] = planes.tracks[made.decision.plane]
    made_by = list(zip(systems, second, strict=True))
    parts = [system_hypotheses(planes, one.pairs, one.question, one.decision, one.outvoted) for planes, one in made_by]
    plane_of_track = numbered(label)
    merges = _merges_made([(planes, one.pairs, one.decision) for planes, one in made_by])
    moves = tuple(_of_graph(move, planes.tracks) for planes, one in made_by for move in one.moves)
    choices = tuple(choice for one in second for choice in one.choices)
    return replace(_result(graph, noise, plane_of_track, join_hypotheses(parts), known, merges), moves=moves, choices=choices)


def _planes_of_systems(graph: LayoutGraph, noise: ScanNoise, known: Sequence[KnownSystem]) -> list[Planes]:
    """The planes of each system before any merge, their boxes at solved positions; bias not yet in the covariance."""
    sigma, square = row_sigma_m(graph, noise), square_range_m2(graph, noise)
    place = np.vstack([np.zeros(3), np.cumsum(graph.translation_m, axis=0)])
    dead = place.copy()
    for one in known:
        place[:, list(one.system.axes)] = one.solution.position_m
    extent = graph.extent_m + _mean_shift(graph, place - dead)[:, :, None]
    return [
        Planes(
            tracks,
            graph.axis[tracks],
            graph.facing[tracks],
            one.solution.offset_m,
            one.covariance_m2,
            extent[tracks],
            sigma[tracks],
            square[tracks],
        )
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


def _decided(asked: _Asked, bias: Bias, planes: Planes, never: Pairs, known: Array | None) -> _Decided:
    """One round of merging; `never` pairs stay apart, `known (T,)` is the round before, to count distinct planes by."""
    graph, noise, config = asked.graph, asked.noise, asked.config
    each_m = np.maximum(bias.of(planes), SMALLEST_BIAS_M)
    planes = _with_bias(planes, each_m)
    pairs = _with_barred(gated_pairs(planes), never, len(planes.tracks))
    variance = pair_variance_m2(planes, pairs)
    apart = seen_apart(graph, noise.sigma_m, each_m, planes)
    count = len(planes.tracks)
    bars = np.concatenate([apart.first * count + apart.second, never.first * count + never.second])
    barred = np.isin(pairs.first * count + pairs.second, bars)
    delta = planes.offset_m[pairs.first] - planes.offset_m[pairs.second]
    question = Question(pairs.first, pairs.second, delta, variance, log_prior(planes, pairs, variance, known), barred)
    decision = decide(question, planes.covariance_m2)
    if known is None or not config.moves:  # the first round, unmoved, gives the larger bias of the two, which is the safer one
        return _Decided(pairs, question, decision, (), (), np.zeros(len(pairs), dtype=bool))
    chosen = choose_planes(question, decision, planes.offset_m, planes.covariance_m2, planes.axis, config.second_candidate)
    return _Decided(pairs, question, chosen.decision, chosen.moves, chosen.choices, chosen.outvoted)


def _of_system(never: Pairs, planes: Planes, tracks: int) -> Pairs:
    """The pairs of `never` that a system has, by its columns."""
    column = np.full(tracks, -1)
    column[planes.tracks] = np.arange(len(planes.tracks))
    a, b = column[never.first], column[never.second]
    mine = (a >= 0) & (b >= 0)
    return Pairs(np.minimum(a, b)[mine], np.maximum(a, b)[mine])


def _with_barred(pairs: Pairs, never: Pairs, count: int) -> Pairs:
    """The pairs and those of `never` besides: only what is asked can be told from the components that hold it."""
    new = ~np.isin(never.first * count + never.second, pairs.first * count + pairs.second)
    return Pairs(np.append(pairs.first, never.first[new]), np.append(pairs.second, never.second[new]))


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
