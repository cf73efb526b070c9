"""The size of the odometry's errors by marginal likelihood: what the tracks say about it with everything else integrated out."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from floorplan.chain import log_marginal_likelihood
from floorplan.errors import NoSolutionError
from floorplan.model.checks import Array
from floorplan.model.noise import DriftModel, ScanNoise
from floorplan.weighted import LEVEL_AXES, build_system
from floorplan.windows import Window

RATE_FLOOR, RATE_CEILING = 5e-4, 2.0  # m per sqrt(m): the chain needs a variance; beyond, odometry says nothing
PART_FLOOR, PART_CEILING = 1e-3, 0.2  # parts of the step; beyond 20 % it is a fault, not drift
SPANS = (np.log(2.0), np.log(2.0), np.log(1.5))  # half width of the parabola through three likelihoods, per sweep
LARGEST_MOVE = 2.0  # spans; a parabola that opens downwards far away is not to be trusted
FORGOTTEN = 1e-10  # share of a column not worth carrying on; at 1e-8 likelihoods still change by more than one
WINDOWS_ASKED = 3  # spread over the scan; more would not change two digits


def within_bounds(drift: DriftModel) -> DriftModel:
    """The drift model with every size inside what odometry can be."""
    return replace(
        drift,
        rate_m_per_sqrt_m=float(np.clip(drift.rate_m_per_sqrt_m, RATE_FLOOR, RATE_CEILING)),
        scale_sigma=float(np.clip(drift.scale_sigma, PART_FLOOR, PART_CEILING)),
        sideways_sigma=float(np.clip(drift.sideways_sigma, PART_FLOOR, PART_CEILING)),
    )


def most_likely(noise: ScanNoise, pieces: Sequence[Window]) -> ScanNoise:
    """Rate, scale and sideways sizes and one factor on all measurement sigmas that make the x-y rows most likely.

    Coordinate search in the logarithms, a parabola through three values at a time.
    """
    asked = [w for w in _spread(pieces) if np.isin(w.graph.axis, LEVEL_AXES).any()]
    if not asked:
        return noise
    at = np.log([noise.drift.rate_m_per_sqrt_m, noise.drift.scale_sigma, noise.drift.sideways_sigma, 1.0])
    best = _likelihood(noise, asked, at)
    for span in SPANS:
        for k in range(len(at)):
            for move in _moves(noise, asked, at, k, best, span):
                at, best = move, _likelihood(noise, asked, move)
    return _with(noise, at)


def _moves(noise: ScanNoise, asked: Sequence[Window], at: Array, k: int, best: float, span: float) -> list[Array]:
    """The better place along coordinate k, or nothing."""
    step = np.zeros(len(at))
    step[k] = span
    low, high = _likelihood(noise, asked, at - step), _likelihood(noise, asked, at + step)
    bend = low + high - 2 * best
    if bend < 0:
        along = float(np.clip(0.5 * (low - high) / bend, -LARGEST_MOVE, LARGEST_MOVE))
    else:
        along = LARGEST_MOVE if high > low else -LARGEST_MOVE
    candidates = [(max(low, high), at + step * (1.0 if high > low else -1.0))]
    there = at + step * along
    candidates.append((_likelihood(noise, asked, there), there))
    value, place = max(candidates, key=lambda c: c[0])
    return [place] if value > best else []


def _likelihood(noise: ScanNoise, asked: Sequence[Window], at: Array) -> float:
    tried = _with(noise, at)
    total = 0.0
    for window in asked:
        system = build_system(window.graph, replace(tried, sigma_m=tried.sigma_m[window.rows]), LEVEL_AXES, FORGOTTEN)
        total += log_marginal_likelihood(system.reduced)
    if not np.isfinite(total):
        raise NoSolutionError("The likelihood of the odometry's drift is not finite: check distances and translations for NaN.")
    return total


def _with(noise: ScanNoise, at: Array) -> ScanNoise:
    rate, scale, sideways, factor = np.exp(at)
    drift = replace(noise.drift, rate_m_per_sqrt_m=float(rate), scale_sigma=float(scale), sideways_sigma=float(sideways))
    return replace(noise, drift=within_bounds(drift), sigma_m=noise.sigma_m * factor)


def _spread(pieces: Sequence[Window]) -> list[Window]:
    places = np.linspace(0, len(pieces) - 1, min(WINDOWS_ASKED, len(pieces))).round().astype(int)
    return [pieces[i] for i in np.unique(places)]
