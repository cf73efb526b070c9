"""Best-first merging with look-ahead: the order of the decisions is what keeps wrong merges out."""

from dataclasses import dataclass

import numpy as np

from floorplan.compiled import compiled
from floorplan.merge.evidence_covariance import PENDING, Joint, column, multiplied_out
from floorplan.merge.evidence_futures import better_future
from floorplan.merge.evidence_live import BLOCK, NEVER, Live, best_pair, condition, halves_of_one, rivals, score_all, top_of_block
from floorplan.model.checks import Array

CLEAR = 5.0  # log odds, 150 to 1: a rival weaker by this much (three sigma off) does not make a choice ambiguous
MARGINS = (np.inf, 3.0, 1.0)  # what the better future must lead by: first no rival at all, then 20 to 1, at last 3 to 1
RIVALS = 16  # futures compared with that of the best pair; fewer may all be of one wrong kind
WORTH_CLOSING_UP = 0.5  # share of pairs still in question below which the others are taken out


@dataclass(frozen=True)
class Question:
    """Pairs of planes (H rows) that may be one: distance and variance before any merge, prior log odds, seen apart or not."""

    first: Array
    second: Array
    delta_m: Array
    variance_m2: Array
    log_prior: Array
    apart: Array


@dataclass(frozen=True)
class Decision:
    """What became of the pairs: `plane (T,)` label per plane, distance and variance of every pair when it was decided,

    `open` pairs still waiting (positive score, put off); `log_evidence` sum of the scores of the merges made; `made` rows of the
    pairs that were merged, in that order, the others being what followed; `made_odds` their scores then.
    """

    plane: Array
    delta_m: Array
    variance_m2: Array
    open: Array
    log_evidence: float
    made: Array
    made_odds: Array


def decide(question: Question, covariance: Array) -> Decision:
    """Merge best first; a choice that would lose a nearly equal rival waits, then is settled by looking ahead, or is left open."""
    count, planes = len(question.first), len(covariance)
    blocks = -(-count // BLOCK)
    live = Live(
        question.first.astype(np.int32), question.second.astype(np.int32), question.delta_m.copy(), question.variance_m2.copy(),
        question.log_prior.copy(), np.empty(count), np.where(question.apart, NEVER, 0.0), np.zeros(count, dtype=np.bool_),
        np.arange(count, dtype=np.int32), np.zeros(blocks), np.zeros(blocks),
    )  # fmt: skip
    final = Live(*(values.copy() for values in live))
    joint = Joint(np.ascontiguousarray(covariance), np.empty((PENDING, planes)), np.arange(planes), np.zeros(planes))
    made, made_odds = np.empty(planes, np.int64), np.empty(planes)
    component, merges = _merge_all(live, final, joint, np.array(MARGINS), made, made_odds)
    return Decision(component, final.delta, final.var, final.waiting, float(made_odds[:merges].sum()), made[:merges], made_odds[:merges])


@compiled
def _merge_all(live: Live, final: Live, joint: Joint, margins: Array, made: Array, made_odds: Array) -> tuple[Array, int]:
    """Merge until nothing is left to decide; `final` gets what became of every pair, `made` and `made_odds` the merges.

    Gives back the component of every plane and how many merges there were.
    """
    count, asked, r, level, moved, merges = len(live.first), len(live.first), 0, 0, False, 0
    seat, unit = np.full(len(joint.P), -1), np.empty(len(joint.P))
    score_all(live, count)
    while level < len(margins):
        chosen = _chosen(live, count, joint, r, margins[level], unit)
        if chosen < 0 and not moved and level == len(margins) - 1:
            chosen = halves_of_one(live, count, joint.spare, joint.component)
            if chosen >= 0:
                _gain(live, joint, r, chosen, unit)
        if chosen < 0:
            level, moved = (0 if moved else level + 1), False
            live.waiting[:] = live.waiting & (level == len(margins))
            live.open_top[:] = live.top
            continue
        moved, before = True, (live.odds[chosen], live.delta[chosen], live.var[chosen])
        made[merges], made_odds[merges] = live.origin[chosen], before[0]
        merges += 1
        asked -= _merge(live, count, joint, unit, chosen, seat)
        live.delta[chosen], live.var[chosen] = before[1], before[2]
        joint.U[r] = unit
        r += 1
        if asked < WORTH_CLOSING_UP * count:
            live, count = _closed_up(live, final, count)
        if r == PENDING:
            joint, number = multiplied_out(joint)
            r, seat, unit = 0, seat[: len(joint.P)], unit[: len(joint.P)]
            for k in range(count):
                live.first[k], live.second[k] = number[live.first[k]], number[live.second[k]]
    _closed_up(live, final, count)
    return joint.component, merges


@compiled
def _chosen(live: Live, count: int, joint: Joint, r: int, margin: float, unit: Array) -> int:
    """The pair to merge now, its gain in `unit`, or -1; pairs whose choice is put off are left waiting."""
    h = best_pair(live, count)
    while h >= 0:
        chosen = _settled(live, count, joint, r, h, margin, unit)
        if chosen >= 0:
            if chosen != h:
                _gain(live, joint, r, chosen, unit)
            return chosen
        live.waiting[h] = True
        top_of_block(live, h // BLOCK, count)
        h = best_pair(live, count)
    return -1


@compiled
def _settled(live: Live, count: int, joint: Joint, r: int, h: int, margin: float, unit: Array) -> int:
    """The pair to merge now in place of `h`: itself, a rival with a clearly better future, or -1 to put the choice off.

    `unit` is left with the gain of merging h.
    """
    _gain(live, joint, r, h, unit)
    options = np.empty(RIVALS + 1, np.int64)
    options[0] = h
    found = rivals(live, count, unit, live.delta[h] / np.sqrt(live.var[h]), h, CLEAR, options[1:])
    if found == 0:
        return h
    if not np.isfinite(margin):
        return -1
    return better_future(live, count, joint, r, unit, options[: found + 1], margin)


@compiled
def _gain(live: Live, joint: Joint, r: int, h: int, unit: Array) -> None:
    """unit <- covariance of every component with the distance of pair h, over its sigma."""
    column(joint.P, joint.U, r, live.first[h], live.second[h], unit)
    sigma = np.sqrt(live.var[h])
    for i in range(len(unit)):
        unit[i] /= sigma


@compiled
def _merge(live: Live, count: int, joint: Joint, unit: Array, h: int, seat: Array) -> int:
    """Condition all pairs on pair h being one plane and join its components; gives back how many pairs are settled by that."""
    keep, gone = live.first[h], live.second[h]
    joint.spare[keep] += joint.spare[gone] + 1.0 - live.delta[h] ** 2 / live.var[h]
    for i in range(len(joint.component)):
        if joint.component[i] == gone:
            joint.component[i] = keep
    return condition(live, count, unit, live.delta[h] / np.sqrt(live.var[h]), keep, gone, seat)


@compiled
def _closed_up(live: Live, final: Live, count: int) -> tuple[Live, int]:
    """The pairs still in question, and how many; what became of the first `count` is noted in `final`."""
    kept = 0
    for h in range(count):
        slot = live.origin[h]
        final.delta[slot], final.var[slot], final.waiting[slot] = live.delta[h], live.var[h], False
        if live.first[h] == live.second[h]:
            continue
        final.waiting[slot] = live.waiting[h]
        live.first[kept], live.second[kept], live.delta[kept], live.var[kept] = live.first[h], live.second[h], live.delta[h], live.var[h]
        live.log_prior[kept], live.base[kept], live.odds[kept] = live.log_prior[h], live.base[h], live.odds[h]
        live.waiting[kept], live.origin[kept] = live.waiting[h], slot
        kept += 1
    blocks = -(-kept // BLOCK)
    closed = Live(
        live.first[:kept], live.second[:kept], live.delta[:kept], live.var[:kept], live.log_prior[:kept], live.base[:kept],
        live.odds[:kept], live.waiting[:kept], live.origin[:kept], live.top[:blocks], live.open_top[:blocks],
    )  # fmt: skip
    for block in range(blocks):
        top_of_block(closed, block, kept)
    return closed, kept
