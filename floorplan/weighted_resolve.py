"""Re-solve with whitened rows: the accepted equivalences as equalities, and the joint covariance of the planes."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.linalg import cho_factor, cho_solve

from floorplan.merge_slack import slack_of_tracks_m
from floorplan.merged_planes import merged_graph, plane_extents
from floorplan.model.checks import Array
from floorplan.model.graph import LayoutGraph, LayoutSolution
from floorplan.model.merges_made import MergesMade
from floorplan.model.noise import ScanNoise
from floorplan.model.ties import DistanceTies
from floorplan.rows import residual_norm
from floorplan.track_bias import track_bias_m
from floorplan.weighted import KnownSystem, known_systems, solve


def weighted_resolve(
    graph: LayoutGraph,
    plane_of_track: Array,
    noise: ScanNoise,
    keep_covariance: bool = True,
    ties: DistanceTies | None = None,
    known: Sequence[KnownSystem] | None = None,
    made: MergesMade | None = None,
) -> LayoutSolution:
    """Planes, positions and covariance under `noise`; a track is its plane plus its bias (E10).

    `ties` are distances between final planes measured by hand: further rows, each with its sigma. `known`: the graph's systems, where
    they were solved under this noise before. `made`: the merges behind `plane_of_track`; what they leave open is in the covariance (E13).
    """
    planes = merged_graph(graph, plane_of_track)
    count = len(planes.axis)
    bias_m2 = track_bias_m(graph, noise) ** 2
    place = np.vstack([np.zeros(3), np.cumsum(graph.translation_m, axis=0)])
    offset, covariance = np.zeros(count), np.zeros((count, count))
    for one in known if known is not None else known_systems(graph, noise):
        mine, member = np.unique(plane_of_track[one.system.tracks], return_inverse=True)
        blurred = one.covariance_m2.copy()
        np.fill_diagonal(blurred, blurred.diagonal() + bias_m2[one.system.tracks])
        slack = None if made is None else slack_of_tracks_m(made, one.system.tracks)
        offset[mine], covariance[np.ix_(mine, mine)], pulled = _joined(one.solution.offset_m, blurred, member, _tie_rows(ties, mine), slack)
        place[:, list(one.system.axes)] = solve(one.system, pulled).position_m
    cross = planes.axis[:, None] != planes.axis[None, :]
    covariance[cross] = 0.0
    return LayoutSolution(
        position_m=place,
        plane_of_track=plane_of_track,
        plane_axis=planes.axis,
        plane_facing=planes.facing,
        plane_offset_m=offset,
        plane_sigma_m=np.sqrt(np.diag(covariance)),
        plane_extent_m=plane_extents(graph, plane_of_track, place, offset),
        plane_covariance_m2=covariance if keep_covariance else None,
        residual_m=residual_norm(planes, place, offset),
    )


@dataclass(frozen=True)
class _TieRows:
    """Measured distances of one system: `H (T, planes)`, `length_m (T,)`, `variance_m2 (T,)`."""

    H: Array
    length_m: Array
    variance_m2: Array
    scale_sigma: float = 0.0
    bias_sigma_m: float = 0.0


def _tie_rows(ties: DistanceTies | None, mine: Array) -> _TieRows:
    """The ties whose planes are among `mine`, in that order of the planes."""
    if ties is None:
        return _TieRows(np.zeros((0, len(mine))), np.zeros(0), np.zeros(0))
    kept = ties.only(np.isin(ties.lower, mine) & np.isin(ties.upper, mine))
    return _TieRows(kept.matrix(int(mine.max()) + 1)[:, mine], kept.length_m, kept.sigma_m**2, ties.scale_sigma, ties.bias_sigma_m)


def _joined(offset_m: Array, blurred: Array, member: Array, ties: _TieRows, slack_m: Array | None) -> tuple[Array, Array, Array]:
    """Generalised least squares of `offset = G plane + error`, covariance `blurred` Q: planes, theirs, pull of the tracks.

    The pull is `Q^-1 (G plane - offset)`. The planes take every merge for right; their covariance has in it how they would move
    by the slack `slack_m (D, T)` of the doubtful ones.
    """
    G = np.zeros((len(member), ties.H.shape[1]))
    G[np.arange(len(member)), member] = 1.0
    factor = cho_factor(blurred, lower=True, overwrite_a=True)
    heavy = cho_solve(factor, G)
    covariance = np.linalg.inv(G.T @ heavy)
    plane = covariance @ (heavy.T @ offset_m)
    if slack_m is not None:
        moved = covariance @ (heavy.T @ slack_m.T)
        covariance = covariance + moved @ moved.T
    tied = _tied(plane, covariance, ties)
    return tied.surface_m, tied.covariance_m2, np.asarray(cho_solve(factor, G @ tied.plane_m - offset_m))


@dataclass(frozen=True)
class _Tied:
    """Planes once the measured distances are rows too: `plane_m` as the scan sees them, `surface_m` without its bias, its covariance."""

    plane_m: Array
    surface_m: Array
    covariance_m2: Array


def _tied(plane: Array, covariance: Array, ties: _TieRows) -> _Tied:
    """Planes and surfaces conditioned on the measured distances (E11): what the scan's planes do not give is their bias."""
    seen = covariance + ties.scale_sigma**2 * np.outer(plane, plane)
    true = seen + ties.bias_sigma_m**2 * np.eye(len(plane))
    if not len(ties.length_m):
        return _Tied(plane, plane, true)
    felt = true @ ties.H.T
    spread = ties.H @ felt + np.diag(ties.variance_m2)
    pull = ties.H.T @ np.linalg.solve(spread, ties.length_m - ties.H @ plane)
    return _Tied(plane + seen @ pull, plane + true @ pull, true - felt @ np.linalg.solve(spread, felt.T))
