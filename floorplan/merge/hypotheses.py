"""Pairs of tracks that may be one plane, and the planes that accepted pairs make."""

from dataclasses import dataclass

import numpy as np
from scipy import sparse
from scipy.sparse import csgraph

from floorplan.model.checks import Array
from floorplan.model.graph import LayoutGraph


@dataclass(frozen=True)
class Pairs:
    """Rows of `E`: `first (H,)` < `second (H,)`, tracks; row h says `m_first - m_second = 0`."""

    first: Array
    second: Array

    def __len__(self) -> int:
        return len(self.first)

    def gap_m(self, track_offset_m: Array) -> Array:
        """`E xi` (H,): signed `m_first - m_second`."""
        return np.asarray(track_offset_m[self.first] - track_offset_m[self.second])

    def select(self, rows: Array) -> "Pairs":
        """The pairs chosen by a mask or by row numbers."""
        return Pairs(self.first[rows], self.second[rows])


def no_pairs() -> Pairs:
    """No pair at all."""
    return Pairs(np.zeros(0, dtype=np.int64), np.zeros(0, dtype=np.int64))


def pairs_within(graph: LayoutGraph, track_offset_m: Array, radius_m: float) -> Pairs:
    """All pairs of tracks of equal axis and facing whose offsets differ by at most `radius_m`, sorted.

    Pairs seen in one frame are allowed, as published.
    """
    first, second = [], []
    group = graph.axis * 2 + (graph.facing > 0)
    for label in np.unique(group):
        track = np.flatnonzero(group == label)
        track = track[np.argsort(track_offset_m[track], kind="stable")]
        offset = track_offset_m[track]
        count = np.searchsorted(offset, offset + radius_m, side="right") - np.arange(len(track)) - 1
        left = np.repeat(np.arange(len(track)), count)
        right = left + 1 + np.arange(len(left)) - np.repeat(np.cumsum(count) - count, count)
        first.append(track[left])
        second.append(track[right])
    if not first:
        return no_pairs()
    both = np.sort(np.stack((np.concatenate(first), np.concatenate(second)), axis=1), axis=1)
    order = np.lexsort((both[:, 1], both[:, 0]))
    return Pairs(both[order, 0], both[order, 1])


def planes_of_tracks(tracks: int, accepted: Pairs) -> Array:
    """Connected components of the accepted pairs (M,), numbered by their first track."""
    links = sparse.coo_array((np.ones(len(accepted)), (accepted.first, accepted.second)), shape=(tracks, tracks))
    return numbered(csgraph.connected_components(links, directed=False)[1])


def numbered(label: Array) -> Array:
    """Labels 0..L-1 in order of their first track."""
    _, first, inverse = np.unique(label, return_index=True, return_inverse=True)
    rank = np.empty(len(first), dtype=np.int64)
    rank[np.argsort(first)] = np.arange(len(first))
    return np.asarray(rank[inverse])
