"""How far apart two nodes are by the way the robot went, loops taken as short cuts: what drift grows with."""

from collections.abc import Sequence

import numpy as np
from scipy import sparse
from scipy.sparse.csgraph import dijkstra

from floorplan.model.checks import Array

_SHORT_CUT_M = 1.0  # a loop is known about as well as a metre of the way


def ways_from(node: int, path_m: Array, loops: Sequence[tuple[int, int]], farthest_m: float) -> Array:
    """Length (M,) m of the shortest way from `node` to every node along the path and the `loops`; infinite beyond `farthest_m`."""
    if not loops:
        return np.asarray(np.abs(path_m - path_m[node]))
    count = len(path_m)
    pairs = np.array(loops)
    first, second = np.concatenate((np.arange(count - 1), pairs[:, 0])), np.concatenate((np.arange(1, count), pairs[:, 1]))
    length = np.concatenate((np.diff(path_m), np.full(len(pairs), _SHORT_CUT_M)))
    graph = sparse.csr_matrix((length, (first, second)), shape=(count, count))
    return np.asarray(dijkstra(graph, directed=False, indices=node, limit=farthest_m))
