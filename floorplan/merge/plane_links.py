"""Compiled: which tracks of a partition are linked by a question, and the likeliest tree that holds a plane together."""

from typing import NamedTuple

import numpy as np

from floorplan.compiled import compiled
from floorplan.merge.evidence_greedy import Question
from floorplan.model.checks import Array

NO_TRACK = -1
NO_LINK = -np.inf


class Links(NamedTuple):
    """The pairs of a question by track, both ways: those of track t are rows `start[t]` to `start[t + 1]`.

    `other` the track at the other end, `row` of the pair in the question, `log_prior` of it, `apart` whether they can never be one plane.
    """

    start: Array
    other: Array
    row: Array
    log_prior: Array
    apart: Array


class Tree(NamedTuple):
    """The likeliest tree of some tracks: their `order` of entry; by track its `parent`, the `weight` and `row` of the link to it.

    `total` of the weights; minus infinity where the tracks are not all linked.
    """

    order: Array
    parent: Array
    weight: Array
    row: Array
    total: float


def links_of(question: Question, tracks: int) -> Links:
    """The links of a question about `tracks` tracks."""
    here = np.concatenate([question.first, question.second])
    there = np.concatenate([question.second, question.first])
    order = np.lexsort((there, here))
    start = np.searchsorted(here[order], np.arange(tracks + 1))
    both = np.tile(np.arange(len(question.first)), 2)[order]
    return Links(start, there[order], both, question.log_prior[both], question.apart[both])


@compiled
def likeliest_tree(links: Links, members: Array, inside: Array, without: int) -> Tree:
    """Prim's tree of largest prior log odds over `members` but `without`; `inside (T,)` is scratch, False everywhere before and after."""
    size = len(inside)
    best, parent, weight, by = np.full(size, NO_LINK), np.full(size, NO_TRACK), np.zeros(size), np.full(size, NO_TRACK)
    for t in members:
        inside[t] = t != without
    order, total = np.empty(len(members), np.int64), 0.0
    count, t = 0, members[1] if members[0] == without else members[0]
    while True:
        order[count] = t
        count, inside[t] = count + 1, False
        for row in range(links.start[t], links.start[t + 1]):
            u = links.other[row]
            if inside[u] and not links.apart[row] and links.log_prior[row] > best[u]:
                best[u], parent[u], by[u] = links.log_prior[row], t, links.row[row]
        top, t = NO_LINK, NO_TRACK
        for u in members:
            if inside[u] and best[u] > top:
                top, t = best[u], u
        if t == NO_TRACK:
            break
        weight[t] = top
        total += top
    wanted = len(members) - (1 if without != NO_TRACK else 0)
    for t in members:
        inside[t] = False
    return Tree(order[:count], parent, weight, by, total if count == wanted else NO_LINK)


@compiled
def plane_links(links: Links, label: Array, planes: int) -> tuple[Array, Array]:
    """Largest prior log odds of every track with every plane (T, K), and whether something in that plane can never be one with it."""
    best, apart = np.full((len(label), planes), NO_LINK), np.zeros((len(label), planes), np.bool_)
    for t in range(len(label)):
        for row in range(links.start[t], links.start[t + 1]):
            k = label[links.other[row]]
            if links.apart[row]:
                apart[t, k] = True
            elif links.log_prior[row] > best[t, k]:
                best[t, k] = links.log_prior[row]
    return best, apart
