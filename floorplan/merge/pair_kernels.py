"""Compiled loops over the rows of `E`: each is one pass over all hypotheses."""

import numpy as np

from floorplan.compiled import compiled
from floorplan.model.checks import Array


@compiled
def differences(first: Array, second: Array, z: Array) -> Array:
    """`E z` (H,)."""
    gap = np.empty(len(first))
    for h in range(len(first)):
        gap[h] = z[first[h]] - z[second[h]]
    return gap


@compiled
def pull(first: Array, second: Array, dual: Array, size: int) -> Array:
    """`E^T y` (size,)."""
    total = np.zeros(size)
    for h in range(len(first)):
        total[first[h]] += dual[h]
        total[second[h]] -= dual[h]
    return total


@compiled
def add_laplacian(first: Array, second: Array, weight: Array, start: int, matrix: Array) -> None:
    """`matrix += E^T W E` (lower triangle), for variables from `start` and pairs with `first < second`."""
    for h in range(len(first)):
        a, b = first[h] - start, second[h] - start
        matrix[a, a] += weight[h]
        matrix[b, b] += weight[h]
        matrix[b, a] -= weight[h]


@compiled
def to_zero(value: Array, step: Array, most: float) -> float:
    """The largest t up to `most` with `value + t step >= 0`."""
    length = most
    for k in range(len(value)):
        if value[k] + length * step[k] < 0:
            length = -value[k] / step[k]
    return length
