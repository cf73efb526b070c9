"""Merges forbidden or forced by hand, applied to the decisions of the merge, whichever method made them."""

from dataclasses import replace

import numpy as np

from floorplan.edits.file import Edits, TrackPair
from floorplan.model.checks import Array
from floorplan.model.graph import Hypotheses, LayoutGraph, LeastSquaresSolution, MergeResult, Verdict


def edit_merge(graph: LayoutGraph, least_squares: LeastSquaresSolution, merged: MergeResult, edits: Edits) -> MergeResult:
    """The decisions with those of a person in place of the method's.

    `never_merge`: where both tracks went to one plane, its tracks are shared out to whichever of the two they lie nearer to
    after least squares. `always_merge`: the planes of both tracks become one. Pairs that do not apply are left out.
    """
    label = merged.plane_of_track.copy()
    hypotheses = merged.hypotheses
    for pair in edits.never_merge:
        if not _fault(graph, pair) and label[pair.first] == label[pair.second]:
            label = _split(label, least_squares.track_offset_m, pair)
    hypotheses = _judged(hypotheses, label, [p for p in edits.never_merge if not _fault(graph, p)], Verdict.FORBIDDEN)
    for pair in edits.always_merge:
        if not _fault(graph, pair):
            label = np.where(label == label[pair.second], label[pair.first], label)
            hypotheses = _forced(hypotheses, least_squares.track_offset_m, pair)
    made = None if merged.made is None else merged.made.only(label[merged.made.first] == label[merged.made.second])
    return replace(merged, plane_of_track=_numbered(label), hypotheses=hypotheses, made=made)


def merge_notes(graph: LayoutGraph, least_squares: LeastSquaresSolution, edits: Edits) -> tuple[str, ...]:
    """What was done by hand and what could not be, one sentence each, for the plan's notes."""
    notes = []
    for word, pairs in (("never_merge", edits.never_merge), ("always_merge", edits.always_merge)):
        for pair in pairs:
            name = f"{word} tracks {pair.first} and {pair.second}"
            if fault := _fault(graph, pair):
                notes.append(f"Edit not applied: {name}: {fault}.")
            else:
                apart = abs(least_squares.track_offset_m[pair.first] - least_squares.track_offset_m[pair.second])
                notes.append(f"Edited by hand: {name}, {apart:.2f} m apart after least squares.")
    return tuple(notes)


def _fault(graph: LayoutGraph, pair: TrackPair) -> str:
    """Why the pair cannot be meant, empty where it can."""
    count = len(graph.axis)
    for track in (pair.first, pair.second):
        if track >= count:
            return f"there is no track {track} in this build (they run to {count - 1})"
    if graph.axis[pair.first] != graph.axis[pair.second] or graph.facing[pair.first] != graph.facing[pair.second]:
        return "they face different ways"
    return ""


def _split(label: Array, offset_m: Array, pair: TrackPair) -> Array:
    mine = label == label[pair.first]
    nearer_second = np.abs(offset_m - offset_m[pair.second]) < np.abs(offset_m - offset_m[pair.first])
    leaves = mine & nearer_second
    leaves[pair.first], leaves[pair.second] = False, True
    return np.where(leaves, label.max() + 1, label)


def _judged(hypotheses: Hypotheses, label: Array, pairs: list[TrackPair], verdict: Verdict) -> Hypotheses:
    """Accepted pairs that now lie in the two halves of a plane that was split."""
    if not pairs:
        return hypotheses
    apart = hypotheses.accepted & (label[hypotheses.first] != label[hypotheses.second])
    return replace(hypotheses, verdict=tuple(verdict if a else v for a, v in zip(apart, hypotheses.verdict, strict=True)))


def _forced(hypotheses: Hypotheses, offset_m: Array, pair: TrackPair) -> Hypotheses:
    """The pair as a forced hypothesis: in place of its own row, or as a further one."""
    ends = {pair.first, pair.second}
    same = [{int(a), int(b)} == ends for a, b in zip(hypotheses.first, hypotheses.second, strict=True)]
    if any(same):
        verdicts = tuple(Verdict.FORCED if s else v for s, v in zip(same, hypotheses.verdict, strict=True))
        return replace(hypotheses, verdict=verdicts)
    distance = offset_m[pair.first] - offset_m[pair.second]
    return Hypotheses(
        first=np.append(hypotheses.first, pair.first),
        second=np.append(hypotheses.second, pair.second),
        distance_m=np.append(hypotheses.distance_m, distance),
        solved_distance_m=np.append(hypotheses.solved_distance_m, distance),
        sigma_m=np.append(hypotheses.sigma_m, np.nan),
        chi_square=np.append(hypotheses.chi_square, np.nan),
        verdict=(*hypotheses.verdict, Verdict.FORCED),
    )


def _numbered(label: Array) -> Array:
    """Labels 0..L-1 in order of their first track."""
    _, first, inverse = np.unique(label, return_index=True, return_inverse=True)
    rank = np.empty(len(first), dtype=np.int64)
    rank[np.argsort(first)] = np.arange(len(first))
    return np.asarray(rank[inverse])
