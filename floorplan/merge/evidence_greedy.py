"""Best-first merging with look-ahead: the order of the decisions is what keeps wrong merges out."""

from dataclasses import dataclass

import numpy as np

from floorplan.merge import evidence_kernels as kernels
from floorplan.merge.evidence_kernels import APART, DEFERRED
from floorplan.model.checks import Array

CLEAR = 5.0  # log odds, 150 to 1: a rival weaker by this much (three sigma off) does not make a choice ambiguous
MARGINS = (None, 3.0, 1.0)  # what the better future must lead by: first no rival at all, then 20 to 1, at last 3 to 1
RIVALS = 16  # futures compared with that of the best pair; fewer may all be of one wrong kind
DEPTH = 60  # merges looked ahead: more than one place of a building shows
PENDING = 64  # rank-one updates multiplied out together


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

    `open` pairs still waiting (positive score, put off); `log_evidence` sum of the scores of the merges made.
    """

    plane: Array
    delta_m: Array
    variance_m2: Array
    log_prior: Array
    open: Array
    log_evidence: float


def decide(question: Question, covariance: Array) -> Decision:
    """Merge best first; a choice that would lose a nearly equal rival waits, then is settled by looking ahead, or is left open."""
    work = _Work(question, covariance)
    level = 0
    while level < len(MARGINS):
        h = kernels.best_pair(work.delta, work.var, work.log_prior, work.barred, APART | DEFERRED, work.live)
        if h < 0:
            level = 0 if work.merged_since_review else level + 1
            if level < len(MARGINS):
                work.review()
            continue
        chosen = work.settle(h, MARGINS[level])
        if chosen >= 0:
            work.merge(chosen)
        else:
            work.barred[h] |= DEFERRED
    return work.decision()


class _Work:
    """The live pairs and the covariance, changed in place by every merge."""

    def __init__(self, question: Question, covariance: Array) -> None:
        self.first, self.second = question.first.astype(np.int64), question.second.astype(np.int64)
        self.delta, self.var = question.delta_m.copy(), question.variance_m2.copy()
        self.log_prior, self.barred = question.log_prior.copy(), np.where(question.apart, APART, 0)
        self.origin = np.arange(len(self.first))
        self.final_delta, self.final_var = self.delta.copy(), self.var.copy()
        self.final_prior = self.log_prior.copy()
        self.P = covariance.copy()
        self.U = np.zeros((PENDING + DEPTH + 2, len(covariance)))
        self.pending, self.live = 0, len(self.first)
        self.label = np.arange(len(covariance))
        self.seat = np.full(len(covariance), -1)
        self.cov = np.zeros(len(covariance))
        self.merged_since_review, self.log_evidence = False, 0.0

    def settle(self, h: int, margin: float | None) -> int:
        """The pair to merge now in place of `h`: itself, a rival with a clearly better future, or -1 to put the choice off."""
        unit, pull = self._unit(h)
        found = np.full(RIVALS, -1)
        count = kernels.rivals(
            self.first, self.second, self.delta, self.var, self.log_prior, self.barred, self.live, unit, pull, h, CLEAR, found
        )
        if count == 0:
            return h
        if margin is None:
            return -1
        options = [h, *(int(k) for k in found[:count])]
        concerned = self._concerned(h)
        futures = [self._future(k, concerned) for k in options]
        best = int(np.argmax(futures))
        against = [f for k, f in zip(options, futures, strict=True) if k != options[best] and self._excludes(options[best], k)]
        return options[best] if futures[best] - max(against, default=-np.inf) >= margin else -1

    def _excludes(self, chosen: int, other: int) -> bool:
        """Whether merging `chosen` turns `other` down."""
        unit, pull = self._unit(chosen)
        part = float(unit[self.first[other]] - unit[self.second[other]])
        var = max(float(self.var[other]) - part * part, kernels.SAME_M2)
        return bool(kernels.score(self.delta[other] - part * pull, var, self.log_prior[other]) <= 0.0)

    def merge(self, h: int) -> None:
        """Condition everything on pair h being one plane and join the two components."""
        self.log_evidence += kernels.score(self.delta[h], self.var[h], self.log_prior[h])
        unit, pull = self._unit(h)
        keep, gone, slot = int(self.first[h]), int(self.second[h]), self.origin[h]
        before = (self.delta[h], self.var[h])
        kernels.condition(self.first, self.second, self.delta, self.var, self.live, unit, pull)
        self.U[self.pending] = unit
        self.pending += 1
        self.live = kernels.relabel(
            self.first, self.second, self.delta, self.var, self.log_prior, self.barred, self.origin, self.final_delta,
            self.final_var, self.live, keep, gone, self.seat,
        )
        self.final_delta[slot], self.final_var[slot] = before
        self.label[self.label == gone] = keep
        self.merged_since_review = True
        if self.pending == PENDING:
            self.P -= self.U[:PENDING].T @ self.U[:PENDING]
            self.pending = 0

    def review(self) -> None:
        """Look again at what was put off."""
        self.barred[: self.live] &= ~DEFERRED
        self.merged_since_review = False

    def put_off(self) -> Array:
        """Mask of the live pairs that wait."""
        return np.asarray((self.barred[: self.live] & DEFERRED) > 0)

    def decision(self) -> Decision:
        live = slice(0, self.live)
        origin = self.origin[live]
        self.final_delta[origin], self.final_var[origin] = self.delta[live], self.var[live]
        self.final_prior[origin] = self.log_prior[live]
        waiting = np.zeros(len(self.final_delta), dtype=bool)
        waiting[origin] = self.put_off()
        return Decision(self.label, self.final_delta, self.final_var, self.final_prior, waiting, self.log_evidence)

    def _unit(self, h: int) -> tuple[Array, float]:
        sigma = np.sqrt(self.var[h])
        kernels.column(self.P, self.U, self.pending, self.first[h], self.second[h], self.cov)
        return self.cov / sigma, float(self.delta[h] / sigma)

    def _concerned(self, h: int) -> Array:
        """Mask of the live pairs that merging `h` would make clearly better known: futures are compared by these alone."""
        concerned = np.zeros(self.live, dtype=np.bool_)
        kernels.mark_concerned(self.first, self.second, self.var, self.live, self._unit(h)[0], concerned)
        return concerned

    def _future(self, h: int, concerned: Array) -> float:
        return float(
            kernels.roll_out(
                self.first, self.second, self.delta, self.var, self.log_prior, self.barred, concerned, self.live, self.P, self.U,
                self.pending, h, DEPTH,
            )
        )  # fmt: skip
