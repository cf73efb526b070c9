"""A second way to the planes of a system: L1 of distances over their sigmas in the joint covariance's 95 % ball, then chi-square."""

import numpy as np
from scipy.special import chdtri

from floorplan.compiled import compiled
from floorplan.merge.ball_problem import BallProblem
from floorplan.merge.evidence_greedy import Question
from floorplan.merge.evidence_live import SAME_M2, score
from floorplan.merge.hypotheses import Pairs
from floorplan.merge.interior_point import minimise
from floorplan.model.checks import Array

WITHIN = 0.95  # of the ball
CHI_SQUARE = 9.0  # three sigma, given the merges before
OBJECTIVE_FLOOR = 1e-6  # sigmas: less is zero


def l1_planes(question: Question, offset_m: Array, covariance_m2: Array, W: Array) -> Array:
    """Labels (T,): pairs in the order of the distances that the L1 problem leaves, merged while chi-square and prior allow.

    `W` is the inverse of the covariance.
    """
    asked = np.flatnonzero(~question.apart & (question.variance_m2 > SAME_M2))
    if not len(asked):
        return np.arange(len(offset_m))
    radius = float(np.sqrt(chdtri(len(offset_m), 1.0 - WITHIN)))
    asked = asked[np.argsort(question.first[asked], kind="stable")]
    pairs, scale = Pairs(question.first[asked], question.second[asked]), question.variance_m2[asked] ** -0.5
    start = scale * pairs.gap_m(offset_m) / radius
    nothing = np.zeros(0)
    ball = BallProblem((W,), pairs, start, np.zeros((0, len(W))), nothing, OBJECTIVE_FLOOR / radius, scale)
    left = np.abs(pairs.gap_m(offset_m + radius * minimise(ball).z))
    order = asked[np.argsort(left, kind="stable")]
    apart = np.flatnonzero(question.apart)
    bars = np.zeros(covariance_m2.shape, dtype=np.bool_)
    bars[question.first[apart], question.second[apart]] = bars[question.second[apart], question.first[apart]] = True
    return _merged(question.first[order], question.second[order], question.log_prior[order], offset_m.copy(), covariance_m2.copy(), bars)


@compiled
def _merged(first: Array, second: Array, log_prior: Array, offset: Array, P: Array, bars: Array) -> Array:
    """Merge pairs in the order given, each where it is likelier than not given those before; `offset`, `P`, `bars` are overwritten."""
    count = len(offset)
    label = np.arange(count)
    for h in range(len(first)):
        a, b = label[first[h]], label[second[h]]
        if a == b or bars[a, b]:
            continue
        variance, distance = P[a, a] + P[b, b] - 2 * P[a, b], offset[a] - offset[b]
        if variance < SAME_M2 or distance * distance > CHI_SQUARE * variance or score(distance, variance, log_prior[h]) <= 0:
            continue
        gain = (P[a] - P[b]) / np.sqrt(variance)
        for i in range(count):
            offset[i] -= gain[i] * distance / np.sqrt(variance)
            for k in range(count):
                P[i, k] -= gain[i] * gain[k]
        for i in range(count):
            bars[a, i] |= bars[b, i]
            bars[i, a] = bars[a, i]
            if label[i] == b:
                label[i] = a
    return label
