"""The reduced problem as a value: L1 of differences inside one ellipsoid, and what is known of a point in it."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from floorplan.merge import pair_kernels
from floorplan.merge.hypotheses import Pairs
from floorplan.model.checks import Array

TO_THE_BOUNDARY = 0.995  # share of the way to the nearest bound that a step may go


@dataclass(frozen=True)
class BallProblem:
    """`information` blocks `S` over consecutive variables; `pairs` rows of `E` over all variables; `start (H,)` = `E` at the centre.

    `sign_rows (Q, V)` = `G`, `sign_excess (Q,)`. Lengths are in units of the ball's radius. `scale (H,)` times which every row of `E`
    counts, None: once; `start` has it in it.
    """

    information: tuple[Array, ...]
    pairs: Pairs
    start: Array
    sign_rows: Array
    sign_excess: Array
    floor: float  # objective below which relative figures mean nothing
    scale: Array | None = None

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
        if self.scale is not None:
            dual = dual * self.scale
        return np.asarray(pair_kernels.pull(self.pairs.first, self.pairs.second, dual, size))

    def gap(self, z: Array) -> Array:
        """`E z` (H,)."""
        gap = pair_kernels.differences(self.pairs.first, self.pairs.second, z)
        return np.asarray(gap if self.scale is None else gap * self.scale)

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
class Point:
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

    def moved(self, step: "Point", length: float) -> "Point":
        """The point `length` along a step."""
        return Point(
            self.z + length * step.z,
            self.bound + length * step.bound,
            self.upper + length * step.upper,
            self.lower + length * step.lower,
            self.ball + length * step.ball,
            self.sign + length * step.sign,
            self.sign_slack + length * step.sign_slack,
        )


@dataclass(frozen=True)
class Slacks:
    """What a point implies: `upper = bound - e`, `lower = bound + e` with `e = E z + start`, the ball's slack, `metric = S z`."""

    upper: Array
    lower: Array
    ball: float
    metric: Array


def slacks_of(problem: BallProblem, point: Point) -> Slacks:
    gap, metric = problem.gap(point.z) + problem.start, problem.metric(point.z)
    return Slacks(point.bound - gap, point.bound + gap, (1 - float(point.z @ metric)) / 2, metric)


def step_length(problem: BallProblem, point: Point, slacks: Slacks, step: Point) -> float:
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
