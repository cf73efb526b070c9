"""The error that all rows of one track share, by track: what is seen badly, from far or at a grazing angle, is also biased most."""

import numpy as np

from floorplan.model.checks import Array
from floorplan.model.graph import LayoutGraph
from floorplan.model.noise import ScanNoise


def track_bias_m(graph: LayoutGraph, noise: ScanNoise) -> Array:
    """Standard deviation (M,) of every track's bias (E7)."""
    own, far = noise.bias_share * row_sigma_m(graph, noise), noise.bias_far_per_m * square_range_m2(graph, noise)
    return np.asarray(np.sqrt(noise.bias_sigma_m**2 + own**2 + far**2))


def row_sigma_m(graph: LayoutGraph, noise: ScanNoise) -> Array:
    """Standard deviation (M,) of one row of each track: of their mean, times the root of their number; 0 without a row that counts."""
    count = len(graph.axis)
    weight = np.bincount(graph.track, noise.sigma_m**-2.0, count)
    rows = np.bincount(graph.track, np.isfinite(noise.sigma_m), count)
    return np.asarray(np.sqrt(np.divide(rows, weight, out=np.zeros(count), where=weight > 0)))


def square_range_m2(graph: LayoutGraph, noise: ScanNoise) -> Array:
    """Mean square (M,) of the distances that each track was seen from, along its axis; 0 without a row that counts."""
    count = len(graph.axis)
    weight = noise.sigma_m**-2.0
    total = np.bincount(graph.track, weight, count)
    square = np.bincount(graph.track, weight * graph.distance_m**2, count)
    return np.asarray(np.divide(square, total, out=np.zeros(count), where=total > 0))
