"""Re-solve with whitened rows: the accepted equivalences as equalities, and the joint covariance of the planes."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.linalg import cho_factor, cho_solve

from floorplan.elimination.weighted import KnownSystem, known_systems, solve
from floorplan.merge_slack import slack_of_tracks_m
from floorplan.merged_planes import merged_graph, plane_extents
from floorplan.model.checks import Array
from floorplan.model.error_parts import STORED, ErrorCause, ErrorParts, no_parts
from floorplan.model.graph import LayoutGraph, LayoutSolution
from floorplan.model.merges_made import MergesMade
from floorplan.model.noise import ScanNoise
from floorplan.model.ties import DistanceTies
from floorplan.noise.track_bias import track_bias_m
from floorplan.rows import residual_norm


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
    rows = np.bincount(graph.track, np.isfinite(noise.sigma_m), len(graph.axis))
    place = np.vstack([np.zeros(3), np.cumsum(graph.translation_m, axis=0)])
    offset, covariance = np.zeros(count), np.zeros((count, count))
    parts = np.zeros((len(STORED), count, count), dtype=np.float32) if keep_covariance else None
    for one in known if known is not None else known_systems(graph, noise):
        mine, member = np.unique(plane_of_track[one.system.tracks], return_inverse=True)
        slack = None if made is None else slack_of_tracks_m(made, one.system.tracks, rows)
        joined = _joined(one, bias_m2[one.system.tracks], member, slack)
        tied = _tied(joined, _tie_rows(ties, mine), keep_covariance)
        offset[mine], covariance[np.ix_(mine, mine)] = tied.surface_m, tied.covariance_m2
        if parts is not None and tied.parts is not None:
            parts[np.ix_(np.arange(len(parts)), mine, mine)] = tied.parts.covariance_m2
        place[:, list(one.system.axes)] = solve(one.system, joined.pull(tied.plane_m)).position_m
    cross = planes.axis[:, None] != planes.axis[None, :]
    covariance[cross] = 0.0
    if parts is not None:
        parts[:, cross] = 0.0
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
        error_parts=None if parts is None else ErrorParts(parts),
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


@dataclass(frozen=True)
class _Joined:
    """Planes of one system: `plane_m (P,)`, their `covariance_m2` without and `merges_m2` from what merges leave open, `surfaces_m2` of
    the first from biases; `offset_m (T,)` of the tracks, `G (T, P)`, the factor of their covariance Q."""

    plane_m: Array
    covariance_m2: Array
    merges_m2: Array
    surfaces_m2: Array
    offset_m: Array
    G: Array
    factor: tuple[Array, bool]

    def pull(self, plane_m: Array) -> Array:
        """Of the tracks by planes that are there: `Q^-1 (G plane - offset)`."""
        return np.asarray(cho_solve(self.factor, self.G @ plane_m - self.offset_m))


def _joined(known: KnownSystem, bias_m2: Array, member: Array, slack_m: Array | None) -> _Joined:
    """Generalised least squares of `offset = G plane + error`, `cov error = Q = P + diag(bias_m2)`.

    The planes take every merge for right; `merges_m2` is how they would move by the slack `slack_m (D, T)` of the doubtful ones.
    """
    blurred = known.covariance_m2.copy()
    np.fill_diagonal(blurred, blurred.diagonal() + bias_m2)
    G = np.zeros((len(member), int(member.max(initial=-1)) + 1))
    G[np.arange(len(member)), member] = 1.0
    factor = cho_factor(blurred, lower=True, overwrite_a=True)
    heavy = cho_solve(factor, G)
    covariance = np.linalg.inv(G.T @ heavy)
    gain = covariance @ heavy.T
    moved = gain @ (np.zeros((len(member), 0)) if slack_m is None else slack_m.T)
    offset = known.solution.offset_m
    return _Joined(gain @ offset, covariance, moved @ moved.T, (gain * bias_m2) @ gain.T, offset, G, factor)


@dataclass(frozen=True)
class _Tied:
    """Planes once the measured distances are rows too: `plane_m` as the scan sees them, `surface_m` without its bias, its covariance."""

    plane_m: Array
    surface_m: Array
    covariance_m2: Array
    parts: ErrorParts | None


def _tied(joined: _Joined, ties: _TieRows, keep_parts: bool) -> _Tied:
    """Planes and surfaces conditioned on the measured distances (E11): what the scan's planes do not give is their bias."""
    plane = joined.plane_m
    scale, sensor = ties.scale_sigma**2 * np.outer(plane, plane), ties.bias_sigma_m**2 * np.eye(len(plane))
    seen = joined.covariance_m2 + joined.merges_m2 + scale
    true = seen + sensor
    parts = no_parts(len(plane)) if keep_parts else None
    if parts is not None:
        added = ((ErrorCause.SURFACES, joined.surfaces_m2), (ErrorCause.MERGES, joined.merges_m2), (ErrorCause.SCALE, scale))
        for cause, part in (*added, (ErrorCause.SENSOR, sensor)):
            parts = parts.with_added(cause, part)
    if not len(ties.length_m):
        return _Tied(plane, plane, true, parts)
    felt = true @ ties.H.T
    spread = ties.H @ felt + np.diag(ties.variance_m2)
    gain = np.linalg.solve(spread, felt.T).T
    pull = ties.H.T @ np.linalg.solve(spread, ties.length_m - ties.H @ plane)
    if parts is not None:
        parts = parts.seen_through(np.eye(len(plane)) - gain @ ties.H).with_added(ErrorCause.TAPE, (gain * ties.variance_m2) @ gain.T)
    return _Tied(plane + seen @ pull, plane + true @ pull, true - felt @ gain.T, parts)
