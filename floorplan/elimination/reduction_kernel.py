"""Compiled elimination of a scalar chain into its border; see `floorplan.elimination.reduction`."""

import numpy as np

from floorplan.compiled import compiled
from floorplan.model.checks import Array

FORGOTTEN = 1e-18  # a column's share below this part of its own scale cannot change a double


@compiled
def subtract_chain(
    pivot: Array, multiplier: Array, start: Array, column: Array, value: Array, last: Array, scale: Array, information: Array
) -> None:
    """`information -= B^T T^-1 B` for `T = L diag(pivot) L^T` with `multiplier` below L's diagonal.

    `B` is sparse by frame: entries `start[i]:start[i + 1]` are (`column`, `value`). A column is carried from the frame that
    first feels it until its share has decayed below rounding and no later frame feels it (`last`): the window that keeps
    work and memory local however long the chain is.
    """
    slot = np.full(len(scale), -1)
    active = np.empty(len(scale), np.int64)
    share = np.zeros(len(scale))
    used = 0
    for i in range(len(pivot)):
        if i > 0:
            used = _carry(i, -multiplier[i - 1], last, scale, share, active, slot, used)
        for k in range(start[i], start[i + 1]):
            if slot[column[k]] < 0:
                slot[column[k]] = used
                active[used] = column[k]
                share[used] = 0.0
                used += 1
            share[slot[column[k]]] += value[k]
        _subtract_outer(share[:used], active, 1.0 / pivot[i], information)
    for row in range(len(scale)):
        for other in range(row):
            information[other, row] = information[row, other]


@compiled
def _carry(i: int, factor: float, last: Array, scale: Array, share: Array, active: Array, slot: Array, used: int) -> int:
    """Carry the shares on to frame i; columns seen for the `last` time before it and decayed are dropped. Gives back how many are left."""
    kept = 0
    for a in range(used):
        carried = factor * share[a]
        if abs(carried) < FORGOTTEN * scale[active[a]] and last[active[a]] < i:
            slot[active[a]] = -1
            continue
        share[kept] = carried
        active[kept] = active[a]
        slot[active[kept]] = kept
        kept += 1
    return kept


@compiled
def _subtract_outer(share: Array, active: Array, weight: float, information: Array) -> None:
    """`information -= weight share share^T` at the active columns, lower triangle."""
    for a in range(len(share)):
        part = share[a] * weight
        row = active[a]
        for b in range(a + 1):
            other = active[b]
            if row >= other:
                information[row, other] -= part * share[b]
            else:
                information[other, row] -= part * share[b]
