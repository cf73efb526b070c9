"""The error that all rows of one track share, from tracks that are probably one surface seen twice."""

import numpy as np

from floorplan.merge.evidence_pairs import Planes, gaps_m, pair_variance_m2, pairs_within
from floorplan.model.checks import Array

WELL_KNOWN_M = 0.02  # pairs whose distance odometry knows better than this speak about bias and not about drift
WINDOW_M = 0.3  # distances looked at; beyond, two tracks are certainly two surfaces
BIAS_GRID_M = np.array([0.001, 0.0015, 0.002, 0.003, 0.004, 0.006, 0.008, 0.011, 0.015, 0.02, 0.028, 0.04])
SAME_GRID = np.array([0.2, 0.4, 0.6, 0.8, 0.95])  # share of the pairs that are one surface
PRIOR_BIAS_M = 0.004  # where a scan says nothing: depth errors common to a track that indoor sensors show
PRIOR_PAIRS = 4.0  # the prior counts as this many pairs


def bias_sigma_m(planes: Planes) -> float:
    """Standard deviation of the per-track bias: a mixture of "one surface" and "any distance" over near, overlapping pairs (E7)."""
    pairs = pairs_within(planes, WINDOW_M)
    variance = pair_variance_m2(planes, pairs)
    delta = planes.offset_m[pairs.first] - planes.offset_m[pairs.second]
    telling = (variance < WELL_KNOWN_M**2) & (gaps_m(planes, pairs) == 0.0)
    likelihood = _log_likelihood(delta[telling], variance[telling])
    likelihood -= PRIOR_PAIRS * 0.5 * np.log(BIAS_GRID_M / PRIOR_BIAS_M)[:, None] ** 2
    return float(BIAS_GRID_M[np.unravel_index(np.argmax(likelihood), likelihood.shape)[0]])


def _log_likelihood(delta: Array, variance: Array) -> Array:
    table = np.zeros((len(BIAS_GRID_M), len(SAME_GRID)))
    for i, bias in enumerate(BIAS_GRID_M):
        total = variance + 2 * bias**2
        same = np.exp(-0.5 * delta**2 / total) / np.sqrt(2 * np.pi * total)
        for k, share in enumerate(SAME_GRID):
            table[i, k] = np.log(share * same + (1 - share) / (2 * WINDOW_M)).sum()
    return table
