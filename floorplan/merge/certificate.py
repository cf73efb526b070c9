"""Our own check of an answer to the published problem: a solver's status is never believed.

For any `y` in [-1, 1] and `mu >= 0`, with `g = E^T y + D^T mu` and `rho` the slack of the ball, weak duality gives

    ||E xi||_1  >=  g^T xi_lin - rho sqrt(g^T (A^T A)^-1 g)

for every feasible `xi`; an answer whose objective meets that bound is optimal, whoever found it.
"""

from dataclasses import dataclass

import numpy as np

from floorplan.errors import NoSolutionError
from floorplan.merge.paper_problem import PaperAnswer, PaperProblem, pair_pull
from floorplan.model.checks import Array
from floorplan.rows import AXES, AxisSolution, split, sums_by
from floorplan.signs import SIGN_TOLERANCE_M

GAP_TOLERANCE = 1e-5  # relative gap between objective and bound: threshold decisions are stable at a tenth of this
GAP_FLOOR_M = 1e-6  # an objective below this is zero: relative figures mean nothing
BALL_TOLERANCE = 1e-6  # relative excess of the residual over delta


@dataclass(frozen=True)
class Certificate:
    """What our checks found: `objective_m`, lower `bound_m`, `residual_m`, `delta_m`, largest `D xi` in metres."""

    objective_m: float
    bound_m: float
    residual_m: float
    delta_m: float
    sign_excess_m: float

    @property
    def gap(self) -> float:
        """Relative duality gap; its absolute value is taken because the ball may be exceeded by a hair."""
        return abs(self.objective_m - self.bound_m) / max(self.objective_m, GAP_FLOOR_M)

    def faults(self) -> list[str]:
        """What is wrong with the answer, in words; empty when it is optimal."""
        faults = []
        if not np.isfinite([self.objective_m, self.bound_m, self.residual_m, self.sign_excess_m]).all():
            faults.append("it is not finite")
        if self.residual_m > self.delta_m * (1 + BALL_TOLERANCE) + BALL_TOLERANCE * GAP_FLOOR_M:
            faults.append(f"its residual {self.residual_m:.6g} m exceeds the ball's {self.delta_m:.6g} m")
        if self.sign_excess_m > 2 * SIGN_TOLERANCE_M:
            faults.append(f"a plane lies {self.sign_excess_m:.3g} m on the wrong side of a sensor that saw it")
        if self.objective_m - self.bound_m > GAP_FLOOR_M and self.gap > GAP_TOLERANCE:
            faults.append(f"its objective {self.objective_m:.6g} m is not the optimum: the bound is {self.bound_m:.6g} m")
        return faults


def certify(problem: PaperProblem, answer: PaperAnswer) -> Certificate:
    """Objective, bound, residual and signs of an answer, all computed from the graph."""
    excess = problem.sign_excess_m(answer.position_m, answer.track_offset_m)
    return Certificate(
        objective_m=problem.objective(answer.track_offset_m),
        bound_m=dual_bound(problem, answer.pair_dual, answer.sign_dual),
        residual_m=problem.residual(answer.position_m, answer.track_offset_m),
        delta_m=problem.delta_m,
        sign_excess_m=float(excess.max(initial=-np.inf)) if len(excess) else 0.0,
    )


def verified(problem: PaperProblem, answer: PaperAnswer, engine: str, advice: str) -> Certificate:
    """The certificate of an answer that passes every check. Raises NoSolutionError with `advice` otherwise."""
    certificate = certify(problem, answer)
    faults = certificate.faults()
    if faults:
        raise NoSolutionError(f"the answer of merge.engine = '{engine}' does not check out: {'; '.join(faults)}. {advice}")
    return certificate


def dual_bound(problem: PaperProblem, pair_dual: Array, sign_dual: Array) -> float:
    """The lower bound of the module's docstring, metres; the duals are clipped into their domains first."""
    pair_dual, sign_dual = np.clip(pair_dual, -1, 1), np.maximum(sign_dual, 0)
    linear, squared = 0.0, 0.0
    for axis in AXES:
        pull = _pull(problem, pair_dual, sign_dual, axis)
        moved = problem.reduced[axis].solve(pull)
        part = split(problem.graph, axis)
        linear += float(pull.offset_m @ problem.least_squares.track_offset_m[part.track])
        linear += float(pull.position_m @ problem.least_squares.position_m[:, axis])
        squared += float(pull.offset_m @ moved.offset_m + pull.position_m @ moved.position_m)
    return linear - problem.slack_m * float(np.sqrt(max(squared, 0.0)))


def _pull(problem: PaperProblem, pair_dual: Array, sign_dual: Array, axis: int) -> AxisSolution:
    """`g = E^T y + D^T mu` on one axis: frames (N,), zero at the gauge, and planes (V,)."""
    graph, part = problem.graph, split(problem.graph, axis)
    force = sign_dual[part.row] * graph.facing[graph.track[part.row]]
    on_track = sums_by(graph.track[part.row], force, len(graph.axis))[part.track]
    on_frame = -sums_by(graph.frame[part.row], force, len(graph.stamp_s))
    on_frame[0] = 0.0
    return AxisSolution(on_frame, pair_pull(problem, pair_dual, axis) + on_track)
