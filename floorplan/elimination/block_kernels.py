"""Compiled Cholesky of one small block and solving with it."""

import numpy as np

from floorplan.compiled import compiled
from floorplan.model.checks import Array


@compiled
def factor_block(block: Array, lower: Array) -> float:
    """Cholesky of one n x n block into `lower`; gives back log det, or NaN where the block is not positive definite."""
    n = block.shape[0]
    log_det = 0.0
    for i in range(n):
        for j in range(i + 1):
            value = block[i, j]
            for k in range(j):
                value -= lower[i, k] * lower[j, k]
            if i != j:
                lower[i, j] = value / lower[j, j]
            elif value <= 0.0:
                return np.nan
            else:
                lower[i, i] = np.sqrt(value)
                log_det += np.log(value)
    return log_det


@compiled
def forward_block(lower: Array, vector: Array) -> None:
    """vector <- L^-1 vector."""
    for i in range(vector.shape[0]):
        value = vector[i]
        for k in range(i):
            value -= lower[i, k] * vector[k]
        vector[i] = value / lower[i, i]


@compiled
def backward_block(lower: Array, vector: Array) -> None:
    """vector <- L^-T vector."""
    n = vector.shape[0]
    for i in range(n - 1, -1, -1):
        value = vector[i]
        for k in range(i + 1, n):
            value -= lower[k, i] * vector[k]
        vector[i] = value / lower[i, i]
