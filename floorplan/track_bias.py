"""The error that all rows of one track share, by track: what is seen badly, from far or at a grazing angle, is also biased most."""

import numpy as np

from floorplan.model.checks import Array
from floorplan.model.graph import LayoutGraph
from floorplan.model.noise import ScanNoise


def track_bias_m(graph: LayoutGraph, noise: ScanNoise) -> Array:
    """Standard deviation (M,) of every track's bias (E7)."""
    return np.asarray(np.hypot(noise.bias_sigma_m, noise.bias_share * row_sigma_m(graph, noise)))


def row_sigma_m(graph: LayoutGraph, noise: ScanNoise) -> Array:
    """Standard deviation (M,) of one row of each track: of their mean, times the root of their number; 0 without a row that counts."""
    count = len(graph.axis)
    weight = np.bincount(graph.track, noise.sigma_m**-2.0, count)
    rows = np.bincount(graph.track, np.isfinite(noise.sigma_m), count)
    return np.asarray(np.sqrt(np.divide(rows, weight, out=np.zeros(count), where=weight > 0)))
