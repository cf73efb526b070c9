"""How far the depth itself is off, where the scan shows it: a scale against the odometry's, and a constant offset.

A camera that reads `(1 + k) z + c` for a depth of z moves a plane at distance d, met at depth z, by `k d + c d / z`. The first looks
like an odometry whose steps are too short by k: against the odometry alone it shows. The second depends on how a plane is met: near,
far, at an angle.
The likelihood of a layout graph is quadratic in both (distances enter linearly), so a few values of it give the estimate.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from floorplan.elimination.frontal import log_marginal_likelihood
from floorplan.elimination.weighted import LEVEL_AXES, UPRIGHT_AXES, build_system
from floorplan.elimination.windows import Window, windows
from floorplan.model.checks import Array
from floorplan.model.graph import LayoutGraph, LeastSquaresSolution
from floorplan.model.noise import DriftModel, ScanNoise
from floorplan.model.range_bias import RangeBias
from floorplan.model.scan import SensorKind
from floorplan.model.segment import NO_TRACK, Segments, Tracks
from floorplan.noise.estimate import windowed

_STEP = (1e-3, 1e-3)  # of scale (a part) and offset (m): the likelihood is quadratic, any step would do
_PIECES, _FEWEST_FRAMES = 10, 40  # stretches of the walk that err on their own
_ODOMETRY_SCALE_SIGMA = 0.01  # visual-inertial tracking knows its own lasting scale to about a per cent: what differs may be its fault
_PRIOR_SIGMA = (0.05, 0.05)  # of a part, and m: no sensor in use is worse, and a scan that shows nothing says so


@dataclass(frozen=True)
class _Quadratic:
    """Minus the log likelihood about zero bias: `gradient (2,)`, `curvature (2, 2)`."""

    gradient: Array
    curvature: Array


def offset_lever(graph: LayoutGraph, segments: Segments, tracks: Tracks, kind: SensorKind) -> Array:
    """By how much each row (K,) of the graph moves per metre of constant offset: d / z for cameras, d / range for lasers."""
    used = np.flatnonzero(tracks.track_of_segment != NO_TRACK)
    centroid = segments.centroid_sensor_m[used]
    reach = centroid[:, 2] if kind is SensorKind.CAMERA else np.linalg.norm(centroid, axis=1)
    lever = segments.distance_m[used] / reach
    key = segments.frame[used].astype(np.int64) * len(tracks.axis) + tracks.track_of_segment[used]
    keys, place = np.unique(key, return_inverse=True)
    weight = segments.sigma_m[used] ** -2.0
    mean = np.bincount(place, weight * lever, len(keys)) / np.bincount(place, weight, len(keys))
    return np.asarray(mean[np.searchsorted(keys, graph.frame * len(tracks.axis) + graph.track)])


def estimate_range_bias(graph: LayoutGraph, noise: ScanNoise, solved: LeastSquaresSolution, lever: Array) -> RangeBias:
    """Scale and offset that make the graph's rows most likely; their standard deviations from how stretches of the walk differ.

    `lever (K,)` of each row per metre of offset. The scale's sigma contains the odometry's own, the offset's the sensor's bias
    (`range_accuracy`): a ripple or pattern of that size can look like it. Distances as fitted serve as what is scaled: shrinking
    the readings themselves would shrink their noise too, and look likely for that.
    """
    fitted_m = solved.track_offset_m[graph.track] - solved.position_m[graph.frame, graph.axis[graph.track]]
    columns = np.stack((fitted_m, lever), axis=1)
    frames = max(_FEWEST_FRAMES, -(-len(graph.stamp_s) // _PIECES))
    parts = [q for window in windows(graph, frames) for q in _quadratics(window, windowed(noise, window), columns[window.rows])]
    prior = np.diag(1 / np.square(_PRIOR_SIGMA))
    inverse = np.linalg.inv(sum((q.curvature for q in parts), prior))
    best = -inverse @ sum((q.gradient for q in parts), np.zeros(2))
    variance = np.diag(inverse) * max(_spread(parts, best), 1.0)
    bias_m = graph.range_accuracy.bias_sigma_m if graph.range_accuracy else 0.0
    scale_sigma = np.sqrt(variance[0] + _ODOMETRY_SCALE_SIGMA**2 + wandering_scale_variance(noise.drift, graph))
    return RangeBias(float(best[0]), float(scale_sigma), float(best[1]), float(np.hypot(np.sqrt(variance[1]), bias_m)))


def wandering_scale_variance(drift: DriftModel, graph: LayoutGraph) -> float:
    """Variance of the odometry's slowly varying scale in the mean over the whole path: neighbouring stretches err alike.

    `2 l / L (1 - l / L (1 - exp(-L / l)))` of its own, for the correlation `exp(-s / l)` over a path L.
    """
    path_m = float(np.linalg.norm(graph.translation_m[:, :2], axis=1).sum())
    part = drift.correlation_m / max(path_m, drift.correlation_m)
    return float(drift.scale_sigma**2 * 2 * part * (1 - part * (1 - np.exp(-1 / part))))


def _spread(parts: Sequence[_Quadratic], best: Array) -> float:
    """By how much the stretches' gradients vary more than independent rows would let them: chi-square per degree of freedom."""
    if len(parts) < 3:
        return 1.0
    total = 0.0
    for part in parts:
        left = part.gradient + part.curvature @ best
        total += float(left @ np.linalg.pinv(part.curvature, hermitian=True) @ left)
    return total / (2 * len(parts) - 2)


def _quadratics(window: Window, noise: ScanNoise, columns: Array) -> list[_Quadratic]:
    axes = [axes for axes in (LEVEL_AXES, UPRIGHT_AXES) if np.isin(window.graph.axis, axes).any()]
    return [_quadratic(window.graph, noise, columns, one) for one in axes]


def _quadratic(graph: LayoutGraph, noise: ScanNoise, columns: Array, axes: tuple[int, ...]) -> _Quadratic:
    """From six values of the likelihood."""

    def cost(scale_steps: float, offset_steps: float) -> float:
        off = columns @ (scale_steps * _STEP[0], offset_steps * _STEP[1])
        return -log_marginal_likelihood(build_system(replace(graph, distance_m=graph.distance_m - off), noise, axes).eliminated)

    middle, right, left, up, down, both = cost(0, 0), cost(1, 0), cost(-1, 0), cost(0, 1), cost(0, -1), cost(1, 1)
    gradient = np.array(((right - left) / 2, (up - down) / 2))
    mixed = both - middle - gradient.sum() - (right + left - 2 * middle) / 2 - (up + down - 2 * middle) / 2
    curvature = np.array(((right + left - 2 * middle, mixed), (mixed, up + down - 2 * middle)))
    return _Quadratic(gradient / _STEP, curvature / np.outer(_STEP, _STEP))
