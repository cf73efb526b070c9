"""First guess of noise and drift: how differences of one track's measurements grow with the path between them.

Of two rows k, l of one track, `D = (d_k + o_k) - (d_l + o_l)` (o the dead-reckoned position) has the variance
`2 sigma^2 + rate^2 L + s^2 along^2 + w^2 across^2` (E6): L the path, along and across the displacement between them.
"""

from dataclasses import dataclass

import numpy as np

from floorplan.compiled import compiled
from floorplan.model.checks import Array
from floorplan.model.graph import LayoutGraph
from floorplan.model.normal import MAD_TO_SIGMA
from floorplan.non_negative import non_negative_least_squares

LAGS = (1, 2, 4, 8, 16, 32)  # rows apart, in one track
CLIP = 3.0  # a difference beyond this many sigma is an outlier and counts as just this many
ROUNDS = 6  # reweighted fits; the change is below a per cent after four
GRAM_FLOOR = 1e-12  # of columns of unit length: keeps the factor real where two of them are the same
TINY_M2 = 1e-10  # (0.01 mm)^2: keeps fitted variances above zero


@dataclass(frozen=True)
class Growth:
    """Standard deviations: of one measurement (m), white drift (m per sqrt(m)), scale rate and sideways rate (parts)."""

    sigma_m: float
    rate_m_per_sqrt_m: float
    scale: float
    sideways: float


@dataclass(frozen=True)
class _Differences:
    value_m: Array
    path_m: Array
    along_m: Array
    across_m: Array


def growth(graph: LayoutGraph, usable: Array, axes: tuple[int, ...]) -> Growth | None:
    """Fit of E6 to the usable rows of the given axes; None where no track has two rows."""
    found = _differences(graph, usable, axes)
    if len(found.value_m) == 0:
        return None
    columns = np.column_stack([np.full(len(found.value_m), 2.0), found.path_m, found.along_m**2, found.across_m**2])
    short = found.path_m <= np.median(found.path_m)
    spread = MAD_TO_SIGMA * float(np.median(np.abs(found.value_m[short]))) + 1e-6
    variance = np.full(len(found.value_m), spread**2) + (spread**2) * found.path_m / (np.median(found.path_m) + 1e-3)
    fit = np.zeros(4)
    for _ in range(ROUNDS):
        fit = _non_negative(*_normal_equations(columns, found.value_m**2, variance))
        variance = columns @ fit + TINY_M2
    root = np.sqrt(fit)
    return Growth(float(root[0]), float(root[1]), float(root[2]), float(root[3]))


@compiled
def _normal_equations(columns: Array, square: Array, variance: Array) -> tuple[Array, Array]:
    """Gram matrix (4, 4) and right-hand side (4,) of fitting `columns (D, 4)` to clipped squares, each row over its variance."""
    gram, right = np.zeros((4, 4)), np.zeros(4)
    for i in range(len(square)):
        weight = variance[i] ** -2
        clipped = weight * min(square[i], CLIP**2 * variance[i])
        for k in range(4):
            right[k] += clipped * columns[i, k]
            for j in range(k + 1):
                gram[k, j] += weight * columns[i, k] * columns[i, j]
    return gram + np.tril(gram, -1).T, right


def _non_negative(gram: Array, right: Array) -> Array:
    """Non-negative least squares by the normal equations: four unknowns, many rows."""
    scale = np.maximum(np.sqrt(np.diag(gram)), 1e-300)
    root = np.linalg.cholesky(gram / scale / scale[:, None] + GRAM_FLOOR * np.eye(len(scale)))
    return np.asarray(non_negative_least_squares(root.T, np.linalg.solve(root, right / scale)) / scale)


def _differences(graph: LayoutGraph, usable: Array, axes: tuple[int, ...]) -> _Differences:
    rows = np.nonzero(usable & np.isin(graph.axis[graph.track], axes))[0]
    rows = rows[np.lexsort((graph.frame[rows], graph.track[rows]))]
    dead = np.vstack([np.zeros(3), np.cumsum(graph.translation_m, axis=0)])
    path = np.concatenate([[0.0], np.cumsum(np.linalg.norm(graph.translation_m, axis=1))])
    track, frame, axis = graph.track[rows], graph.frame[rows], graph.axis[graph.track[rows]]
    level = graph.distance_m[rows] + dead[frame, axis]
    return _Differences(*_lagged(track, frame, axis, level, dead, path, np.array(LAGS)))


@compiled
def _lagged(track: Array, frame: Array, axis: Array, level: Array, dead: Array, path: Array, lags: Array) -> Array:
    """Difference of level, path, along and across (4, D) of all rows of one track that lie so many rows apart."""
    found, used = np.empty((4, len(lags) * len(track))), 0
    for lag in lags:
        for a in range(len(track) - lag):
            b = a + lag
            if track[a] == track[b]:
                there, here = dead[frame[b]], dead[frame[a]]
                along = there[axis[a]] - here[axis[a]]
                level_square = (there[0] - here[0]) ** 2 + (there[1] - here[1]) ** 2
                found[0, used], found[1, used], found[2, used] = level[b] - level[a], path[frame[b]] - path[frame[a]], along
                found[3, used] = np.sqrt(max(level_square - along**2, 0.0))
                used += 1
    return found[:, :used]
