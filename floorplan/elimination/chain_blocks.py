"""Compiled sums of odometry rows into the blocks of a chain; the rows are those of `floorplan.elimination.odometry_chain`."""

from typing import NamedTuple

import numpy as np

from floorplan.compiled import compiled
from floorplan.model.checks import Array


class Blocks(NamedTuple):
    """The sums as `Chain` names them; `sums (2,)`: squares of the right-hand sides, log weights."""

    diagonal: Array
    coupling: Array
    rhs: Array
    dense: Array
    dense_information: Array
    dense_rhs: Array
    sums: Array


@compiled
def empty_blocks(count: int, states: int, width: int) -> Blocks:
    """Blocks of `count` frames without any row."""
    return Blocks(
        np.zeros((count, states, states)), np.zeros((max(count - 1, 0), states, states)), np.zeros((count, states)),
        np.zeros((count, states, width)), np.zeros((width, width)), np.zeros(width), np.zeros(2),
    )  # fmt: skip


@compiled
def joint_blocks(t: Array, felt: Array, white: Array, memory: Array, scale: float, sideways: float) -> Blocks:
    """Rows of every step: x, y (variance `white (N-1, 2)`), scale and sideways rate (E2, E3).

    `t (N-1, 2)` the steps, of which rates and global scale act on `felt (N-1, 2)`; `memory (N-1,)` of the rates, whose sizes are
    `scale` and `sideways`.
    """
    blocks = empty_blocks(len(t) + 1, 4, 1)
    here, width = np.zeros(4), blocks.dense_information
    for i in range(len(t)):
        for k in range(2):
            here[:] = 0.0
            here[k], here[2], here[3] = -1.0, -felt[i, k], felt[i, 1] if k == 0 else -felt[i, 0]
            weight, wide = 1.0 / white[i, k], -felt[i, k]
            pulled = weight * t[i, k]
            _add_step(blocks, i, k, here, weight, pulled)
            for j in range(4):
                blocks.dense[i, j, 0] += weight * here[j] * wide
            blocks.dense[i + 1, k, 0] += weight * wide
            blocks.dense_rhs[0] += pulled * wide
            width[0, 0] += weight * wide * wide
            blocks.sums[0] += pulled * t[i, k]
        for k in range(2):
            size = scale if k == 0 else sideways
            _add_memory(blocks, i, 2 + k, memory[i], 1.0 / ((1.0 - memory[i] ** 2) * size**2))
    return blocks


@compiled
def upright_blocks(step: Array, length: Array, white: Array, memory: Array, slope: float) -> Blocks:
    """Rows of every step along z (variance `white (N-1,)`), of which the slope, of size `slope`, acts on its `length (N-1,)`."""
    blocks, here = empty_blocks(len(step) + 1, 2, 0), np.zeros(2)
    for i in range(len(step)):
        here[0], here[1] = -1.0, -length[i]
        weight = 1.0 / white[i]
        _add_step(blocks, i, 0, here, weight, weight * step[i])
        blocks.sums[0] += weight * step[i] ** 2
        _add_memory(blocks, i, 1, memory[i], 1.0 / (slope**2 * (1.0 - memory[i] ** 2)))
    return blocks


@compiled
def _add_step(blocks: Blocks, i: int, k: int, here: Array, weight: float, pulled: float) -> None:
    """The row `here x_i + x_{i+1}[k]` with its right-hand side times its weight."""
    for j in range(len(here)):
        blocks.rhs[i, j] += pulled * here[j]
        blocks.coupling[i, k, j] += weight * here[j]
        for r in range(len(here)):
            blocks.diagonal[i, j, r] += weight * here[j] * here[r]
    blocks.rhs[i + 1, k] += pulled
    blocks.diagonal[i + 1, k, k] += weight
    blocks.sums[1] += np.log(weight)


@compiled
def _add_memory(blocks: Blocks, i: int, k: int, memory: float, weight: float) -> None:
    """The row `x_{i+1}[k] - memory x_i[k] = 0`."""
    blocks.diagonal[i, k, k] += weight * memory * memory
    blocks.diagonal[i + 1, k, k] += weight
    blocks.coupling[i, k, k] -= weight * memory
    blocks.sums[1] += np.log(weight)
