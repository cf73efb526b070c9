"""Clouds of a spinning LiDAR without a grid, put back on one: rings x columns, by ring number or height angle, and azimuth."""

from dataclasses import dataclass

import numpy as np

from floorplan.model.checks import Array

MAX_RINGS = 128  # the largest sensors there are
BLIND_RINGS = 64  # where the height angles show no rings: like the usual large sensor
RING_GAP_RAD = np.deg2rad(0.12)  # noise within a ring stays below it, the densest sensors' rings lie 0.3 degrees apart or more
LEAST_RING_SHARE = 0.002  # of the points: fewer are strays between rings
MIN_COLUMNS, MAX_COLUMNS = 90, 2048
MIN_RANGE_M = 1e-3  # nearer points are "no return" written as zeros


RING_FIELDS = ("ring", "channel", "line")  # Velodyne and Ouster; Hesai; Livox


@dataclass(frozen=True)
class Cloud:
    """One cloud as read: `points (H, W, 3)` float32, NaN for no return, and the number of each point's `ring (H, W)` where it tells."""

    points: Array
    ring: Array | None

    @property
    def organised(self) -> bool:
        """True when the cloud has rows of its own."""
        return len(self.points) > 1


@dataclass(frozen=True)
class RingGrid:
    """How points fall on the grid: `columns` once around from straight behind; `edges (rings - 1,)` height angles between the rings,
    rising, empty where points tell their ring."""

    rings: int
    columns: int
    edges: Array

    def organised(self, points: Array, ring: Array | None) -> Array:
        """Grid (rings, columns, 3) float32 of `points (N, 3)`, NaN where nothing is. Of two points in one cell the nearer stands."""
        distance = np.linalg.norm(points, axis=1)
        good = np.isfinite(distance) & (distance > MIN_RANGE_M)
        points, distance = points[good], distance[good]
        row = ring[good].astype(int) if ring is not None else np.searchsorted(self.edges, _height_angle(points))
        share = np.arctan2(points[:, 1], points[:, 0]) / (2 * np.pi) + 0.5
        column = np.minimum((share * self.columns).astype(int), self.columns - 1)
        on_grid = (row >= 0) & (row < self.rings)
        order = np.argsort(-distance[on_grid], kind="stable")  # the nearest is written last
        grid = np.full((self.rings, self.columns, 3), np.nan, dtype=np.float32)
        grid[row[on_grid][order], column[on_grid][order]] = points[on_grid][order]
        return grid


def grid_of(cloud: Cloud) -> RingGrid | None:
    """The grid for clouds without rows, such as `cloud`; None for those that have rows."""
    if cloud.organised:
        return None
    return ring_grid(cloud.points.reshape(-1, 3), None if cloud.ring is None else cloud.ring.reshape(-1))


def on_grid(cloud: Cloud, rings: RingGrid | None) -> Array:
    """Points (H, W, 3) float32: the cloud's own rows, or put on the grid `rings`."""
    if rings is None:
        return cloud.points
    return rings.organised(cloud.points.reshape(-1, 3), None if cloud.ring is None else cloud.ring.reshape(-1))


def ring_grid(points: Array, ring: Array | None) -> RingGrid:
    """The grid that a first cloud `points (N, 3)` calls for; `ring (N,)` the number of each point's ring, if the cloud tells it."""
    good = np.asarray(np.isfinite(points).all(axis=1))
    good &= np.asarray(np.linalg.norm(np.nan_to_num(points), axis=1) > MIN_RANGE_M)
    seen = points[good]
    if ring is not None and len(ring):
        rings, edges = int(ring.max()) + 1, np.zeros(0)
        row = ring[good].astype(int)
    else:
        edges = _ring_edges(_height_angle(seen))
        rings, row = len(edges) + 1, np.searchsorted(edges, _height_angle(seen))
    return RingGrid(rings, _columns(seen, row), edges)


def _height_angle(points: Array) -> Array:
    return np.asarray(np.arctan2(points[:, 2], np.hypot(points[:, 0], points[:, 1])))


def _ring_edges(angle: Array) -> Array:
    """Where the sorted height angles jump: between rings; even steps where they do not."""
    angle = np.sort(angle)
    cuts = np.flatnonzero(np.diff(angle) > RING_GAP_RAD)
    sizes = np.diff(np.concatenate(([0], cuts + 1, [len(angle)])))
    if 2 <= np.sum(sizes >= LEAST_RING_SHARE * len(angle)) == len(sizes) <= MAX_RINGS:
        return np.asarray((angle[cuts] + angle[cuts + 1]) / 2)
    low, high = np.quantile(angle, [0.001, 0.999]) if len(angle) else (-0.2, 0.2)
    return np.linspace(low, high, BLIND_RINGS + 1)[1:-1]


def _columns(points: Array, row: Array) -> int:
    """Once around over the usual step of the azimuth within a ring."""
    azimuth = np.arctan2(points[:, 1], points[:, 0])
    order = np.lexsort((azimuth, row))
    step = np.diff(azimuth[order])[np.diff(row[order]) == 0]
    step = step[step > 1e-5]  # doubled points
    return int(np.clip(round(2 * np.pi / float(np.median(step))), MIN_COLUMNS, MAX_COLUMNS)) if len(step) else MIN_COLUMNS
