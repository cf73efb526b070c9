"""Merges by hand on a graph with two walls 5 cm apart."""

import numpy as np

from floorplan.edits.file import Edits, TrackPair
from floorplan.edits.merges import edit_merge, merge_notes, never_merged
from floorplan.model.graph import Hypotheses, LeastSquaresSolution, MergeResult, Verdict
from tests.graphs import graph_along_x

OFFSETS = np.array([2.0, 2.01, 2.05, 5.0])
GRAPH = graph_along_x([], [(0, 0, 2.0), (0, 1, 2.01), (0, 2, 2.05), (0, 3, 5.0)], facing=[-1, -1, -1, -1])
SOLUTION = LeastSquaresSolution(np.zeros((1, 3)), OFFSETS, 0.0)


def merged(plane_of_track: list[int]) -> MergeResult:
    first, second = np.array([0, 1]), np.array([1, 2])
    distance = OFFSETS[first] - OFFSETS[second]
    nothing = np.full(2, np.nan)
    hypotheses = Hypotheses(first, second, distance, distance, nothing, nothing, (Verdict.ACCEPTED, Verdict.ACCEPTED))
    return MergeResult("paper", hypotheses, np.array(plane_of_track), OFFSETS, np.zeros((1, 3)), 0.0, 0.0, 0.0)


def test_a_pair_a_person_forbade_is_told_among_the_hypotheses() -> None:
    result = edit_merge(GRAPH, SOLUTION, merged([0, 0, 1, 2]), Edits(never_merge=(TrackPair(2, 1),)))
    assert result.plane_of_track.tolist() == [0, 0, 1, 2]
    assert result.hypotheses.verdict == (Verdict.ACCEPTED, Verdict.FORBIDDEN)


def test_a_forced_merge_that_would_join_a_forbidden_pair_is_not_made_and_is_told() -> None:
    edits = Edits(never_merge=(TrackPair(0, 2),), always_merge=(TrackPair(1, 2), TrackPair(3, 2)))
    result = edit_merge(GRAPH, SOLUTION, merged([0, 0, 1, 2]), edits)
    assert result.plane_of_track.tolist() == [0, 0, 1, 1]
    notes = merge_notes(GRAPH, SOLUTION, result, edits)
    assert [note.startswith("Edit not applied") for note in notes] == [False, True, False]
    assert "never_merge keeps their planes apart" in notes[1]


def test_only_pairs_that_can_be_meant_are_kept_apart_each_once() -> None:
    never = never_merged(GRAPH, Edits(never_merge=(TrackPair(2, 0), TrackPair(0, 2), TrackPair(1, 9))))
    assert (never.first.tolist(), never.second.tolist()) == ([0], [2])


def test_a_forced_merge_joins_both_planes_and_is_a_row_of_the_hypotheses() -> None:
    result = edit_merge(GRAPH, SOLUTION, merged([0, 0, 0, 1]), Edits(always_merge=(TrackPair(3, 1),)))
    assert result.plane_of_track.tolist() == [0, 0, 0, 0]
    assert result.hypotheses.verdict[-1] is Verdict.FORCED
    assert (result.hypotheses.first[-1], result.hypotheses.second[-1]) == (3, 1)
    assert result.hypotheses.accepted.all()
    notes = merge_notes(GRAPH, SOLUTION, result, Edits(always_merge=(TrackPair(3, 1),)))
    assert "2.99 m apart" in notes[0]


def test_what_is_apart_already_stays_as_it_is() -> None:
    before = merged([0, 0, 1, 2])
    result = edit_merge(GRAPH, SOLUTION, before, Edits(never_merge=(TrackPair(0, 2),)))
    assert result.plane_of_track.tolist() == [0, 0, 1, 2]


def test_edits_that_cannot_be_meant_change_nothing_and_are_told() -> None:
    other = graph_along_x([], [(0, 0, 2.0), (0, 1, -2.0)], facing=[-1, 1])
    edits = Edits(always_merge=(TrackPair(0, 1), TrackPair(0, 9)))
    solution = LeastSquaresSolution(np.zeros((1, 3)), np.array([2.0, -2.0]), 0.0)
    nothing = np.zeros(0)
    none = Hypotheses(nothing, nothing, nothing, nothing, nothing, nothing, ())
    before = MergeResult("paper", none, np.array([0, 1]), np.array([2.0, -2.0]), np.zeros((1, 3)), 0.0, 0.0, 0.0)
    assert edit_merge(other, solution, before, edits).plane_of_track.tolist() == [0, 1]
    notes = merge_notes(other, solution, before, edits)
    assert [note.startswith("Edit not applied") for note in notes] == [True, True]
    assert "face different ways" in notes[0]
    assert "no track 9" in notes[1]
