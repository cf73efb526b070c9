"""What a merge leaves open: two surfaces taken for one may yet be two, and the distances across such a merge are known less well."""

from typing import NamedTuple

import numpy as np
from scipy.special import ndtri

from floorplan.compiled import compiled
from floorplan.model.checks import Array
from floorplan.model.merges_made import MergesMade
from floorplan.model.normal import NORMAL_95

SHARE_95 = 0.95  # what an interval is to hold
NEGLIGIBLE_M = 1e-4  # no distance of a plan is known to this


def slack_m(log_odds: Array, delta_m: Array, variance_m2: Array) -> Array:
    """Standard deviation (E,) that stands for the distance between the two sides of a merge (E13).

    With probability p the sides are one plane, else their distance is `N(delta, V)`: mean square `(1 - p) (V + delta^2)`. Where a merge is
    wrong more than one time in twenty, 1.96 times the root of that holds less than 95 % of the distances: then what does.
    """
    wrong = 1.0 / (1.0 + np.exp(np.maximum(log_odds, 0.0)))  # below even odds it rests on other evidence: two halves of one plane
    tail = np.minimum(0.5 * (1.0 - SHARE_95) / wrong, 0.5)  # of the distances of wrong merges, on either side
    share = np.maximum(np.sqrt(wrong), -ndtri(tail) / NORMAL_95)
    return np.asarray(share * np.sqrt(variance_m2 + delta_m**2))


class _Walk(NamedTuple):
    """The trees that merges make of tracks, walked from a root each: whatever hangs below a track follows it without a gap.

    `order (T,)` the tracks as they were met; `place (T,)` of each in it, `after (T,)` the first place behind all that hangs below it;
    `above (T,)` the track before, itself for a root; `root (T,)` of its tree.
    """

    order: Array
    place: Array
    after: Array
    above: Array
    root: Array


def slack_of_tracks_m(made: MergesMade, tracks: Array, rows: Array) -> Array:
    """One row per doubtful merge (D, T): how `tracks` move when its slack is one sigma.

    The plane as drawn stands for the side that was seen more, by the number of `rows (M,)` of its tracks: the other side moves.
    """
    last = int(max(tracks.max(initial=-1), made.first.max(initial=-1), made.second.max(initial=-1))) + 1
    column = np.full(last, -1)
    column[tracks] = np.arange(len(tracks))
    doubtful = np.flatnonzero((made.slack_m > NEGLIGIBLE_M) & (column[made.first] >= 0))
    if not len(doubtful):
        return np.zeros((0, len(tracks)))
    walk = _walked(made.first, made.second, last)
    seen = np.concatenate((rows[:last], np.zeros(max(last - len(rows), 0), dtype=rows.dtype)))
    below = np.where(walk.above[made.first[doubtful]] == made.second[doubtful], made.first[doubtful], made.second[doubtful])
    return _sides(walk, below, made.slack_m[doubtful], np.concatenate(([0], np.cumsum(seen[walk.order]))), column, len(tracks))


@compiled
def _sides(walk: _Walk, below: Array, slack_m: Array, seen: Array, column: Array, count: int) -> Array:
    """`slack_m (D,)` in the columns (count,) of the tracks that hang `below (D,)`, or of the others of their tree if those were seen less.

    `seen (T + 1,)`: rows of the tracks before each place of the walk.
    """
    sides = np.zeros((len(below), count))
    for d in range(len(below)):
        track, top = below[d], walk.root[below[d]]
        first, last, start, end = walk.place[track], walk.after[track], walk.place[top], walk.after[top]
        under = seen[last] - seen[first]
        fewer = under <= seen[end] - seen[start] - under
        for k in range(start, end):
            where = column[walk.order[k]]
            if where >= 0 and (first <= k < last) == fewer:
                sides[d, where] = slack_m[d]
    return sides


@compiled
def _walked(first: Array, second: Array, count: int) -> _Walk:
    """The trees of `count` tracks, depth first."""
    start, beside = _neighbours(first, second, count)
    order, place, after = np.empty(count, np.int64), np.full(count, -1), np.zeros(count, np.int64)
    above, root, stack = np.arange(count), np.arange(count), np.empty(count + 2 * len(first), np.int64)
    met = 0
    for tree in range(count):
        waiting = 0
        if place[tree] < 0:
            stack[0], waiting = tree, 1
        while waiting > 0:
            waiting -= 1
            track = stack[waiting]
            if place[track] >= 0:
                continue
            order[met], place[track], root[track] = track, met, tree
            met += 1
            for k in range(start[track], start[track + 1]):
                if place[beside[k]] < 0:
                    above[beside[k]] = track
                    stack[waiting] = beside[k]
                    waiting += 1
    for k in range(count - 1, -1, -1):
        track = order[k]
        after[track] = max(after[track], k + 1)
        after[above[track]] = max(after[above[track]], after[track])
    return _Walk(order, place, after, above, root)


@compiled
def _neighbours(first: Array, second: Array, count: int) -> tuple[Array, Array]:
    """Of every track (count + 1,) where its neighbours begin in the second."""
    start = np.zeros(count + 1, np.int64)
    for e in range(len(first)):
        start[first[e] + 1] += 1
        start[second[e] + 1] += 1
    start = np.cumsum(start)
    free, beside = start.copy(), np.empty(2 * len(first), np.int64)
    for e in range(len(first)):
        a, b = first[e], second[e]
        beside[free[a]], beside[free[b]] = b, a
        free[a] += 1
        free[b] += 1
    return start, beside
