"""A primal-dual interior point for the reduced problem: L1 of differences inside one ellipsoid.

    minimise sum |z_first - z_second + start|   subject to   z^T S z <= 1   and   G z + excess <= 0

`S` is block diagonal over the axes and dense within one. With slacks and multipliers eliminated, a step costs one dense Cholesky
factor per axis of `E^T W E + lambda S` and a rank-one correction for the ellipsoid's curvature (Mehrotra's predictor and
corrector; S. Boyd, L. Vandenberghe, Convex Optimization, section 11.7).
"""

from dataclasses import replace

import numpy as np

from floorplan.merge.ball_newton import Blocks, Newton
from floorplan.merge.ball_problem import BallOptimum, BallProblem, Point, Slacks, slacks_of
from floorplan.model.checks import Array

MAX_STEPS = 100  # 15 to 35 are usual
TARGET_GAP = 1e-8  # relative; the answer is good at 1e-5, but the last two steps settle the planes to microns
TO_THE_BOUNDARY = 0.995  # share of the way to the nearest bound that a step may go
START_WIDTH = 0.1  # first slack of |E z|, relative to the mean gap
START_SIGN_SLACK = 1e-3  # first slack of a violated sign row, in radii of the ball
CENTRING_POWER = 3  # Mehrotra's choice
WORTH_CHECKING = 1e-4  # relative complementarity above which the gap cannot have closed within a step
MAX_CORRECTORS = 2
LONGER_BY = 0.3  # how much further a corrector tries to get
WORTH_KEEPING = 0.1  # share of that which it must win
NARROW = 0.1  # products between a tenth of and ten times the centre are left alone
PATIENCE_STEPS = 8  # steps without a better gap: arithmetic has nothing more to give


def minimise(problem: BallProblem) -> BallOptimum:
    """The optimum as far as it was reached; `gap` says how far, and the caller must judge it."""
    inverse = Blocks.factor(problem, [block.copy() for block in problem.information])
    point = _first_point(problem, inverse)
    best = _optimum(problem, inverse, point, 0)
    for steps in range(1, MAX_STEPS + 1):
        try:
            newton = Newton.at(problem, point, slacks_of(problem, point))
        except np.linalg.LinAlgError:
            break  # weights beyond the arithmetic's range: `best` stands, and its gap is judged by the caller
        mean = _complementarity(point, newton.slacks)
        predicted = newton.solve(newton.targets(0.0, None))
        after = point.moved(predicted, newton.longest(predicted))
        left = max(_complementarity(after, slacks_of(problem, after)), 0.0) / mean
        centre = mean * min(1.0, left) ** CENTRING_POWER
        step, length = _corrected(newton, newton.targets(centre, predicted), centre)
        point = point.moved(step, min(1.0, TO_THE_BOUNDARY * length))
        if mean > WORTH_CHECKING * np.sum(point.bound) / len(point.bound):
            continue
        candidate = _optimum(problem, inverse, point, steps)
        if candidate.gap < best.gap:
            best = candidate
        if best.gap < TARGET_GAP or steps - best.steps > PATIENCE_STEPS or not np.isfinite(candidate.gap):
            break
    return best


def _corrected(newton: "Newton", targets: Point, centre: float) -> tuple[Point, float]:
    """The step for `targets` and its length, lengthened by centrality correctors while they pay (J. Gondzio, 1996).

    Each pulls products that a longer step would leave far off `centre` back towards it, at the price of a solve with the
    factors at hand.
    """
    step = newton.solve(targets)
    length = newton.longest(step)
    for _ in range(MAX_CORRECTORS):
        if length >= 1.0:
            break
        trial = newton.point.moved(step, min(1.0, length + LONGER_BY))
        slacks = slacks_of(newton.problem, trial)
        new_targets = replace(
            targets,
            upper=targets.upper + _pull_back(trial.upper * slacks.upper, centre),
            lower=targets.lower + _pull_back(trial.lower * slacks.lower, centre),
            sign=targets.sign + _pull_back(trial.sign * trial.sign_slack, centre),
        )
        candidate = newton.solve(new_targets)
        reached = newton.longest(candidate)
        if reached < length + LONGER_BY * WORTH_KEEPING:
            break
        step, length, targets = candidate, reached, new_targets
    return step, length


def _pull_back(product: Array, centre: float) -> Array:
    """What brings products into a band about `centre`, itself bounded."""
    return np.asarray(np.maximum(np.clip(product, centre * NARROW, centre / NARROW) - product, -centre / NARROW))


def _first_point(problem: BallProblem, inverse: Blocks) -> Point:
    """The centre of the ball, bounds a little above the gaps, multipliers in the middle."""
    size = np.abs(problem.start)
    half = np.full(len(size), 0.5)
    pull = problem.pull(np.sign(problem.start))
    ball = float(np.sqrt(max(float(pull @ inverse.solve(pull)), 0.0)))
    slack = np.maximum(-problem.sign_excess, START_SIGN_SLACK)
    width = START_WIDTH * (size.mean() if len(size) else 0.0) + START_WIDTH * START_SIGN_SLACK
    return Point(np.zeros_like(pull), size + width, half, half, max(ball, START_SIGN_SLACK), np.ones(len(slack)), slack)


def _complementarity(point: Point, slacks: Slacks) -> float:
    """Mean product of multiplier and slack."""
    total = float(point.upper @ slacks.upper + point.lower @ slacks.lower + point.sign @ point.sign_slack)
    return (total + point.ball * slacks.ball) / (2 * len(point.upper) + len(point.sign) + 1)


def _optimum(problem: BallProblem, inverse: Blocks, point: Point, steps: int) -> BallOptimum:
    """The point as an answer, with its gap by weak duality: nothing of the iteration is believed."""
    pair_dual, sign_dual = np.clip(point.upper - point.lower, -1, 1), np.maximum(point.sign, 0)
    pull = problem.pull(pair_dual) + problem.sign_rows.T @ sign_dual
    bound = pair_dual @ problem.start + sign_dual @ problem.sign_excess - np.sqrt(max(float(pull @ inverse.solve(pull)), 0.0))
    objective = np.abs(problem.gap(point.z) + problem.start).sum()
    outside = np.maximum(problem.sign_rows @ point.z + problem.sign_excess, 0).sum()
    gap = (abs(objective - bound) + outside) / max(objective, problem.floor)
    return BallOptimum(point.z, pair_dual, sign_dual, float(gap), steps)
