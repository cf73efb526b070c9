"""The layout graph with tracks merged: `E' xi = 0` by substitution."""

from dataclasses import replace

import numpy as np

from floorplan.model.checks import Array
from floorplan.model.graph import LayoutGraph


def merged_graph(graph: LayoutGraph, plane_of_track: Array) -> LayoutGraph:
    """The graph whose tracks are the planes 0..L-1 of `plane_of_track (M,)`. Extents are left unknown.

    Raises ValueError when a plane mixes axes or facings.
    """
    planes, first = np.unique(plane_of_track, return_index=True)
    if len(planes) and planes[-1] != len(planes) - 1:
        raise ValueError("plane_of_track must number the planes 0..L-1")
    mixed = (graph.axis[first][plane_of_track] != graph.axis) | (graph.facing[first][plane_of_track] != graph.facing)
    if mixed.any():
        raise ValueError(f"track {np.flatnonzero(mixed)[0]} is merged with one of another axis or facing")
    unknown = np.full((len(planes), 3, 2), np.nan)
    return replace(graph, track=plane_of_track[graph.track], axis=graph.axis[first], facing=graph.facing[first], extent_m=unknown)
