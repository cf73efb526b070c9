"""A layout graph with the weights of its rows, as chains with planes: x and y together, z alone."""

from dataclasses import dataclass

import numpy as np

from floorplan.chain import Rows
from floorplan.frontal import Eliminated, eliminate_in_order, joint_covariance, least_squares, log_marginal_likelihood
from floorplan.model.checks import Array
from floorplan.model.graph import LayoutGraph
from floorplan.model.noise import ScanNoise
from floorplan.odometry_chain import Links, joint_chain, upright_chain

LEVEL_AXES, UPRIGHT_AXES = (0, 1), (2,)


@dataclass(frozen=True)
class AxisSystem:
    """One chain with its planes, factored: `axes` it spans, `tracks (T,)` of the graph in the order of its columns."""

    axes: tuple[int, ...]
    tracks: Array
    eliminated: Eliminated


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
    return AxisSystem(axes, tracks, eliminate_in_order(chain, rows, len(tracks)))


def solve(system: AxisSystem, pull: Array | None = None) -> AxesSolution:
    """Least squares; `pull (T,)` is a further right-hand side of the tracks, 1 / m."""
    solved = least_squares(system.eliminated, pull)
    return AxesSolution(solved.column, solved.state[:, : len(system.axes)])


def log_likelihood(system: AxisSystem) -> float:
    """Log marginal likelihood of the system's rows (E5), less a constant."""
    return log_marginal_likelihood(system.eliminated)
