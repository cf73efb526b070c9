"""A layout graph with the weights of its rows, as chains with planes: x and y together, z alone."""

from dataclasses import dataclass

import numpy as np

from floorplan.elimination.chain import Chain, Rows
from floorplan.elimination.frontal import Arranged, Eliminated, arrange, eliminate_in_order, joint_covariance, least_squares
from floorplan.elimination.odometry_chain import JOINT_STATES, UPRIGHT_STATES, Links, joint_chain, upright_chain
from floorplan.model.checks import Array
from floorplan.model.graph import LayoutGraph
from floorplan.model.noise import DriftModel, ScanNoise, VerticalDrift

LEVEL_AXES, UPRIGHT_AXES = (0, 1), (2,)
SHAPE = {LEVEL_AXES: (JOINT_STATES, 2), UPRIGHT_AXES: (UPRIGHT_STATES, 1)}  # states of a frame, and how many of frame 0 are pinned


@dataclass(frozen=True)
class AxisSystem:
    """One chain with its planes, factored: `axes` it spans, `tracks (T,)` of the graph in the order of its columns."""

    axes: tuple[int, ...]
    tracks: Array
    eliminated: Eliminated


@dataclass(frozen=True)
class AxesRows:
    """The measurement rows of some axes, whatever the odometry: `tracks (T,)` of the graph in the order of their columns."""

    axes: tuple[int, ...]
    tracks: Array
    arranged: Arranged


@dataclass(frozen=True)
class AxesSolution:
    """Least squares along some axes: `offset_m (T,)` of the system's tracks, `position_m (N, len(axes))`."""

    offset_m: Array
    position_m: Array


@dataclass(frozen=True)
class KnownSystem:
    """A system with its solution and the joint covariance (T, T) of its tracks' offsets."""

    system: AxisSystem
    solution: AxesSolution
    covariance_m2: Array


def known_systems(graph: LayoutGraph, noise: ScanNoise) -> list[KnownSystem]:
    """All systems of a graph, solved, with covariances."""
    return [KnownSystem(system, solve(system), joint_covariance(system.eliminated)) for system in systems(graph, noise)]


def systems(graph: LayoutGraph, noise: ScanNoise) -> list[AxisSystem]:
    """x and y together, then z, as far as the graph has tracks there."""
    return [build_system(graph, noise, axes) for axes in (LEVEL_AXES, UPRIGHT_AXES) if np.isin(graph.axis, axes).any()]


def build_system(graph: LayoutGraph, noise: ScanNoise, axes: tuple[int, ...]) -> AxisSystem:
    """The rows of `axes` (LEVEL_AXES or UPRIGHT_AXES) under `noise`, factored."""
    rows = arrange_rows(graph, noise.sigma_m, axes)
    chain = odometry_of(graph, rows, noise.drift, noise.vertical, noise.step_m)
    return AxisSystem(axes, rows.tracks, eliminate_in_order(chain, rows.arranged))


def arrange_rows(graph: LayoutGraph, sigma_m: Array, axes: tuple[int, ...]) -> AxesRows:
    """The measurement rows of `axes` with their `sigma_m (K,)`; those of infinite sigma are left out."""
    tracks = np.flatnonzero((graph.axis >= axes[0]) & (graph.axis <= axes[-1]))
    place = np.full(len(graph.axis), -1)
    place[tracks] = np.arange(len(tracks))
    mine = np.flatnonzero((place[graph.track] >= 0) & np.isfinite(sigma_m))
    component = graph.axis[graph.track[mine]] - axes[0]
    rows = Rows(graph.frame[mine], component, place[graph.track[mine]], graph.distance_m[mine], sigma_m[mine] ** -2)
    states, pinned = SHAPE[axes]
    return AxesRows(axes, tracks, arrange(rows, (len(graph.stamp_s), states), len(tracks), pinned))


def odometry_of(graph: LayoutGraph, rows: AxesRows, drift: DriftModel, vertical: VerticalDrift, step_m: Array | None) -> Chain:
    """The odometry rows of the same axes as a chain."""
    links = Links(graph.link, graph.link_sigma_m)
    if rows.axes == LEVEL_AXES:
        return joint_chain(graph.translation_m, drift, links, step_m, graph.map_sigma_m)
    return upright_chain(graph.translation_m, vertical, links)


def solve(system: AxisSystem, pull: Array | None = None) -> AxesSolution:
    """Least squares; `pull (T,)` is a further right-hand side of the tracks, 1 / m."""
    solved = least_squares(system.eliminated, pull)
    return AxesSolution(solved.column, solved.state[:, : len(system.axes)])
