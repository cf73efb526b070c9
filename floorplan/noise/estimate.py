"""Noise from the scan itself: robust weights, a sigma per track, the odometry's drift. See docs/back-end.md, "Noise"."""

from dataclasses import replace

import numpy as np

from floorplan.elimination.weighted import LEVEL_AXES, UPRIGHT_AXES, solve, systems
from floorplan.elimination.windows import Window, windows
from floorplan.model.checks import Array
from floorplan.model.graph import LayoutGraph
from floorplan.model.noise import DriftModel, ScanNoise, VerticalDrift
from floorplan.model.normal import MAD_TO_SIGMA
from floorplan.noise.drift_likelihood import most_likely, vertical_within_bounds, within_bounds
from floorplan.noise.structure import growth

TRUSTED_SIGMAS = 2.5  # residuals up to here count in full, beyond with weight (2.5 / r)^2: 1 % of Gaussian errors lose a little
POOL_ROWS = 10.0  # a track's own variance counts against the pooled one as its rows against this many
SIGMA_FLOOR_M = 0.001  # no range sensor is better over a whole segment
SIGN_SLACK_SIGMAS = 4.0  # a distance this close to zero may have either sign
OUTLIER_WEIGHT = 0.5
LONELY_SIGMA_M = 1.0  # a track whose every row was rejected still has a place, roughly
WINDOW_FRAMES = 1000  # enough path (100 m and more) to see rates correlated over 20 m; keeps memory flat
NEIGHBOURS = (-2, -1, 0, 1, 2)  # rows of the running median


def estimate_noise(graph: LayoutGraph, reweightings: int = 2) -> ScanNoise:
    """Noise of every row and the drift model, from the graph alone."""
    signed = graph.distance_m * graph.facing[graph.track]
    level, upright = growth(graph, signed < 0, LEVEL_AXES), growth(graph, signed < 0, UPRIGHT_AXES)
    known = level or upright
    pooled = max(known.sigma_m if known else 0.0, SIGMA_FLOOR_M)
    wrong = signed > SIGN_SLACK_SIGMAS * pooled
    drift = DriftModel(level.rate_m_per_sqrt_m, level.scale, level.sideways) if level else DriftModel(0.0, 0.0, 0.0)
    drift = within_bounds(drift)
    vertical = VerticalDrift(upright.rate_m_per_sqrt_m, upright.sideways) if upright else VerticalDrift(drift.rate_m_per_sqrt_m, 0.0)
    noise = ScanNoise(_first_sigma(graph, ~wrong, pooled), 0.0, drift, vertical_within_bounds(vertical), int(wrong.sum()))
    pieces = windows(graph, WINDOW_FRAMES)
    for _ in range(reweightings):
        noise = _reweighted(graph, noise, ~wrong, pieces)
    return _with_heading(most_likely(noise, pieces), graph.heading_sigma_rad)


def _with_heading(noise: ScanNoise, heading_sigma_rad: float) -> ScanNoise:
    """A yaw off by an angle turns every step by it, sideways; inside one track that does not show where matching made the rows agree."""
    sideways = max(noise.drift.sideways_sigma, heading_sigma_rad)
    return replace(noise, drift=within_bounds(replace(noise.drift, sideways_sigma=sideways)))


def with_steps(noise: ScanNoise, position_m: Array) -> ScanNoise:
    """The noise with the steps between solved positions (N, 3) as what the odometry's rates are parts of."""
    return replace(noise, step_m=np.diff(position_m, axis=0))


def windowed(noise: ScanNoise, window: Window) -> ScanNoise:
    """The noise of one window's rows."""
    step = None if noise.step_m is None else noise.step_m[window.first_frame : window.first_frame + len(window.graph.translation_m)]
    return replace(noise, sigma_m=noise.sigma_m[window.rows], step_m=step)


def _first_sigma(graph: LayoutGraph, usable: Array, pooled_m: float) -> Array:
    """Down-weight rows that stand off the running median of their own track, before anything is solved."""
    rows = np.nonzero(usable)[0]
    rows = rows[np.lexsort((graph.frame[rows], graph.track[rows]))]
    dead = np.vstack([np.zeros(3), np.cumsum(graph.translation_m, axis=0)])
    track = graph.track[rows]
    level = graph.distance_m[rows] + dead[graph.frame[rows], graph.axis[track]]
    around = []
    for shift in NEIGHBOURS:
        other = np.clip(np.arange(len(rows)) + shift, 0, max(len(rows) - 1, 0))
        around.append(np.where(track[other] == track, level[other], level))
    off = level - np.median(around, axis=0)
    scale = max(pooled_m, MAD_TO_SIGMA * float(np.median(np.abs(off)))) if len(off) else pooled_m
    sigma = np.full(len(graph.track), np.inf)
    shape = _shape(graph)
    sigma[rows] = pooled_m * shape[rows] / np.sqrt(_robust_weight(off / (scale * shape[rows])))
    return _with_lonely_tracks(graph, sigma)


def _shape(graph: LayoutGraph) -> Array:
    """How the sigmas of the rows compare (K,), median 1: from the graph's own sigmas where it has them."""
    if graph.sigma_m is None or len(graph.sigma_m) == 0:
        return np.ones(len(graph.track))
    return np.asarray(graph.sigma_m / np.median(graph.sigma_m))


def _robust_weight(standardised: Array) -> Array:
    return np.asarray(np.minimum(1.0, (TRUSTED_SIGMAS / np.maximum(np.abs(standardised), TRUSTED_SIGMAS)) ** 2))


def _with_lonely_tracks(graph: LayoutGraph, sigma_m: Array) -> Array:
    heard = np.bincount(graph.track, np.isfinite(sigma_m), len(graph.axis)) > 0
    return np.where(heard[graph.track], sigma_m, LONELY_SIGMA_M)


def _reweighted(graph: LayoutGraph, noise: ScanNoise, usable: Array, pieces: list[Window]) -> ScanNoise:
    """One step of iteratively reweighted least squares: residuals, a sigma per track, robust weights."""
    fitted, step = _solved(graph, noise, pieces)
    residual = np.where(usable, graph.distance_m - fitted, 0.0)
    shape = _shape(graph)
    least = np.full(len(graph.axis), np.inf)
    np.minimum.at(least, graph.track, noise.sigma_m / shape)  # the sigma of a row that fits well is that of its track
    weight = _robust_weight(residual / (least[graph.track] * shape)) * usable
    count = np.bincount(graph.track, usable, len(graph.axis))
    total = np.bincount(graph.track, weight * (residual / shape) ** 2, len(graph.axis))
    pool = total.sum() / max(count.sum(), 1.0)
    own = np.maximum(np.sqrt((total + POOL_ROWS * pool) / (count + POOL_ROWS)), SIGMA_FLOOR_M)[graph.track] * shape
    weight = _robust_weight(residual / own)
    sigma = np.where(usable, own / np.sqrt(weight), np.inf)
    outliers = int((usable & (weight < OUTLIER_WEIGHT)).sum())
    return replace(noise, sigma_m=_with_lonely_tracks(graph, sigma), outliers=outliers, step_m=step)


def _solved(graph: LayoutGraph, noise: ScanNoise, pieces: list[Window]) -> tuple[Array, Array]:
    """Fitted distance (K,) of every row and fitted steps (N-1, 3), by least squares window by window."""
    fitted, step = graph.distance_m.copy(), graph.translation_m.copy()
    for window in pieces:
        g = window.graph
        for system in systems(g, windowed(noise, window)):
            axes, solved, offset = system.axes, solve(system), np.zeros(len(g.axis))
            offset[system.tracks], place = solved.offset_m, solved.position_m
            mine = np.nonzero(np.isin(g.axis[g.track], axes))[0]
            fitted[window.rows[mine]] = offset[g.track[mine]] - place[g.frame[mine], g.axis[g.track[mine]] - axes[0]]
            step[window.first_frame : window.first_frame + len(g.translation_m), list(axes)] = np.diff(place, axis=0)
    return fitted, step
