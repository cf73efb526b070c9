"""A primal-dual interior point for the reduced problem: L1 of differences inside one ellipsoid.

    minimise sum |z_first - z_second + start|   subject to   z^T S z <= 1   and   G z + excess <= 0

`S` is block diagonal over the axes and dense within one. With slacks and multipliers eliminated, a step costs one dense Cholesky
factor per axis of `E^T W E + lambda S` and a rank-one correction for the ellipsoid's curvature (Mehrotra's predictor and
corrector; S. Boyd, L. Vandenberghe, Convex Optimization, section 11.7).
"""

from collections.abc import Iterable, Iterator
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from floorplan.merge import pair_kernels
from floorplan.merge.hypotheses import Pairs
from floorplan.model.checks import Array
from floorplan.reduction import cholesky, cholesky_solve

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


@dataclass(frozen=True)
class BallProblem:
    """`information` blocks `S` over consecutive variables; `pairs` rows of `E` over all variables; `start (H,)` = `E` at the centre.

    `sign_rows (Q, V)` = `G`, `sign_excess (Q,)`. Lengths are in units of the ball's radius.
    """

    information: tuple[Array, ...]
    pairs: Pairs
    start: Array
    sign_rows: Array
    sign_excess: Array
    floor: float  # objective below which relative figures mean nothing

    @cached_property
    def block_pairs(self) -> list[slice]:
        """Which pairs lie in each block; pairs are sorted by block."""
        stops = np.searchsorted(self.pairs.first, [part.stop for part in self.blocks])
        return [slice(int(a), int(b)) for a, b in zip(np.concatenate(([0], stops[:-1])), stops, strict=True)]

    @cached_property
    def blocks(self) -> list[slice]:
        """Where each block's variables lie."""
        stops = np.cumsum([len(block) for block in self.information])
        return [slice(int(stop) - len(block), int(stop)) for stop, block in zip(stops, self.information, strict=True)]

    def pull(self, dual: Array) -> Array:
        """`E^T y` (V,)."""
        size = sum(len(block) for block in self.information)
        return np.asarray(pair_kernels.pull(self.pairs.first, self.pairs.second, dual, size))

    def gap(self, z: Array) -> Array:
        """`E z` (H,)."""
        return np.asarray(pair_kernels.differences(self.pairs.first, self.pairs.second, z))

    def metric(self, z: Array) -> Array:
        """`S z` (V,)."""
        return np.concatenate([block @ z[part] for block, part in zip(self.information, self.blocks, strict=True)])


@dataclass(frozen=True)
class BallOptimum:
    """`z (V,)`, `pair_dual (H,)`, `sign_dual (Q,)`, the relative `gap` reached and the number of `steps`."""

    z: Array
    pair_dual: Array
    sign_dual: Array
    gap: float
    steps: int


@dataclass(frozen=True)
class _Point:
    """Primal and dual variables, or a step of them.

    `z`; `bound` of |E z + start|; multipliers `upper`, `lower` of its two sides, `ball` of the ellipsoid, `sign` of G with `sign_slack`.
    """

    z: Array
    bound: Array
    upper: Array
    lower: Array
    ball: float
    sign: Array
    sign_slack: Array

    def moved(self, step: "_Point", length: float) -> "_Point":
        """The point `length` along a step."""
        return _Point(
            self.z + length * step.z,
            self.bound + length * step.bound,
            self.upper + length * step.upper,
            self.lower + length * step.lower,
            self.ball + length * step.ball,
            self.sign + length * step.sign,
            self.sign_slack + length * step.sign_slack,
        )


@dataclass(frozen=True)
class _Slacks:
    """What a point implies: `upper = bound - e`, `lower = bound + e` with `e = E z + start`, the ball's slack, `metric = S z`."""

    upper: Array
    lower: Array
    ball: float
    metric: Array


def minimise(problem: BallProblem) -> BallOptimum:
    """The optimum as far as it was reached; `gap` says how far, and the caller must judge it."""
    inverse = _Blocks.factor(problem, [block.copy() for block in problem.information])
    point = _first_point(problem, inverse)
    best = _optimum(problem, inverse, point, 0)
    for steps in range(1, MAX_STEPS + 1):
        try:
            newton = _Newton.at(problem, point, _slacks(problem, point))
        except np.linalg.LinAlgError:
            break  # weights beyond the arithmetic's range: `best` stands, and its gap is judged by the caller
        mean = _complementarity(point, newton.slacks)
        predicted = newton.solve(newton.targets(0.0, None))
        after = point.moved(predicted, newton.longest(predicted))
        left = max(_complementarity(after, _slacks(problem, after)), 0.0) / mean
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


def _corrected(newton: "_Newton", targets: _Point, centre: float) -> tuple[_Point, float]:
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
        slacks = _slacks(newton.problem, trial)
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


@dataclass(frozen=True)
class _Blocks:
    """Cholesky factors of a block diagonal matrix."""

    parts: list[slice]
    factors: list[Array]

    @staticmethod
    def factor(problem: BallProblem, matrices: Iterable[Array]) -> "_Blocks":
        """Factors of `matrices`, one per block of the problem; they are overwritten."""
        return _Blocks(problem.blocks, [cholesky(matrix, overwrite=True) for matrix in matrices])

    def solve(self, right: Array) -> Array:
        """The solution for `right (V,)`."""
        return np.concatenate([cholesky_solve(factor, right[part]) for part, factor in zip(self.parts, self.factors, strict=True)])


@dataclass(frozen=True)
class _Newton:
    """The linearised optimality conditions at one point, factored; `step` serves predictor and corrector."""

    problem: BallProblem
    point: _Point
    slacks: _Slacks
    factors: _Blocks
    metric_response: Array

    @staticmethod
    def at(problem: BallProblem, point: _Point, slacks: _Slacks) -> "_Newton":
        """Factor `E^T W E + lambda S + G^T (mu / slack) G`."""
        first, second = point.upper / slacks.upper, point.lower / slacks.lower
        matrices = _weighted(problem, 4 * first * second / (first + second), point.ball, point.sign / point.sign_slack)
        factors = _Blocks.factor(problem, matrices)
        return _Newton(problem, point, slacks, factors, factors.solve(slacks.metric))

    def targets(self, centre: float, predicted: _Point | None) -> _Point:
        """Right-hand sides of a step towards complementarity products of `centre`; `predicted` adds Mehrotra's second-order terms.

        `z` holds the dual residual, the multipliers' fields the changes wanted of their products.
        """
        problem, point, slacks = self.problem, self.point, self.slacks
        upper = centre - point.upper * slacks.upper
        lower = centre - point.lower * slacks.lower
        ball = centre - point.ball * slacks.ball
        sign = centre - point.sign * point.sign_slack
        dual = problem.pull(point.upper - point.lower) + point.ball * slacks.metric + problem.sign_rows.T @ point.sign
        if predicted is not None:
            gap = problem.gap(predicted.z)
            bent = problem.metric(predicted.z)
            upper = upper - predicted.upper * (predicted.bound - gap)
            lower = lower - predicted.lower * (predicted.bound + gap)
            ball += predicted.ball * float(slacks.metric @ predicted.z) + point.ball * float(predicted.z @ bent) / 2
            sign = sign - predicted.sign * predicted.sign_slack
            dual = dual + predicted.ball * bent
        return _Point(dual, point.bound, upper, lower, ball, sign, point.sign_slack)

    def longest(self, step: _Point) -> float:
        """How far `step` may go."""
        return _step_length(self.problem, self.point, self.slacks, step)

    def solve(self, target: _Point) -> _Point:
        """The step for given right-hand sides."""
        problem, point, slacks = self.problem, self.point, self.slacks
        first, second = point.upper / slacks.upper, point.lower / slacks.lower
        total, tilt = first + second, (first - second) / (first + second)
        pushed_up, pushed_down = target.upper / slacks.upper, target.lower / slacks.lower
        missing = point.upper + point.lower - 1 + pushed_up + pushed_down
        sign_residual = point.sign_slack + problem.sign_rows @ point.z + problem.sign_excess
        sign_push = (target.sign + point.sign * sign_residual) / point.sign_slack
        right = -target.z - problem.pull(pushed_up - pushed_down - tilt * missing) - problem.sign_rows.T @ sign_push
        z = self._with_ball(right - slacks.metric * (target.ball / slacks.ball))
        gap, turned = problem.gap(z), problem.sign_rows @ z
        bound = missing / total + tilt * gap
        return _Point(
            z=z,
            bound=bound,
            upper=pushed_up - first * (bound - gap),
            lower=pushed_down - second * (bound + gap),
            ball=(target.ball + point.ball * float(slacks.metric @ z)) / slacks.ball,
            sign=sign_push + point.sign / point.sign_slack * turned,
            sign_slack=-turned - sign_residual,
        )

    def _with_ball(self, right: Array) -> Array:
        """Sherman and Morrison: the ellipsoid's curvature is the rank-one `(lambda / slack) S z z^T S`."""
        plain, curvature = self.factors.solve(right), self.point.ball / self.slacks.ball
        metric, response = self.slacks.metric, self.metric_response
        return np.asarray(plain - response * (curvature * float(metric @ plain) / (1 + curvature * float(metric @ response))))


def _weighted(problem: BallProblem, pair_weight: Array, ball: float, sign_weight: Array) -> Iterator[Array]:
    """`E^T W E + lambda S + G^T M G` block by block; the lower triangles are what counts."""
    for part, block, rows in zip(problem.blocks, problem.information, problem.block_pairs, strict=True):
        matrix = ball * block
        pair_kernels.add_laplacian(problem.pairs.first[rows], problem.pairs.second[rows], pair_weight[rows], part.start, matrix)
        if len(sign_weight):
            signs = problem.sign_rows[:, part]
            matrix += signs.T @ (sign_weight[:, None] * signs)
        yield matrix


def _first_point(problem: BallProblem, inverse: _Blocks) -> _Point:
    """The centre of the ball, bounds a little above the gaps, multipliers in the middle."""
    size = np.abs(problem.start)
    half = np.full(len(size), 0.5)
    pull = problem.pull(np.sign(problem.start))
    ball = float(np.sqrt(max(float(pull @ inverse.solve(pull)), 0.0)))
    slack = np.maximum(-problem.sign_excess, START_SIGN_SLACK)
    width = START_WIDTH * (size.mean() if len(size) else 0.0) + START_WIDTH * START_SIGN_SLACK
    return _Point(np.zeros_like(pull), size + width, half, half, max(ball, START_SIGN_SLACK), np.ones(len(slack)), slack)


def _slacks(problem: BallProblem, point: _Point) -> _Slacks:
    gap, metric = problem.gap(point.z) + problem.start, problem.metric(point.z)
    return _Slacks(point.bound - gap, point.bound + gap, (1 - float(point.z @ metric)) / 2, metric)


def _complementarity(point: _Point, slacks: _Slacks) -> float:
    """Mean product of multiplier and slack."""
    total = float(point.upper @ slacks.upper + point.lower @ slacks.lower + point.sign @ point.sign_slack)
    return (total + point.ball * slacks.ball) / (2 * len(point.upper) + len(point.sign) + 1)


def _step_length(problem: BallProblem, point: _Point, slacks: _Slacks, step: _Point) -> float:
    """How far the step may go until a multiplier or a slack is used up."""
    gap = problem.gap(step.z)
    length = min(
        _to_zero(slacks.upper, step.bound - gap),
        _to_zero(slacks.lower, step.bound + gap),
        _to_zero(point.upper, step.upper),
        _to_zero(point.lower, step.lower),
        _to_zero(point.sign, step.sign),
        _to_zero(point.sign_slack, step.sign_slack),
        _to_zero(np.array([point.ball]), np.array([step.ball])),
    )
    # the ball: z^T S z + 2 t z^T S dz + t^2 dz^T S dz = 1
    square, linear = float(step.z @ problem.metric(step.z)), float(slacks.metric @ step.z)
    root = np.sqrt(max(linear**2 + 2 * slacks.ball * square, 0.0))
    return min(length, 2 * slacks.ball / (linear + root)) if linear + root > 0 else length


def _to_zero(value: Array, step: Array) -> float:
    """The largest t in (0, 1 / TO_THE_BOUNDARY] with `value + t step >= 0`."""
    return float(pair_kernels.to_zero(value, step, 1 / TO_THE_BOUNDARY))


def _optimum(problem: BallProblem, inverse: _Blocks, point: _Point, steps: int) -> BallOptimum:
    """The point as an answer, with its gap by weak duality: nothing of the iteration is believed."""
    pair_dual, sign_dual = np.clip(point.upper - point.lower, -1, 1), np.maximum(point.sign, 0)
    pull = problem.pull(pair_dual) + problem.sign_rows.T @ sign_dual
    bound = pair_dual @ problem.start + sign_dual @ problem.sign_excess - np.sqrt(max(float(pull @ inverse.solve(pull)), 0.0))
    objective = np.abs(problem.gap(point.z) + problem.start).sum()
    outside = np.maximum(problem.sign_rows @ point.z + problem.sign_excess, 0).sum()
    gap = (abs(objective - bound) + outside) / max(objective, problem.floor)
    return BallOptimum(point.z, pair_dual, sign_dual, float(gap), steps)
