"""Least squares with a few unknowns of which none may be negative."""

from itertools import combinations

import numpy as np

from floorplan.model.checks import Array


def non_negative_least_squares(columns: Array, right: Array) -> Array:
    """The `x (C,)`, none negative, that brings `columns (N, C) @ x` closest to `right (N,)`.

    Of every choice of unknowns that may differ from zero the plain least squares are tried (2^C of them: for a handful of unknowns),
    on the triangle that N rows come down to. It asks for no library of optimisation, whose import takes longer than most stages.
    """
    count = columns.shape[1]
    triangle: Array = np.asarray(np.linalg.qr(np.column_stack((columns, right)), mode="r"))
    best, least = np.zeros(count), float(np.linalg.norm(triangle[:, -1]))
    for size in range(1, count + 1):
        for chosen in combinations(range(count), size):
            part, _, rank, _ = np.linalg.lstsq(triangle[:, chosen], triangle[:, -1], rcond=None)
            off = float(np.linalg.norm(triangle[:, chosen] @ part - triangle[:, -1]))
            if rank == size and part.min() >= 0 and off < least:
                best, least = np.zeros(count), off
                best[list(chosen)] = part
    return best
