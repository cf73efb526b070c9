"""Compiled kernels on the live pairs of the evidence merge: scores, conditioning on a merge, who is best. See docs/back-end.md, "Evidence".

A pair h asks whether components `first[h]` and `second[h]` are one plane: `delta` their distance, `var` its variance, both given all
merges so far. A pair inside one component has `first == second` and is no question any more. Every pass over the pairs is
memory traffic, so scores are bounded and only their blocks' best ones are looked at.
"""

from typing import NamedTuple

import numpy as np

from floorplan.compiled import compiled
from floorplan.model.checks import Array

SAME_M2 = 1e-10  # (0.01 mm)^2: a pair whose distance is this certain has been made one by other merges
CONCERNED = 0.25  # a pair whose variance falls below this part of what it was is settled by the choice at hand
NEGLIGIBLE_M = 1e-10  # a merge that moves a pair by less than this times its sigma leaves it as it is
BLOCK = 512  # pairs whose best score is kept together: fits the first-level cache
LOOSE = 1.25  # where a variance falls by more than this factor, the bound of its logarithm would be loose
ROUNDING = 1e-9  # log odds; keeps bounds above scores
NEVER = -np.inf  # score of a pair that can no longer be merged
LOG_TWO_PI = np.log(2 * np.pi)


class Live(NamedTuple):
    """Pairs by row (H,): components, distance, variance, prior log odds, score now, put off or not, row in the question.

    `odds` is at least the score: after a merge it is bounded without a logarithm, by `ln x <= x - 1` and `base`, which is at least
    the part of the score without the distance. Only what may matter is scored anew (`scored`). `top (blocks,)`: no pair of a block has
    higher odds, `open_top` the same of the pairs that are not put off; 0 at least.
    """

    first: Array
    second: Array
    delta: Array
    var: Array
    log_prior: Array
    base: Array
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
def scored(live: Live, h: int) -> float:
    """The score of pair h, noted in `odds`."""
    var = live.var[h]
    live.base[h] = live.log_prior[h] - 0.5 * (LOG_TWO_PI + np.log(var)) + ROUNDING
    odds = score(live.delta[h], var, live.log_prior[h])
    live.odds[h] = odds
    return odds


@compiled
def top_of_block(live: Live, block: int, count: int) -> None:
    """Highest odds of one block of the first `count` pairs."""
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
            if live.var[h] >= SAME_M2:
                scored(live, h)
            else:
                live.odds[h] = NEVER
    for block in range(len(live.top)):
        top_of_block(live, block, count)


@compiled
def best_pair(live: Live, count: int) -> int:
    """The pair of highest score among those not put off; -1 where none scores above zero."""
    best, found = 0.0, -1
    for block in range(len(live.open_top)):
        if live.open_top[block] > best:
            for h in range(block * BLOCK, min((block + 1) * BLOCK, count)):
                if live.odds[h] > best and not live.waiting[h] and scored(live, h) > best:
                    best, found = live.odds[h], h
            top_of_block(live, block, count)
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
            unused = max(spare[a] + spare[b] - np.sqrt(2.0 * (tracks[a] + tracks[b] - 2.0)), 0.0)
            if live.odds[h] + 0.5 * unused > best and scored(live, h) + 0.5 * unused > best:
                best, found = live.odds[h] + 0.5 * unused, h
    return found


@compiled
def condition(live: Live, count: int, unit: Array, pull: float, keep: int, gone: int, seat: Array) -> int:
    """Every pair after a merge with gain `unit` (covariance with the merged distance / its sigma) of component `gone` into `keep`.

    Gives back how many pairs ceased to be questions. `seat (planes,)` is scratch, -1 everywhere before and after.
    """
    ceased, noted = 0, np.empty(BLOCK, np.int64)
    first, second, delta, var, base, odds = live.first, live.second, live.delta, live.var, live.base, live.odds
    for block in range(len(live.top)):
        low, high = block * BLOCK, min((block + 1) * BLOCK, count)
        loose = _moved(first[low:high], second[low:high], delta[low:high], var[low:high], base[low:high], odds[low:high], unit, pull, noted)
        for k in range(loose):
            scored(live, low + noted[k])
        touched = _touched(first[low:high], second[low:high], keep, gone, noted)
        for k in range(touched):
            ceased += _renamed(live, low + noted[k], keep, gone, seat)
        top_of_block(live, block, count)
    seat[:] = -1
    return ceased


@compiled
def _moved(first: Array, second: Array, delta: Array, var: Array, base: Array, odds: Array, unit: Array, pull: float, loose: Array) -> int:
    """Distance, variance and odds of some pairs after a merge; into `loose` those whose bound would be, gives back how many."""
    found = 0
    for h in range(len(first)):
        part = unit[first[h]] - unit[second[h]]
        if abs(part) <= NEGLIGIBLE_M:
            continue
        before = var[h]
        after = max(before - part * part, 0.0)
        moved = delta[h] - part * pull
        delta[h], var[h] = moved, after
        if odds[h] == NEVER:
            continue
        if after < SAME_M2:
            odds[h] = NEVER
        elif before > LOOSE * after:
            loose[found] = h
            found += 1
        else:
            over = 1.0 / after
            base[h] += 0.5 * (before * over - 1.0)
            odds[h] = base[h] - 0.5 * moved * moved * over
    return found


@compiled
def _touched(first: Array, second: Array, keep: int, gone: int, touched: Array) -> int:
    """Into `touched` the pairs that ask about `keep` or `gone`; gives back how many."""
    found = 0
    for h in range(len(first)):
        a, b = first[h], second[h]
        if a in (keep, gone) or b in (keep, gone):
            touched[found] = h
            found += 1
    return found


@compiled
def _renamed(live: Live, h: int, keep: int, gone: int, seat: Array) -> int:
    """Let pair h speak of `keep` instead of `gone`; 1 where it ceases to be a question, else 0.

    Of two pairs that ask the same question the better prior counts (the smaller gap) and a bar of either stays.
    """
    a, b = live.first[h], live.second[h]
    if a == b:
        return 0
    a, b = keep if a == gone else a, keep if b == gone else b
    live.first[h], live.second[h] = a, b
    other = b if a == keep else a
    twin = seat[other]
    if a != b and twin < 0:
        seat[other] = h
        return 0
    if a != b:
        _unite(live, twin, h)
    live.second[h] = a
    live.odds[h] = NEVER
    return 1


@compiled
def _unite(live: Live, twin: int, other: int) -> None:
    """Let `twin` stand for `other` too."""
    live.waiting[twin] = live.waiting[twin] or live.waiting[other]
    live.log_prior[twin] = max(live.log_prior[twin], live.log_prior[other])
    if live.odds[other] == NEVER:
        live.odds[twin] = NEVER
    if live.odds[twin] > NEVER:
        odds, block = scored(live, twin), twin // BLOCK
        live.top[block], live.open_top[block] = max(live.top[block], odds), max(live.open_top[block], odds)


@compiled
def rivals(live: Live, count: int, unit: Array, pull: float, chosen: int, close: float, found: Array) -> int:
    """Pairs nearly as good as the chosen one that would be lost by merging it; strongest first into `found`, gives back how many."""
    floor, used = max(live.odds[chosen] - close, 0.0), 0
    first, second, var, odds = live.first, live.second, live.var, live.odds
    for block in range(len(live.top)):
        if live.top[block] <= floor:
            continue
        for h in range(block * BLOCK, min((block + 1) * BLOCK, count)):
            if odds[h] <= floor:
                continue
            part = unit[first[h]] - unit[second[h]]
            then = var[h] - part * part
            if then < SAME_M2 or then > CONCERNED * var[h] or h == chosen:
                continue  # not settled by the merge
            if score(live.delta[h] - part * pull, then, live.log_prior[h]) <= 0.0 and scored(live, h) > floor:
                used = _entered(odds, found, used, h)
    return used


@compiled
def _entered(odds: Array, found: Array, used: int, h: int) -> int:
    """Pair h in its place among the first `used` of `found`, strongest first; gives back how many there are then."""
    place = used
    while place > 0 and odds[found[place - 1]] < odds[h]:
        place -= 1
    if place < len(found):
        used = min(used + 1, len(found))
        found[place + 1 : used] = found[place : used - 1].copy()
        found[place] = h
    return used
