"""The error that all rows of one track share: first from tracks that are probably one surface, then from those merged."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from itertools import product

import numpy as np
from scipy.linalg import cholesky, solve_triangular

from floorplan.merge.evidence_pairs import Planes, gaps_m, pair_variance_m2, pairs_within
from floorplan.merge.hypotheses import Pairs
from floorplan.model.checks import Array

WELL_KNOWN_M = 0.02  # pairs whose distance odometry knows better than this speak about bias and not about drift
WINDOW_M = 0.3  # distances looked at; beyond, two tracks are certainly two surfaces
BIAS_GRID_M = (0.0003, 0.0006, 0.001, 0.0015, 0.002, 0.003, 0.004, 0.006, 0.008, 0.010, 0.0125, 0.016, 0.02, 0.028, 0.04)
SHARE_GRID = (0.02, 0.05, 0.1, 0.2, 0.35, 0.5, 0.7, 1.0)
FAR_GRID = (1e-5, 5e-5, 1e-4, 2e-4, 4e-4, 8e-4, 1.6e-3, 3e-3, 6e-3, 0.012, 0.024)  # per metre
SAME_GRID = np.array([0.2, 0.4, 0.6, 0.8, 0.95])  # share of the pairs that are one surface
PRIOR_BIAS_M = 0.004  # where a scan says nothing: depth errors common to a track that indoor sensors show
PRIOR_SHARE = 0.5  # the same view frame after frame: a quarter of the variance of one row is that of the next one too
PRIOR_FAR_PER_M = 2e-4  # a hundredth of a pixel of disparity (lens of 575 pixels, base of 7.5 cm): 2 mm at 3 m
SPREAD = np.array([1.5, 1.0, 1.5])  # of the logarithm of each: sensors differ tenfold; the share, a matter of how segments are fitted, less
STARTS_M = (0.0003, 0.004)  # the mixture may have two tops: all one surface with a large bias, or some with a small one
MOST_TRACKS = 160  # of one system asked once they are merged: a hundred of them give the bias to 7 %


@dataclass(frozen=True)
class Bias:
    """Standard deviation of a track's bias: the root of `constant_m`^2 + (`share` times the sigma of one of its rows)^2 +
    (`far_per_m` times the square of the distance it was seen from)^2; the last is what a camera that triangulates gets wrong."""

    constant_m: float
    share: float
    far_per_m: float

    def of(self, planes: Planes) -> Array:
        """The standard deviation (T,) for tracks seen as those were."""
        return np.sqrt(self.constant_m**2 + (self.share * planes.row_sigma_m) ** 2 + (self.far_per_m * planes.square_range_m2) ** 2)


USUAL = Bias(PRIOR_BIAS_M, PRIOR_SHARE, PRIOR_FAR_PER_M)


def bias_before_merging(systems: Sequence[Planes], apart: Sequence[Pairs]) -> Bias:
    """The per-track bias from a mixture of "one surface" and "any distance" over near, overlapping pairs (E7).

    `apart`, per system: pairs that single frames show at different offsets; a wall and the door set back in it say nothing about bias.
    """
    parts = [_Telling(planes, pairs).log_likelihood for planes, pairs in zip(systems, apart, strict=True)]
    found = [_climbed(parts, replace(USUAL, constant_m=constant)) for constant in STARTS_M]
    return max(found, key=lambda bias: _log_posterior(parts, bias))


def bias_of_merged(systems: Sequence[Planes], partitions: Sequence[Array], guess: Bias) -> Bias:
    """The same once `partitions` (T,) say which tracks are one plane: restricted likelihood of the tracks about their planes (E7b).

    The planes' covariances are those without the bias. The grid is climbed from `guess`.
    """
    return _climbed([_Merged(planes, plane).log_likelihood for planes, plane in zip(systems, partitions, strict=True)], guess)


def _log_posterior(parts: Sequence[Callable[[Bias], float]], bias: Bias) -> float:
    ratios = np.array([bias.constant_m / PRIOR_BIAS_M, bias.share / PRIOR_SHARE, bias.far_per_m / PRIOR_FAR_PER_M])
    return sum((part(bias) for part in parts), -0.5 * float(((np.log(ratios) / SPREAD) ** 2).sum()))


def _climbed(parts: Sequence[Callable[[Bias], float]], guess: Bias) -> Bias:
    """The top of the posterior on the grid, one step at a time from `guess`."""
    grids = (BIAS_GRID_M, SHARE_GRID, FAR_GRID)
    at = BIAS_GRID_M.index(guess.constant_m), SHARE_GRID.index(guess.share), FAR_GRID.index(guess.far_per_m)
    known = dict[tuple[int, int, int], float]()
    while True:
        steps = [(step * (k == 0), step * (k == 1), step * (k == 2)) for k, step in product(range(3), (-1, 1))]
        near = [at, *((at[0] + i, at[1] + k, at[2] + m) for i, k, m in steps)]
        near = [place for place in near if all(0 <= i < len(grid) for i, grid in zip(place, grids, strict=True))]
        for place in near:
            if place not in known:
                known[place] = _log_posterior(parts, _bias_at(place))
        best = max(near, key=known.__getitem__)
        if best == at:
            return _bias_at(at)
        at = best


def _bias_at(place: tuple[int, int, int]) -> Bias:
    return Bias(BIAS_GRID_M[place[0]], SHARE_GRID[place[1]], FAR_GRID[place[2]])


class _Telling:
    """Pairs of one system whose distance speaks about bias."""

    def __init__(self, planes: Planes, apart: Pairs) -> None:
        pairs = pairs_within(planes, WINDOW_M)
        count = len(planes.tracks)
        together = np.isin(pairs.first * count + pairs.second, apart.first * count + apart.second)
        variance = pair_variance_m2(planes, pairs)
        telling = (variance < WELL_KNOWN_M**2) & (gaps_m(planes, pairs) == 0.0) & ~together
        self.delta_m = (planes.offset_m[pairs.first] - planes.offset_m[pairs.second])[telling]
        self.variance_m2, self.planes = variance[telling], planes
        self.first, self.second = pairs.first[telling], pairs.second[telling]

    def log_likelihood(self, bias: Bias) -> float:
        """Of the likeliest share of pairs that are one surface."""
        each = bias.of(self.planes) ** 2
        total = self.variance_m2 + each[self.first] + each[self.second]
        same = np.exp(-0.5 * self.delta_m**2 / total) / np.sqrt(2 * np.pi * total)
        return max(float(np.log(share * same + (1 - share) / (2 * WINDOW_M)).sum()) for share in SAME_GRID)


class _Merged:
    """Tracks of one system with the planes they were merged to."""

    def __init__(self, planes: Planes, plane: Array) -> None:
        few = np.arange(min(len(plane), MOST_TRACKS))
        member = np.unique(plane[few], return_inverse=True)[1]
        self.G = np.zeros((len(few), int(member.max(initial=-1)) + 1))
        self.G[few, member] = 1.0
        self.covariance_m2 = planes.covariance_m2[np.ix_(few, few)]
        self.offset_m, self.planes, self.few = planes.offset_m[few], planes, few

    def log_likelihood(self, bias: Bias) -> float:
        """Of the tracks, planes integrated out."""
        return _restricted(self.covariance_m2 + np.diag(bias.of(self.planes)[self.few] ** 2), self.G, self.offset_m)


def _restricted(covariance: Array, G: Array, offset_m: Array) -> float:
    """Log likelihood of `offset = G plane + error` with the planes integrated out."""
    lower = cholesky(covariance, lower=True, check_finite=False)
    white = solve_triangular(lower, np.column_stack([G, offset_m]), lower=True, check_finite=False)
    inner = cholesky(white[:, :-1].T @ white[:, :-1], lower=True, check_finite=False)
    fitted = solve_triangular(inner, white[:, :-1].T @ white[:, -1], lower=True, check_finite=False)
    log_det = 2 * float(np.log(np.diag(lower)).sum() + np.log(np.diag(inner)).sum())
    return -0.5 * (log_det + float(white[:, -1] @ white[:, -1] - fitted @ fitted))
