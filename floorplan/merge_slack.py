"""What a merge leaves open: two surfaces taken for one may yet be two, and the distances across such a merge are known less well."""

import numpy as np
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components

from floorplan.model.checks import Array
from floorplan.model.merges_made import MergesMade

NEGLIGIBLE_M = 1e-4  # no distance of a plan is known to this


def slack_m(log_odds: Array, delta_m: Array, variance_m2: Array) -> Array:
    """Root mean square (E,) of the distance between the two sides of a merge (E13).

    With probability p the sides are one plane, else their distance is `N(delta, V)`: mean square `(1 - p) (V + delta^2)`.
    """
    wrong = 1.0 / (1.0 + np.exp(np.maximum(log_odds, 0.0)))  # below even odds it rests on other evidence: two halves of one plane
    return np.asarray(np.sqrt(wrong * (variance_m2 + delta_m**2)))


def slack_of_tracks_m(made: MergesMade, tracks: Array) -> Array:
    """One row per doubtful merge (D, T): how `tracks` move when its slack is one sigma, half of it on either side."""
    last = int(max(tracks.max(initial=-1), made.first.max(initial=-1), made.second.max(initial=-1))) + 1
    mine = np.zeros(last, dtype=bool)
    mine[tracks] = True
    doubtful = np.flatnonzero((made.slack_m > NEGLIGIBLE_M) & mine[made.first])
    sides = np.array([_sides(made, int(edge), last)[tracks] for edge in doubtful]).reshape(len(doubtful), len(tracks))
    return np.asarray(sides * made.slack_m[doubtful, None])


def _sides(made: MergesMade, edge: int, count: int) -> Array:
    """+1/2 and -1/2 for the tracks on either side of a merge, 0 for all others."""
    others = np.arange(len(made)) != edge
    links = coo_array((np.ones(others.sum()), (made.first[others], made.second[others])), shape=(count, count))
    part = connected_components(links, directed=False)[1]
    return np.asarray(0.5 * (part == part[made.first[edge]]) - 0.5 * (part == part[made.second[edge]]))
