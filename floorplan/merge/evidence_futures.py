"""Compiled look-ahead of the evidence merge: what follows from each of several choices, and which of them is the better story."""

from typing import NamedTuple

import numpy as np

from floorplan.compiled import compiled
from floorplan.merge.evidence_covariance import Joint, column
from floorplan.merge.evidence_live import CONCERNED, NEVER, SAME_M2, Live, score
from floorplan.model.checks import Array

SAME_STORY = 1e-6  # log odds; the same merges in another order are one story, told apart by rounding alone
DEPTH = 60  # merges looked ahead: more than one place of a building shows


class _Scene(NamedTuple):
    """The pairs concerned by a choice, between the components they join: only these take part in its futures.

    Pairs as in `Live`; `planes (C',)` rows of the covariance; `U (r + DEPTH + 1, C')` waiting updates of those.
    """

    first: Array
    second: Array
    delta: Array
    var: Array
    log_prior: Array
    planes: Array
    U: Array


@compiled
def better_future(live: Live, count: int, joint: Joint, r: int, unit: Array, options: Array, margin: float) -> int:
    """The option whose future leads those it excludes by `margin`, or -1; `unit` is the gain of the first option.

    Futures are summed over the same pairs, those that merging the first option would make clearly better known: a leap at
    another open question would drown the comparison.
    """
    concerned = _concerned(live, count, unit)
    scene = _scene(live, concerned, joint, r)
    futures = np.empty(len(options))
    for k in range(len(options)):
        futures[k] = _roll_out(scene, joint.P, r, np.searchsorted(concerned, options[k]))
    best = np.argmax(futures >= futures.max() - SAME_STORY)  # the first of them: the strongest pair
    cov, chosen, against = np.empty(len(joint.P)), options[best], -np.inf
    column(joint.P, joint.U, r, live.first[chosen], live.second[chosen], cov)
    for k in range(len(options)):
        if k != best and futures[k] > against and _excluded(live, options[k], cov, chosen):
            against = futures[k]
    return chosen if futures[best] - against >= margin else -1


@compiled
def _excluded(live: Live, h: int, cov: Array, chosen: int) -> bool:
    """Whether merging `chosen` turns pair h down."""
    part = (cov[live.first[h]] - cov[live.second[h]]) / live.var[chosen]
    var = max(live.var[h] - part * part * live.var[chosen], SAME_M2)
    return score(live.delta[h] - part * live.delta[chosen], var, live.log_prior[h]) <= 0.0


@compiled
def _concerned(live: Live, count: int, unit: Array) -> Array:
    """Rows of the pairs that a merge with gain `unit` would make clearly better known."""
    found, used = np.empty(count, np.int64), 0
    for h in range(count):
        part = unit[live.first[h]] - unit[live.second[h]]
        if live.odds[h] > NEVER and part * part >= (1.0 - CONCERNED) * live.var[h]:
            found[used] = h
            used += 1
    return found[:used]


@compiled
def _scene(live: Live, concerned: Array, joint: Joint, r: int) -> _Scene:
    place = np.full(len(joint.P), -1)
    for h in concerned:
        place[live.first[h]] = place[live.second[h]] = 0
    planes = np.flatnonzero(place == 0)
    place[planes] = np.arange(len(planes))
    U = np.empty((r + DEPTH + 1, len(planes)))
    for k in range(r):
        for i in range(len(planes)):
            U[k, i] = joint.U[k, planes[i]]
    first, second = place[live.first[concerned]], place[live.second[concerned]]
    return _Scene(first, second, live.delta[concerned], live.var[concerned], live.log_prior[concerned], planes, U)


@compiled
def _roll_out(scene: _Scene, P: Array, r: int, chosen: int) -> float:
    """Summed score of merging `chosen` and then greedily up to DEPTH more pairs: the log evidence of that future.

    A pair counts only once this future has made it better known. What is written into `U` beyond r is not meant to stay.
    """
    delta, var, U = scene.delta.copy(), scene.var.copy(), scene.U
    total, h = 0.0, chosen
    for step in range(r, r + DEPTH + 1):
        total += score(delta[h], var[h], scene.log_prior[h])
        sigma, pull = np.sqrt(var[h]), delta[h] / np.sqrt(var[h])
        _gain(scene, P, step, h, sigma)
        best, h = 0.0, -1
        for k in range(len(delta)):
            part = U[step, scene.first[k]] - U[step, scene.second[k]]
            delta[k] -= part * pull
            var[k] = max(var[k] - part * part, 0.0)
            if var[k] < SAME_M2 or var[k] > CONCERNED * scene.var[k]:
                continue
            value = score(delta[k], var[k], scene.log_prior[k])
            if value > best:
                best, h = value, k
        if h < 0:
            break
    return total


@compiled
def _gain(scene: _Scene, P: Array, step: int, h: int, sigma: float) -> None:
    """Row `step` of `U`: the gain of merging pair h."""
    a, b, U, planes = scene.first[h], scene.second[h], scene.U, scene.planes
    pa, pb = P[planes[a]], P[planes[b]]
    for i in range(len(planes)):
        U[step, i] = pa[planes[i]] - pb[planes[i]]
    for k in range(step):
        part = U[k, a] - U[k, b]
        if part != 0.0:
            for i in range(len(planes)):
                U[step, i] -= U[k, i] * part
    for i in range(len(planes)):
        U[step, i] /= sigma
