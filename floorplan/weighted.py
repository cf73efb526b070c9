"""A layout graph with the weights of its rows, as chains reduced to planes: x and y together, z alone."""

from dataclasses import dataclass

import numpy as np

from floorplan.chain import ROUNDING, Reduced, Rows, back_substitute, eliminate
from floorplan.model.checks import Array
from floorplan.model.graph import LayoutGraph
from floorplan.model.noise import ScanNoise
from floorplan.odometry_chain import Links, joint_chain, upright_chain

LEVEL_AXES, UPRIGHT_AXES = (0, 1), (2,)


@dataclass(frozen=True)
class AxisSystem:
    """One chain with its planes: `axes` it spans, `tracks (T,)` of the graph in the order of its columns, the reduced system."""

    axes: tuple[int, ...]
    tracks: Array
    reduced: Reduced


def build_system(graph: LayoutGraph, noise: ScanNoise, axes: tuple[int, ...], forgotten: float = ROUNDING) -> AxisSystem:
    """Eliminate the trajectory of `axes` (LEVEL_AXES or UPRIGHT_AXES) under `noise`."""
    tracks = np.nonzero(np.isin(graph.axis, axes))[0]
    place = np.full(len(graph.axis), -1)
    place[tracks] = np.arange(len(tracks))
    mine = np.nonzero((place[graph.track] >= 0) & np.isfinite(noise.sigma_m))[0]
    component = graph.axis[graph.track[mine]] - axes[0]
    rows = Rows(graph.frame[mine], component, place[graph.track[mine]], graph.distance_m[mine], noise.sigma_m[mine] ** -2)
    links = Links(graph.link, graph.link_sigma_m)
    level = axes == LEVEL_AXES
    steps = graph.translation_m
    if level:
        chain = joint_chain(steps, noise.drift, links, noise.step_m, graph.map_sigma_m)
    else:
        chain = upright_chain(steps, noise.vertical, links)
    return AxisSystem(axes, tracks, eliminate(chain, rows, len(tracks), forgotten))


def positions(system: AxisSystem, columns: Array) -> Array:
    """Positions (N, len(axes)) along the system's axes, given its columns (planes, then the dense ones)."""
    return back_substitute(system.reduced, columns)[:, : len(system.axes)]
