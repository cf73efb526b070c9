"""Two candidates for the planes, the winner chosen axis by axis by evidence: best first, and L1 with chi-square (`l1_candidate.py`).

The second is asked where the search was in doubt; where every merge was clear another order ends in the same planes.
"""

from dataclasses import dataclass

import numpy as np
from scipy.linalg import cho_factor, cho_solve

from floorplan.merge.evidence_greedy import Decision, Question
from floorplan.merge.evidence_moves import LEAST_GAIN, Moved, changed, move_tracks
from floorplan.merge.l1_candidate import l1_planes
from floorplan.merge.plane_fit import PlaneFit
from floorplan.merge.plane_links import NO_TRACK, Links, likeliest_tree, links_of
from floorplan.model.checks import Array
from floorplan.model.plane_moves import AxisChoice, PlaneMove

DOUBTFUL = 2.0  # log odds, 7 to 1: a merge made for less, or a choice left open
MOST_TRACKS = 2000  # of one system: a trial costs the planes squared, a move their cube: past a kilometre more than the whole search
BY_CHOOSING = 2.0 / np.pi  # of a track's variance is between the halves of a normal distribution cut at its mean


@dataclass(frozen=True)
class Chosen:
    """The planes that won, with the moves that led to them; `choices` per axis, `outvoted (H,)` pairs that only the loser joins."""

    decision: Decision
    moves: tuple[PlaneMove, ...]
    choices: tuple[AxisChoice, ...]
    outvoted: Array


@dataclass(frozen=True)
class _Contest:
    """What both candidates are judged by: the tracks of one system, their pairs, the decision of the best-first search."""

    question: Question
    decision: Decision
    offset_m: Array
    W: Array
    axis: Array
    links: Links

    def moved(self, plane: Array) -> Moved:
        """The planes `plane (T,)` after their moves."""
        return move_tracks(self.question, self.decision, plane, self.offset_m, self.W)

    def log_evidence(self, fit: PlaneFit) -> float:
        """Of a partition: distances inside its planes, and the likeliest tree of each (E14)."""
        inside, trees = np.zeros(len(self.axis), dtype=np.bool_), 0.0
        for plane in range(len(fit.plane_m)):
            trees += likeliest_tree(self.links, np.flatnonzero(fit.label == plane), inside, NO_TRACK).total
        return fit.log_evidence + 0.5 * float(np.linalg.slogdet(self.W)[1]) + trees

    def compared(self, axis: int, first: PlaneFit, second: PlaneFit) -> AxisChoice:
        """The candidates on one axis: taken is the second where it leads by LEAST_GAIN.

        With more planes it must also fit better by more than it would if it had only sent the tracks of one plane to the nearer of two.
        """
        mine = self.axis == axis
        more = len(np.unique(second.label[mine])) > len(np.unique(first.label[mine]))
        by_choosing = BY_CHOOSING * float(changed(first.label, second.label)[mine].sum()) if more else 0.0
        lead, less = (self.log_evidence(first), self.log_evidence(second)), first.chi_square - second.chi_square
        taken = lead[1] - lead[0] > LEAST_GAIN and (less > by_choosing or not more)
        return AxisChoice(axis, *lead, less, by_choosing, taken)


def choose_planes(question: Question, decision: Decision, offset_m: Array, covariance_m2: Array, axis: Array, second: bool) -> Chosen:
    """`decision` after its moves, or where `second` allows and their evidence is larger, with the second candidate's planes of an axis.

    `axis (T,)` of the tracks at `offset_m (T,)` with joint covariance `covariance_m2 (T, T)`. Past `MOST_TRACKS` the decision stands.
    """
    if len(offset_m) > MOST_TRACKS:
        return Chosen(decision, (), (), np.zeros(len(question.first), dtype=np.bool_))
    W = cho_solve(cho_factor(covariance_m2, lower=True), np.eye(len(offset_m)), overwrite_b=True)
    contest = _Contest(question, decision, offset_m, W, axis, links_of(question, len(offset_m)))
    best, choices = contest.moved(decision.plane), list[AxisChoice]()
    if second and _in_doubt(decision):
        other = l1_planes(question, offset_m, covariance_m2, W) + len(offset_m)
        for one in np.unique(axis).tolist():
            rival = contest.moved(np.where(axis == one, other, best.decision.plane))
            if (rival.fit.label == best.fit.label).all():
                continue
            choices.append(contest.compared(one, best.fit, rival.fit))
            best = rival if choices[-1].taken else best
    return Chosen(best.decision, best.moves, tuple(choices), _outvoted(contest, best.decision.plane, choices))


def _in_doubt(decision: Decision) -> bool:
    return bool(decision.open.any() or (decision.made_odds < DOUBTFUL).any())


def _outvoted(contest: _Contest, after: Array, choices: list[AxisChoice]) -> Array:
    first, second, before = contest.question.first, contest.question.second, contest.decision.plane
    won = np.isin(contest.axis, [choice.axis for choice in choices if choice.taken])
    return np.asarray(won[first] & (before[first] == before[second]) & (after[first] != after[second]))
