"""Frames a short walk apart taken together: what takes metres to show, odometry's rates, is asked of a fifth of the rows."""

import numpy as np

from floorplan.elimination.windows import Window
from floorplan.model.checks import Array
from floorplan.model.graph import LayoutGraph

LUMP_M = 0.5  # far below the 20 m over which rates persist, far above the spacing of keyframes
RATE_TINY = 1e-9  # m per sqrt(m), against division by zero
SHORTEST_M = 1e-3  # below it every frame that moved is on its own


def lump_length_m(sigma_m: Array, rate_m_per_sqrt_m: float) -> float:
    """Path over which odometry's white error stays below that of a row, LUMP_M at most: means within it lose nothing."""
    known = sigma_m[np.isfinite(sigma_m)]
    sigma = float(np.median(known)) if len(known) else 0.0
    return min(LUMP_M, (sigma / max(rate_m_per_sqrt_m, RATE_TINY)) ** 2)


def lumped(window: Window, sigma_m: Array, length_m: float = LUMP_M) -> tuple[LayoutGraph, Array]:
    """A window whose frames are the mean places of those within `length_m` of path, and `sigma (R',)` of its rows.

    `sigma_m` of the whole graph's rows. Rows of one track in one lump become their weighted mean, moved to the lump's
    mean place by the odometry. Rejected rows are left out.
    """
    graph, sigma = window.graph, sigma_m[window.rows]
    lump, count = _lump_of_frame(graph, length_m)
    dead = np.vstack([np.zeros(3), np.cumsum(graph.translation_m, axis=0)])
    size = np.bincount(lump, minlength=count)
    centre = np.stack([np.bincount(lump, dead[:, k], count) for k in range(3)], axis=1) / size[:, None]
    rows = np.flatnonzero(np.isfinite(sigma))
    frame, track = lump[graph.frame[rows]], graph.track[rows]
    axis = graph.axis[track]
    distance = graph.distance_m[rows] + dead[graph.frame[rows], axis] - centre[frame, axis]
    name, row = np.unique(frame * len(graph.axis) + track, return_inverse=True)
    weight = np.bincount(row, sigma[rows] ** -2, len(name))
    mean = np.bincount(row, sigma[rows] ** -2 * distance, len(name)) / weight
    stamp = np.bincount(lump, graph.stamp_s, count) / size
    whole = LayoutGraph(
        stamp,
        np.diff(centre, axis=0),
        name // len(graph.axis),
        name % len(graph.axis),
        mean,
        graph.axis,
        graph.facing,
        graph.extent_m,
        map_sigma_m=None if graph.map_sigma_m is None else np.bincount(lump, graph.map_sigma_m, count) / size,
    )
    return whole, weight**-0.5


def _lump_of_frame(graph: LayoutGraph, length_m: float) -> tuple[Array, int]:
    """The lump (N,) of every frame, numbered without holes, and how many there are."""
    path = np.concatenate([[0.0], np.cumsum(np.linalg.norm(graph.translation_m, axis=1))])
    name, lump = np.unique((path / max(length_m, SHORTEST_M)).astype(np.int64), return_inverse=True)
    return lump, len(name)
