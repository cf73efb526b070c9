"""The layout graph after merging: measurements of merged planes, and the boxes of those planes."""

from dataclasses import replace

import numpy as np

from floorplan.model.checks import Array
from floorplan.model.graph import LayoutGraph
from floorplan.rows import AXES, sums_by


def merged_graph(graph: LayoutGraph, plane_of_track: Array) -> LayoutGraph:
    """The graph whose tracks are the merged planes: `E' xi = 0` by substitution. Extents are left unknown."""
    planes, first = np.unique(plane_of_track, return_index=True)
    if len(planes) and planes[-1] != len(planes) - 1:
        raise ValueError("plane_of_track must number the planes 0..L-1")
    mixed = (graph.axis[first][plane_of_track] != graph.axis) | (graph.facing[first][plane_of_track] != graph.facing)
    if mixed.any():
        raise ValueError(f"track {np.flatnonzero(mixed)[0]} is merged with one of another axis or facing")
    unknown = np.full((len(planes), 3, 2), np.nan)
    return replace(graph, track=plane_of_track[graph.track], axis=graph.axis[first], facing=graph.facing[first], extent_m=unknown)


def plane_extents(graph: LayoutGraph, plane_of_track: Array, position_m: Array, plane_offset_m: Array) -> Array:
    """Union of the tracks' boxes (L, 3, 2), each moved by the mean correction of the frames that saw it; NaN where unknown."""
    dead_reckoned = np.vstack((np.zeros((1, 3)), np.cumsum(graph.translation_m, axis=0)))
    correction = (position_m - dead_reckoned)[graph.frame]
    seen = np.maximum(np.bincount(graph.track, minlength=len(graph.axis)), 1)
    shift = np.stack([sums_by(graph.track, correction[:, k], len(graph.axis)) for k in AXES], axis=1) / seen[:, None]
    moved = graph.extent_m + shift[:, :, None]
    lowest, highest = np.full((len(plane_offset_m), 3), np.nan), np.full((len(plane_offset_m), 3), np.nan)
    np.fmin.at(lowest, plane_of_track, moved[:, :, 0])
    np.fmax.at(highest, plane_of_track, moved[:, :, 1])
    extent = np.stack((lowest, highest), axis=2)
    extent[plane_of_track, graph.axis] = plane_offset_m[plane_of_track, None]
    return extent
