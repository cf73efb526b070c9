"""Cuts a layout graph into stretches of frames, each a small layout graph of its own: memory stays flat on long scans."""

from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from floorplan.model.checks import Array
from floorplan.model.graph import LayoutGraph


@dataclass(frozen=True)
class Window:
    """A stretch: its graph, and which rows (R,) and tracks (T,) of the whole graph it holds, from which frame on."""

    graph: LayoutGraph
    rows: Array
    tracks: Array
    first_frame: int


def windows(graph: LayoutGraph, frames: int) -> list[Window]:
    """Stretches of at most `frames` frames of one scan, near equal; every row belongs to exactly one."""
    scans = np.concatenate(([0], graph.link + 1, [len(graph.stamp_s)]))
    edges = np.concatenate([[0], *(_edges(first, last, frames)[1:] for first, last in pairwise(scans.tolist()))])
    order = np.argsort(graph.frame, kind="stable")
    cut = np.searchsorted(graph.frame[order], edges)
    return [
        _window(graph, order[a:b], low, high) for a, b, low, high in zip(cut[:-1], cut[1:], edges[:-1], edges[1:], strict=True) if b > a
    ]


def _edges(first: int, last: int, frames: int) -> Array:
    pieces = max(1, -(-(last - first) // frames))
    return np.linspace(first, last, pieces + 1).round().astype(int)


def _window(graph: LayoutGraph, rows: Array, low: int, high: int) -> Window:
    tracks, local = np.unique(graph.track[rows], return_inverse=True)
    piece = LayoutGraph(
        graph.stamp_s[low:high],
        graph.translation_m[low : high - 1],
        graph.frame[rows] - low,
        local,
        graph.distance_m[rows],
        graph.axis[tracks],
        graph.facing[tracks],
        graph.extent_m[tracks],
        None if graph.sigma_m is None else graph.sigma_m[rows],
        map_sigma_m=None if graph.map_sigma_m is None else graph.map_sigma_m[low:high],
    )
    return Window(piece, rows, tracks, low)
