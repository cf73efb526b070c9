"""The error that all rows of one track share: first from tracks that are probably one surface, then from those merged."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.linalg import cholesky, solve_triangular

from floorplan.merge.evidence_pairs import Planes, gaps_m, pair_variance_m2, pairs_within
from floorplan.merge.hypotheses import Pairs
from floorplan.model.checks import Array

WELL_KNOWN_M = 0.02  # pairs whose distance odometry knows better than this speak about bias and not about drift
WINDOW_M = 0.3  # distances looked at; beyond, two tracks are certainly two surfaces
BIAS_GRID_M = np.array([0.0003, 0.0006, 0.001, 0.0015, 0.002, 0.003, 0.004, 0.006, 0.008, 0.010, 0.0125, 0.016, 0.02, 0.028, 0.04])
SAME_GRID = np.array([0.2, 0.4, 0.6, 0.8, 0.95])  # share of the pairs that are one surface
PRIOR_BIAS_M = 0.004  # where a scan says nothing: depth errors common to a track that indoor sensors show
PRIOR_SPREAD = 1.0  # of its logarithm
MOST_TRACKS = 160  # of one system asked once they are merged: a hundred of them give the bias to 7 %


def bias_sigma_m(systems: Sequence[Planes], apart: Sequence[Pairs]) -> float:
    """Standard deviation of the per-track bias: a mixture of "one surface" and "any distance" over near, overlapping pairs (E7).

    `apart`, per system: pairs that single frames show at different offsets; a wall and the door set back in it say nothing about bias.
    """
    parts = (_before_merging(planes, pairs) for planes, pairs in zip(systems, apart, strict=True))
    return _likeliest(sum(parts, np.zeros(len(BIAS_GRID_M))))


def merged_bias_sigma_m(systems: Sequence[Planes], partitions: Sequence[Array], guess_m: float) -> float:
    """The same once `partitions` (T,) say which tracks are one plane: restricted likelihood of the tracks about their planes (E7b).

    The planes' covariances are those without the bias. The grid is climbed from `guess_m`, one of its values.
    """
    asked = [_few(planes, plane) for planes, plane in zip(systems, partitions, strict=True)]
    at, known = int(np.argmin(np.abs(BIAS_GRID_M - guess_m))), dict[int, float]()
    while True:
        near = [k for k in (at, at - 1, at + 1) if 0 <= k < len(BIAS_GRID_M)]
        for k in near:
            if k not in known:
                known[k] = float(_log_prior(BIAS_GRID_M[k])) + sum(_restricted(few, BIAS_GRID_M[k]) for few in asked)
        best = max(near, key=known.__getitem__)
        if best == at:
            return float(BIAS_GRID_M[at])
        at = best


@dataclass(frozen=True)
class _Few:
    """Some tracks of a system: their covariance and offsets (F,), `G (F, planes)` which plane each belongs to."""

    covariance_m2: Array
    G: Array
    offset_m: Array


def _likeliest(log_likelihood: Array) -> float:
    return float(BIAS_GRID_M[np.argmax(log_likelihood + _log_prior(BIAS_GRID_M))])


def _log_prior(bias_m: Array) -> Array:
    return np.asarray(-0.5 * (np.log(bias_m / PRIOR_BIAS_M) / PRIOR_SPREAD) ** 2)


def _before_merging(planes: Planes, apart: Pairs) -> Array:
    pairs = pairs_within(planes, WINDOW_M)
    count = len(planes.tracks)
    together = np.isin(pairs.first * count + pairs.second, apart.first * count + apart.second)
    variance = pair_variance_m2(planes, pairs)
    delta = planes.offset_m[pairs.first] - planes.offset_m[pairs.second]
    telling = (variance < WELL_KNOWN_M**2) & (gaps_m(planes, pairs) == 0.0) & ~together
    return np.asarray(_mixture(delta[telling], variance[telling]).max(axis=1))


def _mixture(delta: Array, variance: Array) -> Array:
    table = np.zeros((len(BIAS_GRID_M), len(SAME_GRID)))
    for i, bias in enumerate(BIAS_GRID_M):
        total = variance + 2 * bias**2
        same = np.exp(-0.5 * delta**2 / total) / np.sqrt(2 * np.pi * total)
        for k, share in enumerate(SAME_GRID):
            table[i, k] = np.log(share * same + (1 - share) / (2 * WINDOW_M)).sum()
    return table


def _few(planes: Planes, plane: Array) -> _Few:
    few = np.arange(min(len(plane), MOST_TRACKS))
    member = np.unique(plane[few], return_inverse=True)[1]
    G = np.zeros((len(few), int(member.max(initial=-1)) + 1))
    G[few, member] = 1.0
    return _Few(planes.covariance_m2[np.ix_(few, few)], G, planes.offset_m[few])


def _restricted(few: _Few, bias_m: float) -> float:
    """Log likelihood of `offset = G plane + error` with the planes integrated out."""
    covariance = few.covariance_m2 + bias_m**2 * np.eye(len(few.offset_m))
    lower = cholesky(covariance, lower=True, check_finite=False)
    white = solve_triangular(lower, np.column_stack([few.G, few.offset_m]), lower=True, check_finite=False)
    inner = cholesky(white[:, :-1].T @ white[:, :-1], lower=True, check_finite=False)
    fitted = solve_triangular(inner, white[:, :-1].T @ white[:, -1], lower=True, check_finite=False)
    log_det = 2 * float(np.log(np.diag(lower)).sum() + np.log(np.diag(inner)).sum())
    return -0.5 * (log_det + float(white[:, -1] @ white[:, -1] - fitted @ fitted))
