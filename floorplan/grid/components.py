"""Connected components of equal label on an organised grid: union-find over the four neighbours."""

from dataclasses import dataclass

import numpy as np

from floorplan.compiled import compiled
from floorplan.model.checks import Array

OFF_AXIS = 6  # labels from here on have two coordinates


@dataclass(frozen=True)
class Components:
    """`label (C,)`; `start (C + 1,)` and `order (P,) int32`: the flat pixel indices of component c are `order[start[c]:start[c + 1]]`,
    in raster order."""

    label: Array
    start: Array
    order: Array


def connected_components(labels: Array, coordinate: Array, gate: Array, least_pixels: int) -> Components:
    """Components of pixels of equal label >= 0 whose neighbours' `coordinate (H, W, 2)` differ by less than `gate (H, W)`.

    Of labels below OFF_AXIS the first coordinate is compared, of others both. Components smaller than `least_pixels` are
    dropped; the others come in the order of their first pixels.
    """
    return Components(*_components(labels, coordinate, gate, least_pixels))


@compiled
def _root(parent: Array, k: int) -> int:
    while parent[k] != k:
        parent[k] = parent[parent[k]]
        k = parent[k]
    return k


@compiled
def _touch(labels: Array, coordinate: Array, gate: Array, i: int, j: int, u: int, v: int) -> bool:
    label = labels[i, j]
    if labels[u, v] != label:
        return False
    step = abs(coordinate[i, j, 0] - coordinate[u, v, 0])
    if label < OFF_AXIS:
        return bool(step < gate[i, j])
    # Off the axes both horizontal coordinates change along the surface: only a step in depth separates.
    return bool(max(step, abs(coordinate[i, j, 1] - coordinate[u, v, 1])) < 6 * gate[i, j])


@compiled
def _runs(labels: Array, coordinate: Array, gate: Array) -> tuple[Array, Array, Array]:
    """The run (H, W) each pixel belongs to: touching pixels of a row. Of each run another one of its component, nearer to the
    component's first, which is its own; and its number of pixels."""
    height, width = labels.shape
    run_of = np.empty((height, width), np.int32)
    parent, size = np.empty(height * width, np.int32), np.empty(height * width, np.int32)
    runs = 0
    for i in range(height):
        united_above, united = -1, -1
        for j in range(width):
            if labels[i, j] < 0:
                run_of[i, j] = -1
                continue
            if j > 0 and _touch(labels, coordinate, gate, i, j, i, j - 1):
                run = run_of[i, j - 1]
            else:
                run = np.int32(runs)
                parent[run], size[run] = run, 0
                runs += 1
            run_of[i, j] = run
            size[run] += 1
            if i > 0 and _touch(labels, coordinate, gate, i, j, i - 1, j):
                above = run_of[i - 1, j]
                if above == united_above and run == united:
                    continue
                a, b = _root(parent, run), _root(parent, above)
                parent[max(a, b)] = min(a, b)
                united_above, united = above, run
    return run_of, parent[:runs], size[:runs]


@compiled
def _components(labels: Array, coordinate: Array, gate: Array, least_pixels: int) -> tuple[Array, Array, Array]:
    run_of, parent, size = _runs(labels, coordinate, gate)
    for run in range(len(parent) - 1, -1, -1):
        root = _root(parent, run)
        if root != run:
            size[root] += size[run]
    number = np.full(len(parent), -1, np.int32)
    start = np.zeros(len(parent) + 1, np.int64)
    count = 0
    for run in range(len(parent)):
        root = _root(parent, run)
        if root == run and size[run] >= least_pixels:
            number[run] = count
            start[count + 1] = start[count] + size[run]
            count += 1
        else:
            number[run] = number[root] if root != run else -1
    fill = start[:count].copy()
    label = np.zeros(count, np.int8)
    order = np.empty(start[count], np.int32)
    height, width = labels.shape
    for i in range(height):
        for j in range(width):
            run = run_of[i, j]
            if run < 0 or number[run] < 0:
                continue
            c = number[run]
            label[c] = labels[i, j]
            order[fill[c]] = i * width + j
            fill[c] += 1
    return label, start[: count + 1].copy(), order
