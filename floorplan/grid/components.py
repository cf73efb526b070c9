"""Connected components of equal label on an organised grid: union-find over the four neighbours."""

from dataclasses import dataclass

import numpy as np

from floorplan.compiled import compiled
from floorplan.model.checks import Array

NO_COMPONENT = -1


@dataclass(frozen=True)
class Components:
    """`index (H, W) int32` component of each pixel or NO_COMPONENT; `label (C,)`; `start (C + 1,)` and `order (P,)`: the flat pixel
    indices of component c are `order[start[c]:start[c + 1]]`, in raster order."""

    index: Array
    label: Array
    start: Array
    order: Array


def connected_components(labels: Array, coordinate: Array, gate: Array, least_pixels: int) -> Components:
    """Components of pixels of equal label >= 0 whose neighbours' `coordinate (H, W, 3)` differ by less than `gate (H, W)`.

    The coordinate compared is the one of the label's axis (label // 2, the largest for labels above 5).
    Components smaller than `least_pixels` are dropped.
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
    if label < 6:
        axis = label // 2
        return bool(abs(coordinate[i, j, axis] - coordinate[u, v, axis]) < gate[i, j])
    # Off the axes both horizontal coordinates change along the surface: only a step in depth separates.
    step_x, step_y = abs(coordinate[i, j, 0] - coordinate[u, v, 0]), abs(coordinate[i, j, 1] - coordinate[u, v, 1])
    return bool(max(step_x, step_y) < 6 * gate[i, j])


@compiled
def _united(labels: Array, coordinate: Array, gate: Array) -> Array:
    """Of each pixel (H * W,) another one of its component, nearer to the component's first, which is its own."""
    height, width = labels.shape
    parent = np.arange(height * width)
    for i in range(height):
        for j in range(width):
            if labels[i, j] < 0:
                continue
            if j > 0 and _touch(labels, coordinate, gate, i, j, i, j - 1):
                a, b = _root(parent, i * width + j), _root(parent, i * width + j - 1)
                parent[max(a, b)] = min(a, b)
            if i > 0 and _touch(labels, coordinate, gate, i, j, i - 1, j):
                a, b = _root(parent, i * width + j), _root(parent, (i - 1) * width + j)
                parent[max(a, b)] = min(a, b)
    return parent


@compiled
def _components(labels: Array, coordinate: Array, gate: Array, least_pixels: int) -> tuple[Array, Array, Array, Array]:
    height, width = labels.shape
    parent = _united(labels, coordinate, gate)
    size = np.zeros(height * width, np.int32)
    flat = labels.ravel()
    for k in range(height * width):
        if flat[k] >= 0:
            parent[k] = _root(parent, k)
            size[parent[k]] += 1
    number = np.full(height * width, NO_COMPONENT, np.int32)
    count = 0
    for k in range(height * width):
        if size[k] >= least_pixels:
            number[k] = count
            count += 1
    label = np.zeros(count, np.int8)
    start = np.zeros(count + 1, np.int64)
    index = np.full(height * width, NO_COMPONENT, np.int32)
    for k in range(height * width):
        if flat[k] >= 0 and number[parent[k]] >= 0:
            c = number[parent[k]]
            index[k] = c
            label[c] = flat[k]
            start[c + 1] += 1
    start = np.cumsum(start)
    fill = start[:-1].copy()
    order = np.empty(start[-1], np.int64)
    for k in range(height * width):
        c = index[k]
        if c >= 0:
            order[fill[c]] = k
            fill[c] += 1
    return index.reshape(height, width), label, start, order
