"""How sure every link of a plane is, with everything else that is known at the end."""

from typing import NamedTuple

import numpy as np

from floorplan.compiled import compiled
from floorplan.merge.evidence_live import score
from floorplan.merge.plane_cuts import LEAST_INFORMATION, shift_of, subtree
from floorplan.merge.plane_fit import PlaneFit
from floorplan.merge.plane_links import NO_TRACK, Links, likeliest_tree
from floorplan.model.checks import Array

CERTAIN_M = 1.0  # a link without which nothing is known of its side


class TreeOdds(NamedTuple):
    """The links of the likeliest trees of some planes: `row` in the question, how far its two sides lie apart left alone, the variance
    of that, and the log odds of their being one plane."""

    row: Array
    shift_m: Array
    variance_m2: Array
    log_odds: Array


@compiled
def tree_odds(fit: PlaneFit, links: Links, planes: Array) -> TreeOdds:
    """The links of the trees of `planes`."""
    tracks, at = len(fit.label), 0
    row, shift, variance, odds = np.empty(tracks, np.int64), np.empty(tracks), np.empty(tracks), np.empty(tracks)
    inside, side = np.zeros(tracks, np.bool_), np.zeros(tracks, np.bool_)
    for plane in planes:
        members = np.flatnonzero(fit.label == plane)
        tree = likeliest_tree(links, members, inside, NO_TRACK)
        for k in range(1, len(tree.order)):
            subtree(tree, k, side)
            taken = members[side[members]]
            side[members] = False
            information, apart = shift_of(fit, taken)[1:]
            row[at] = tree.row[tree.order[k]]
            shift[at], variance[at] = (apart, 1.0 / information) if information > LEAST_INFORMATION else (0.0, CERTAIN_M)
            odds[at] = score(shift[at], variance[at], tree.weight[tree.order[k]])
            at += 1
    return TreeOdds(row[:at], shift[:at], variance[:at], odds[:at])
