"""Compiled kernels on the joint covariance of the components while they are merged."""

from typing import NamedTuple

import numpy as np

from floorplan.compiled import compiled
from floorplan.model.checks import Array

PENDING = 64  # rank-one updates multiplied out together


class Joint(NamedTuple):
    """Covariance of the components: `P - U[:r]^T U[:r]`, the r last merges waiting in `U` (PENDING, C) to be multiplied out.

    `component (T,)` which row of `P` each plane of the question belongs to; `spare (C,)` by how much the merges inside a component
    fit better than they should: their number less their chi-square.
    """

    P: Array
    U: Array
    component: Array
    spare: Array


@compiled
def column(P: Array, U: Array, r: int, a: int, b: int, out: Array) -> None:
    """out <- covariance of every component with m_a - m_b."""
    pa, pb = P[a], P[b]
    for i in range(len(out)):
        out[i] = pa[i] - pb[i]
    for k in range(r):
        row = U[k]
        part = row[a] - row[b]
        if part != 0.0:
            for i in range(len(out)):
                out[i] -= row[i] * part


@compiled
def multiplied_out(joint: Joint) -> tuple[Joint, Array]:
    """The covariance with all PENDING merges multiplied out and without the rows of components that are no more.

    Second: the new number of every old component.
    """
    joined = np.zeros(len(joint.P), np.bool_)
    for c in joint.component:
        joined[c] = True
    kept = np.flatnonzero(joined)
    number = np.zeros(len(joined), np.int64)
    number[kept] = np.arange(len(kept))
    U = np.ascontiguousarray(joint.U[:, kept])
    P = np.dot(np.ascontiguousarray(U.T), U)
    for i in range(len(kept)):
        old = joint.P[kept[i]]
        for j in range(len(kept)):
            P[i, j] = old[kept[j]] - P[i, j]
    return Joint(P, U, number[joint.component], joint.spare[kept]), number
