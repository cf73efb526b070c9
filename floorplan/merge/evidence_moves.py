"""After merging: tracks whose plane is against the evidence move to another, and planes are cut or joined, until nothing gains.

A merge is judged when it is made, with what is known then; later merges take drift out, and a wrong one may stand out only at the end,
held by one track alone. Here every track, and every part of a plane that hangs on one link, is taken off on trial, the merges that
follow are made, and the change stays where the exact log evidence of the whole grows (E14). See docs/back-end.md, "Moves".
"""

from dataclasses import dataclass, replace

import numpy as np

from floorplan.merge.evidence_greedy import Decision, Question
from floorplan.merge.hypotheses import numbered
from floorplan.merge.plane_cuts import Best, best_cut, best_join
from floorplan.merge.plane_fit import PlaneFit, fit_planes
from floorplan.merge.plane_links import Links, links_of, plane_links
from floorplan.merge.plane_rollout import pairs_of_planes
from floorplan.merge.plane_trees import tree_odds
from floorplan.model.checks import Array
from floorplan.model.plane_moves import PlaneMove

LEAST_GAIN = 1.0  # log odds, 3 to 1, as for choices in the search
MOST_MOVES = 60  # of one system; far more than were ever needed


@dataclass(frozen=True)
class Moved:
    """What became of a decision: with its moves in order, tracks numbered as in the question, and the tracks about its planes."""

    decision: Decision
    moves: tuple[PlaneMove, ...]
    fit: PlaneFit


def move_tracks(question: Question, decision: Decision, plane: Array, offset_m: Array, W: Array) -> Moved:
    """Improve the partition `plane (T,)`, that of `decision` or another, one move at a time.

    `W (T, T)` is the inverse of the joint covariance of the tracks at `offset_m (T,)`.
    """
    links = links_of(question, len(offset_m))
    fit, moves = fit_planes(W, offset_m, numbered(plane)), list[PlaneMove]()
    while len(moves) < MOST_MOVES:
        best = _best_move(fit, links)
        if best.gain <= LEAST_GAIN:
            break
        moves.append(_told(fit.label, best))
        fit = fit_planes(W, offset_m, _moved(fit.label, best))
    same = bool((fit.label == numbered(decision.plane)).all())
    return Moved(decision if same else _redecided(question, decision, fit, links), tuple(moves), fit)


def _best_move(fit: PlaneFit, links: Links) -> Best:
    link, apart = plane_links(links, fit.label, len(fit.plane_m))
    pairs = pairs_of_planes(fit, link, apart)
    joined = best_join(fit, pairs, LEAST_GAIN)
    cut = best_cut(fit, links, pairs, link, apart, joined.gain)
    return cut if cut.gain > joined.gain else joined


def _moved(label: Array, best: Best) -> Array:
    """The labels after a move."""
    after = label.copy()
    after[best.taken] = len(best.became) - 1
    return numbered(best.became[after])


def _told(label: Array, best: Best) -> PlaneMove:
    """A move in words of tracks: each plane by its first one."""
    last = len(best.became) - 1
    joined = int((best.became[:-1] != np.arange(last)).sum())
    if not len(best.taken):
        return PlaneMove((), None, None, joined, float(best.gain))
    stayed = np.setdiff1d(np.flatnonzero(label == label[best.taken[0]]), best.taken)
    beside = np.setdiff1d(np.flatnonzero(best.became[label] == best.became[last]), best.taken)
    target = int(beside[0]) if len(beside) else None
    return PlaneMove(tuple(best.taken.tolist()), int(stayed[0]), target, joined, float(best.gain))


def _redecided(question: Question, decision: Decision, fit: PlaneFit, links: Links) -> Decision:
    """The decision after moves: pairs they changed have its numbers, planes they changed a new tree of merges."""
    first, second = question.first, question.second
    before, label = numbered(decision.plane), fit.label
    delta, variance = decision.delta_m.copy(), decision.variance_m2.copy()
    parted = np.flatnonzero((before[first] == before[second]) & (label[first] != label[second]))
    a, b, C = label[first[parted]], label[second[parted]], fit.covariance_m2
    delta[parted], variance[parted] = fit.plane_m[a] - fit.plane_m[b], C[a, a] + C[b, b] - 2 * C[a, b]
    touched = changed(before, label)
    tree = tree_odds(fit, links, np.unique(label[touched]))
    united = np.flatnonzero((before[first] != before[second]) & (label[first] == label[second]))
    delta[united], variance[united] = _left_alone(fit, first[united])
    delta[tree.row], variance[tree.row] = tree.shift_m, tree.variance_m2
    kept = ~touched[first[decision.made]]
    made, odds = np.append(decision.made[kept], tree.row), np.append(decision.made_odds[kept], tree.log_odds)
    return replace(decision, plane=label, delta_m=delta, variance_m2=variance, made=made, made_odds=odds)


def _left_alone(fit: PlaneFit, track: Array) -> tuple[Array, Array]:
    """How far each track would lie from its plane if nothing held it there, and the variance of that."""
    information = fit.W[track, track] - (fit.WG[:, track] * fit.U[:, track]).sum(axis=0)
    return fit.pull[track] / information, 1.0 / information


def changed(before: Array, after: Array) -> Array:
    """Tracks (T,) whose plane holds other tracks than before."""
    both = np.unique(before * (int(after.max()) + 1) + after, return_inverse=True)[1]
    together, was, now = np.bincount(both)[both], np.bincount(before)[before], np.bincount(after)[after]
    return np.asarray((together != was) | (together != now))
