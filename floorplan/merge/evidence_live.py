"""Compiled kernels on the live pairs of the evidence merge: scores, conditioning on a merge, who is best. See docs/back-end.md, "Evidence".

A pair h asks whether components `first[h]` and `second[h]` are one plane: `delta` their distance, `var` its variance, both given all
merges so far. A pair inside one component has `first == second` and is no question any more. Every pass over the pairs is
memory traffic, so scores are kept and only their blocks' best ones are looked at.
"""

from typing import NamedTuple

import numpy as np

from floorplan.compiled import compiled
from floorplan.model.checks import Array

SAME_M2 = 1e-10  # (0.01 mm)^2: a pair whose distance is this certain has been made one by other merges
CONCERNED = 0.25  # a pair whose variance falls below this part of what it was is settled by the choice at hand
NEGLIGIBLE_M = 1e-10  # a merge that moves a pair by less than this times its sigma leaves it as it is
BLOCK = 512  # pairs whose best score is kept together: fits the first-level cache
NEVER = -np.inf  # score of a pair that can no longer be merged
LOG_TWO_PI = np.log(2 * np.pi)


class Live(NamedTuple):
    """Pairs by row (H,): components, distance, variance, prior log odds, score now, put off or not, row in the question.

    `top (blocks,)` best positive score of each block, `open_top` the same of the pairs that are not put off.
    """

    first: Array
    second: Array
    delta: Array
    var: Array
    log_prior: Array
    odds: Array
    waiting: Array
    origin: Array
    top: Array
    open_top: Array


@compiled
def score(delta: float, var: float, log_prior: float) -> float:
    """Log odds that a pair is one plane (E8)."""
    odds: float = log_prior - 0.5 * (LOG_TWO_PI + np.log(var) + delta * delta / var)
    return odds


@compiled
def score_block(live: Live, block: int, count: int) -> None:
    """Best scores of one block of the first `count` pairs."""
    top, open_top = 0.0, 0.0
    for h in range(block * BLOCK, min((block + 1) * BLOCK, count)):
        if live.odds[h] > top:
            top = live.odds[h]
        if live.odds[h] > open_top and not live.waiting[h]:
            open_top = live.odds[h]
    live.top[block], live.open_top[block] = top, open_top


@compiled
def score_all(live: Live, count: int) -> None:
    """Scores of all pairs that are not barred, and of all blocks."""
    for h in range(count):
        if live.odds[h] > NEVER:
            live.odds[h] = score(live.delta[h], live.var[h], live.log_prior[h]) if live.var[h] >= SAME_M2 else NEVER
    for block in range(len(live.top)):
        score_block(live, block, count)


@compiled
def best_pair(live: Live, count: int) -> int:
    """The pair of highest score among those not put off; -1 where none scores above zero."""
    best, found = 0.0, -1
    for block in range(len(live.open_top)):
        if live.open_top[block] > best:
            for h in range(block * BLOCK, min((block + 1) * BLOCK, count)):
                if live.odds[h] > best and not live.waiting[h]:
                    best, found = live.odds[h], h
    return found


@compiled
def halves_of_one(live: Live, count: int, spare: Array, component: Array) -> int:
    """The likeliest pair of components that are one plane split by choosing, or -1.

    Tracks of one plane that each went to the nearer of two offsets leave two halves in which everything fits better than its noise allows.
    What was gained by choosing is no evidence for two planes: half of the chi-square left unused (`spare`), as far as it is more than
    chance leaves (one standard deviation of it), is given back to the pair.
    """
    best, found, tracks = 0.0, -1, np.zeros(len(spare))
    for c in component:
        tracks[c] += 1.0
    for h in range(count):
        if live.odds[h] > NEVER and not live.waiting[h]:
            a, b = live.first[h], live.second[h]
            unused = spare[a] + spare[b] - np.sqrt(2.0 * (tracks[a] + tracks[b] - 2.0))
            value = live.odds[h] + 0.5 * max(unused, 0.0)
            if value > best:
                best, found = value, h
    return found


@compiled
def condition(live: Live, count: int, unit: Array, pull: float) -> None:
    """Every pair's distance, variance and score after a merge with gain `unit` (covariance with the merged distance / its sigma)."""
    for block in range(len(live.top)):
        for h in range(block * BLOCK, min((block + 1) * BLOCK, count)):
            part = unit[live.first[h]] - unit[live.second[h]]
            if abs(part) > NEGLIGIBLE_M:
                live.delta[h] -= part * pull
                var = max(live.var[h] - part * part, 0.0)
                live.var[h] = var
                if live.odds[h] > NEVER:
                    live.odds[h] = score(live.delta[h], var, live.log_prior[h]) if var >= SAME_M2 else NEVER
        score_block(live, block, count)


@compiled
def join(live: Live, count: int, keep: int, gone: int, seat: Array) -> int:
    """Rename component `gone` to `keep` in all pairs and join doubled ones; gives back how many ceased to be questions.

    Of two pairs that ask the same question the better prior counts (the smaller gap) and a bar of either stays.
    `seat (planes,)` is scratch, -1 everywhere before and after.
    """
    ceased = 0
    for h in range(count):
        a, b = live.first[h], live.second[h]
        if a == b or (a != keep and a != gone and b != keep and b != gone):
            continue
        a, b = keep if a == gone else a, keep if b == gone else b
        live.first[h], live.second[h] = a, b
        other = b if a == keep else a
        twin = seat[other]
        if a != b and twin < 0:
            seat[other] = h
            continue
        if a != b:
            _unite(live, twin, h)
            score_block(live, twin // BLOCK, count)
        live.second[h] = a
        live.odds[h] = NEVER
        score_block(live, h // BLOCK, count)
        ceased += 1
    seat[:] = -1
    return ceased


@compiled
def _unite(live: Live, twin: int, other: int) -> None:
    """Let `twin` stand for `other` too."""
    live.waiting[twin] = live.waiting[twin] or live.waiting[other]
    live.log_prior[twin] = max(live.log_prior[twin], live.log_prior[other])
    if live.odds[other] == NEVER:
        live.odds[twin] = NEVER
    if live.odds[twin] > NEVER:
        live.odds[twin] = score(live.delta[twin], live.var[twin], live.log_prior[twin])


@compiled
def rivals(live: Live, count: int, unit: Array, pull: float, chosen: int, close: float, found: Array) -> int:
    """Pairs nearly as good as the chosen one that would be lost by merging it; strongest first into `found`, gives back how many."""
    floor, used = max(live.odds[chosen] - close, 0.0), 0
    for block in range(len(live.top)):
        if live.top[block] <= floor:
            continue
        for h in range(block * BLOCK, min((block + 1) * BLOCK, count)):
            if live.odds[h] <= floor or h == chosen or not _loses(live, h, unit, pull):
                continue
            place = used
            while place > 0 and live.odds[found[place - 1]] < live.odds[h]:
                place -= 1
            if place < len(found):
                used = min(used + 1, len(found))
                found[place + 1 : used] = found[place : used - 1].copy()
                found[place] = h
    return used


@compiled
def _loses(live: Live, h: int, unit: Array, pull: float) -> bool:
    """Whether a merge of gain `unit` settles pair h, and against it."""
    part = unit[live.first[h]] - unit[live.second[h]]
    then = live.var[h] - part * part
    if then < SAME_M2 or then > CONCERNED * live.var[h]:
        return False
    return score(live.delta[h] - part * pull, then, live.log_prior[h]) <= 0.0
