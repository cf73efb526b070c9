"""Newton steps of the interior point: one dense Cholesky factor per axis, and the ellipsoid's curvature as a rank-one correction."""

from collections.abc import Iterable, Iterator
from dataclasses import dataclass

import numpy as np

from floorplan.elimination.reduction import cholesky, cholesky_solve
from floorplan.merge import pair_kernels
from floorplan.merge.ball_problem import BallProblem, Point, Slacks, step_length
from floorplan.model.checks import Array


@dataclass(frozen=True)
class Blocks:
    """Cholesky factors of a block diagonal matrix."""

    parts: list[slice]
    factors: list[Array]

    @staticmethod
    def factor(problem: BallProblem, matrices: Iterable[Array]) -> "Blocks":
        """Factors of `matrices`, one per block of the problem; they are overwritten."""
        return Blocks(problem.blocks, [cholesky(matrix, overwrite=True) for matrix in matrices])

    def solve(self, right: Array) -> Array:
        """The solution for `right (V,)`."""
        return np.concatenate([cholesky_solve(factor, right[part]) for part, factor in zip(self.parts, self.factors, strict=True)])


@dataclass(frozen=True)
class Newton:
    """The linearised optimality conditions at one point, factored; `step` serves predictor and corrector."""

    problem: BallProblem
    point: Point
    slacks: Slacks
    factors: Blocks
    metric_response: Array

    @staticmethod
    def at(problem: BallProblem, point: Point, slacks: Slacks) -> "Newton":
        """Factor `E^T W E + lambda S + G^T (mu / slack) G`."""
        first, second = point.upper / slacks.upper, point.lower / slacks.lower
        matrices = _weighted(problem, 4 * first * second / (first + second), point.ball, point.sign / point.sign_slack)
        factors = Blocks.factor(problem, matrices)
        return Newton(problem, point, slacks, factors, factors.solve(slacks.metric))

    def targets(self, centre: float, predicted: Point | None) -> Point:
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
        return Point(dual, point.bound, upper, lower, ball, sign, point.sign_slack)

    def longest(self, step: Point) -> float:
        """How far `step` may go."""
        return step_length(self.problem, self.point, self.slacks, step)

    def solve(self, target: Point) -> Point:
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
        return Point(
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
    if problem.scale is not None:
        pair_weight = pair_weight * problem.scale**2
    for part, block, rows in zip(problem.blocks, problem.information, problem.block_pairs, strict=True):
        matrix = ball * block
        pair_kernels.add_laplacian(problem.pairs.first[rows], problem.pairs.second[rows], pair_weight[rows], part.start, matrix)
        if len(sign_weight):
            signs = problem.sign_rows[:, part]
            matrix += signs.T @ (sign_weight[:, None] * signs)
        yield matrix
