"""Numba kernel that counts readings in bins on both sides of every line of a grid."""

import numpy as np

from floorplan.compiled import compiled
from floorplan.model.checks import Array


@compiled
def counted_within(across: Array, along: Array, lines: int, columns: int, half: Array) -> Array:
    """Readings (H, A, U) int32 at most `half (H,)` lines off each of A, by column; `across (N,)` their line, `along (N,)` column."""
    count = np.zeros((lines, columns), np.int32)
    for i in range(len(across)):
        count[across[i], along[i]] += 1
    total = np.zeros((len(half), lines, columns), np.int32)
    for k in range(len(half)):
        for a in range(min(half[k] + 1, lines)):
            for u in range(columns):
                total[k, 0, u] += count[a, u]
        for a in range(1, lines):
            enters, leaves = a + half[k], a - half[k] - 1
            for u in range(columns):
                value = total[k, a - 1, u]
                if enters < lines:
                    value += count[enters, u]
                if leaves >= 0:
                    value -= count[leaves, u]
                total[k, a, u] = value
    return total
