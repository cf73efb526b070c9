"""Merges by hand: those forbidden are a constraint of the merge, those forced are added to its decisions, whichever method made them."""

from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from floorplan.edits.file import Edits, TrackPair
from floorplan.model.checks import Array
from floorplan.model.graph import Hypotheses, LayoutGraph, LeastSquaresSolution, MergeResult, Verdict

if TYPE_CHECKING:
    from floorplan.merge.hypotheses import Pairs  # at run time inside functions: a build that finds its merge finished does without


def never_merged(graph: LayoutGraph, edits: Edits) -> "Pairs":
    """The pairs of `never_merge` that can be meant: the merge keeps their tracks on different planes, whatever else it decides."""
    from floorplan.merge.hypotheses import Pairs

    pairs = sorted({(min(p.first, p.second), max(p.first, p.second)) for p in edits.never_merge if not _fault(graph, p)})
    both = np.array(pairs, dtype=np.int64).reshape(len(pairs), 2)
    return Pairs(both[:, 0], both[:, 1])


def edit_merge(graph: LayoutGraph, least_squares: LeastSquaresSolution, merged: MergeResult, edits: Edits) -> MergeResult:
    """The decisions of a merge that kept the pairs of `never_merge` apart, with the planes of `always_merge` joined.

    Pairs that do not apply are left out, and so are those of `always_merge` that would join a pair of `never_merge`.
    """
    from floorplan.merge.hypotheses import numbered

    label, never = merged.plane_of_track.copy(), never_merged(graph, edits)
    hypotheses = _forbidden(merged.hypotheses, never)
    for pair in edits.always_merge:
        if _fault(graph, pair):
            continue
        joined = np.where(label == label[pair.second], label[pair.first], label)
        if (joined[never.first] != joined[never.second]).all():
            label, hypotheses = joined, _forced(hypotheses, least_squares.track_offset_m, pair)
    return replace(merged, plane_of_track=numbered(label), hypotheses=hypotheses)


def merge_notes(graph: LayoutGraph, least_squares: LeastSquaresSolution, merged: MergeResult, edits: Edits) -> tuple[str, ...]:
    """What was done by hand and what could not be, one sentence each, for the plan's notes."""
    notes, plane = [], merged.plane_of_track
    for word, pairs in (("never_merge", edits.never_merge), ("always_merge", edits.always_merge)):
        for pair in pairs:
            name, fault = f"{word} tracks {pair.first} and {pair.second}", _fault(graph, pair)
            if not fault and word == "always_merge" and plane[pair.first] != plane[pair.second]:
                fault = "never_merge keeps their planes apart"
            if fault:
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


def _forbidden(hypotheses: Hypotheses, never: "Pairs") -> Hypotheses:
    """The pairs a person forbade, told so."""
    size = int(max(hypotheses.first.max(initial=0), hypotheses.second.max(initial=0), never.second.max(initial=0))) + 1
    low, high = np.minimum(hypotheses.first, hypotheses.second), np.maximum(hypotheses.first, hypotheses.second)
    mine = np.isin(low * size + high, never.first * size + never.second)
    return replace(hypotheses, verdict=tuple(Verdict.FORBIDDEN if m else v for m, v in zip(mine, hypotheses.verdict, strict=True)))


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
