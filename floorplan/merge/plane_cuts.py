"""Compiled: every way to cut tracks off a plane, and which of them, with the merges that follow, gains most evidence."""

from typing import NamedTuple

import numpy as np

from floorplan.compiled import compiled
from floorplan.merge.evidence_live import score
from floorplan.merge.plane_fit import PlaneFit
from floorplan.merge.plane_links import NO_LINK, NO_TRACK, Links, Tree, likeliest_tree
from floorplan.merge.plane_rollout import Cut, PlanePairs, roll_out, something_follows
from floorplan.model.checks import Array

WORST_FIRST = -10.0  # log odds: a merge less likely than this is not tried for the sake of those that would follow
LEAST_INFORMATION = 1e-6  # 1 / m^2: tracks that hold a plane alone cannot be cut off it


class Best(NamedTuple):
    """The best change of a partition: what it gains, the tracks cut off (none: an empty array), and where every plane goes (K + 1,)."""

    gain: float
    taken: Array
    became: Array


@compiled
def best_cut(fit: PlaneFit, links: Links, pairs: PlanePairs, link: Array, apart: Array, least: float) -> Best:
    """The best of all cuts of single tracks and of subtrees of the planes' likeliest trees, each with the merges that follow.

    `link (T, K)`, `apart (T, K)`: tracks with planes; a gain below `least` is none.
    """
    planes, tracks = len(fit.plane_m), len(fit.label)
    best = Best(least, np.empty(0, np.int64), np.arange(planes + 1))
    inside, side = np.zeros(tracks, np.bool_), np.zeros(tracks, np.bool_)  # scratch: False everywhere
    for plane in range(planes):
        members = np.flatnonzero(fit.label == plane)
        if len(members) < 2:
            continue
        tree = likeliest_tree(links, members, inside, NO_TRACK)
        for at in range(1, len(tree.order)):
            subtree(tree, at, side)
            best = _better(best, fit, pairs, link, apart, plane, members, side, -tree.weight[tree.order[at]])
        if len(members) > 2:
            best = _singles(best, fit, links, pairs, link, apart, plane, members, tree, inside, side)
    return best


@compiled
def best_join(fit: PlaneFit, pairs: PlanePairs, least: float) -> Best:
    """The best of all merges of two planes, each with the merges that follow."""
    planes = len(fit.plane_m)
    best = Best(least, np.empty(0, np.int64), np.arange(planes + 1))
    nothing = Cut(-1, 0.0, 0.0, np.zeros(planes), np.zeros((2, planes)), np.zeros((2, planes), np.bool_), 0.0)
    for h in range(len(pairs.first)):
        alone = score(pairs.distance_m[h], pairs.variance_m2[h], pairs.log_prior[h])
        if not pairs.apart[h] and alone > WORST_FIRST:
            gain, became = roll_out(pairs, fit, nothing, h)
            if gain > best.gain:
                best = Best(gain, best.taken, became)
    return best


@compiled
def subtree(tree: Tree, at: int, side: Array) -> None:
    """side <- the tracks that hang on the one that entered at place `at`."""
    side[tree.order] = False
    side[tree.order[at]] = True
    for k in range(at + 1, len(tree.order)):
        side[tree.order[k]] = side[tree.parent[tree.order[k]]]


@compiled
def _singles(
    best: Best, fit: PlaneFit, links: Links, pairs: PlanePairs, link: Array, apart: Array, plane: int, members: Array, tree: Tree,
    inside: Array, side: Array,
) -> Best:  # fmt: skip
    """The same of single tracks inside the tree; those at its ends are subtrees."""
    degree = np.zeros(len(fit.label), np.int64)
    for at in range(1, len(tree.order)):
        degree[tree.order[at]] += 1
        degree[tree.parent[tree.order[at]]] += 1
    for t in members:
        if degree[t] > 1:
            rest = likeliest_tree(links, members, inside, t)
            if rest.total > NO_LINK:
                side[members] = False
                side[t] = True
                best = _better(best, fit, pairs, link, apart, plane, members, side, rest.total - tree.total)
    return best


@compiled
def _better(
    best: Best, fit: PlaneFit, pairs: PlanePairs, link: Array, apart: Array, plane: int, members: Array, side: Array, prior_gain: float
) -> Best:
    """`best`, or this cut where it gains more; `side (T,)` marks what is taken off the plane."""
    taken = members[side[members]]
    side[members] = False
    u, information, shift = shift_of(fit, taken)
    if information < LEAST_INFORMATION:
        return best
    cost = prior_gain - score(shift, 1.0 / information, 0.0)
    rest_link, rest_apart = np.full((2, len(u)), NO_LINK), np.zeros((2, len(u)), np.bool_)
    at = 0
    for t in members:
        row = 0
        if at < len(taken) and taken[at] == t:
            row, at = 1, at + 1
        for k in range(len(u)):
            rest_link[row, k] = max(rest_link[row, k], link[t, k])
            rest_apart[row, k] |= apart[t, k]
    rest_link[:, plane] = NO_LINK
    cut = Cut(plane, shift, 1.0 / information, u, rest_link, rest_apart, cost)
    if something_follows(pairs, fit, cut):
        gain, became = roll_out(pairs, fit, cut, -1)
    else:
        gain, became = cost - choosing(fit, plane, shift * shift * information, len(taken), len(members)), np.arange(len(u) + 1)
    return Best(gain, taken, became) if gain > best.gain else best


@compiled
def shift_of(fit: PlaneFit, taken: Array) -> tuple[Array, float, float]:
    """How the planes move with the shift of `taken`, the information (1 / m^2) on it, and the shift itself."""
    u, own, pull = np.zeros(len(fit.plane_m)), 0.0, 0.0
    v = np.zeros(len(fit.plane_m))
    for t in taken:
        pull += fit.pull[t]
        for k in range(len(u)):
            u[k] += fit.U[k, t]
            v[k] += fit.WG[k, t]
        for s in taken:
            own += fit.W[t, s]
    for k in range(len(u)):
        own -= u[k] * v[k]
    return u, own, pull / own


@compiled
def choosing(fit: PlaneFit, plane: int, chi_square: float, taken: int, tracks: int) -> float:
    """What two halves of one plane gain by choosing which track goes where: no evidence for two planes (see `halves_of_one`).

    `chi_square` of the shift between the halves is what the cut takes out of the residuals of the `tracks`.
    """
    if taken < 2 or tracks - taken < 2:
        return 0.0
    unused = chi_square - 1.0
    for t in range(len(fit.label)):
        if fit.label[t] == plane:
            unused += 1.0 - fit.U[plane, t] - fit.residual_m[t] * fit.pull[t]
    spare: float = 0.5 * max(unused - np.sqrt(2.0 * (tracks - 2.0)), 0.0)
    return spare
