"""The size of the odometry's errors by marginal likelihood: what the tracks say about it with everything else integrated out."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import TypeVar

import numpy as np

from floorplan.elimination.frontal import log_marginal_likelihood_of
from floorplan.elimination.weighted import LEVEL_AXES, UPRIGHT_AXES, AxesRows, arrange_rows, odometry_of
from floorplan.elimination.windows import Window
from floorplan.errors import NoSolutionError
from floorplan.model.checks import Array
from floorplan.model.graph import LayoutGraph
from floorplan.model.noise import DriftModel, ScanNoise, VerticalDrift
from floorplan.noise.lumps import lump_length_m, lumped

RATE_FLOOR, RATE_CEILING = 5e-4, 2.0  # m per sqrt(m): the chain needs a variance; beyond, odometry says nothing
PART_FLOOR, PART_CEILING = 1e-3, 0.2  # parts of the step; beyond 20 % it is a fault, not drift
SPANS = (np.log(2.0), np.log(1.6))  # half width of the parabola through three likelihoods, per sweep
LARGEST_MOVE = 2.0  # spans; a parabola that opens downwards far away is not to be trusted
LARGEST_DOUBT = 1.0  # variance of a logarithm: no wider than the priors below
BEND_TINY = 1e-9
TYPICAL_RATE, TYPICAL_PART, TYPICAL_SLOPE = 0.005, 0.01, 0.003  # odometry of cameras and wheels, where a short scan says nothing
RATE_SPREAD, PART_SPREAD = 1.2, 1.0  # of their logarithms: factors of 3 either way are ordinary, of 10 happen
LIKE_SPREAD = 0.7  # of the logarithm of scale over sideways: errors of one odometry along and across are of one size
FACTOR_SPREAD = 0.5  # of the logarithm of the one factor on all sigmas, which residuals have set already
WINDOWS_ASKED = 3  # spread over the scan; more would not change two digits


Drift = TypeVar("Drift", DriftModel, VerticalDrift)


@dataclass(frozen=True)
class _Asked:
    """A window, lumped: its graph, its rows of the axes asked about, the mean number of frames in a lump."""

    graph: LayoutGraph
    rows: AxesRows
    frames: float


def within_bounds(drift: DriftModel) -> DriftModel:
    """The drift model with every size inside what odometry can be."""
    return replace(
        drift,
        rate_m_per_sqrt_m=float(np.clip(drift.rate_m_per_sqrt_m, RATE_FLOOR, RATE_CEILING)),
        scale_sigma=float(np.clip(drift.scale_sigma, PART_FLOOR, PART_CEILING)),
        sideways_sigma=float(np.clip(drift.sideways_sigma, PART_FLOOR, PART_CEILING)),
    )


def vertical_within_bounds(drift: VerticalDrift) -> VerticalDrift:
    """The same for the height."""
    rate = float(np.clip(drift.rate_m_per_sqrt_m, RATE_FLOOR, RATE_CEILING))
    return replace(drift, rate_m_per_sqrt_m=rate, slope_sigma=float(np.clip(drift.slope_sigma, PART_FLOOR, PART_CEILING)))


def most_likely(noise: ScanNoise, pieces: Sequence[Window]) -> ScanNoise:
    """The sizes of the odometry's errors, and one factor on the measurement sigmas, that make the rows most likely.

    x and y first (rate, scale, sideways, factor), then z (rate, slope) with that factor.
    """
    drift, vertical, factor = noise.drift, noise.vertical, 1.0
    level = _asked(pieces, LEVEL_AXES, noise.sigma_m, drift.rate_m_per_sqrt_m)
    if level:
        start = np.log([drift.rate_m_per_sqrt_m, drift.scale_sigma, drift.sideways_sigma, 1.0])
        found = _climb(lambda at: _likelihood(_level_at(drift, at), vertical, float(np.exp(at[3])), level) + _level_prior(at), start)
        drift, factor = _level_at(drift, found), float(np.exp(found[3]))
    sigma_m = noise.sigma_m * factor
    upright = _asked(pieces, UPRIGHT_AXES, sigma_m, vertical.rate_m_per_sqrt_m)
    if upright:
        start = np.log([vertical.rate_m_per_sqrt_m, vertical.slope_sigma])
        found = _climb(lambda at: _likelihood(drift, _upright_at(vertical, at), 1.0, upright) + _upright_prior(at), start)
        vertical = _upright_at(vertical, found)
    return replace(noise, drift=drift, vertical=vertical, sigma_m=sigma_m)


def _climb(value_at: Callable[[Array], float], start: Array) -> Array:
    """Logarithms of the mean variances' roots: coordinate search for the largest value, a parabola through three values at a time.

    A size whose logarithm is known to `tau` has the mean variance `exp(2 at + 2 tau^2)`, so its root lies `tau^2` above the likeliest
    one; `tau` is that of the last parabolas. Without it intervals of short walks, which know these sizes least, are too narrow.
    """
    at, best, doubt = start, value_at(start), np.zeros(len(start))
    for span in SPANS:
        for k in range(len(at)):
            step = np.zeros(len(at))
            step[k] = span
            low, high = value_at(at - step), value_at(at + step)
            middle = best
            place = at + step * _top_of_parabola(low, middle, high)
            options = [(best, at), (low, at - step), (high, at + step), (value_at(place), place)]
            best, at = max(options, key=lambda option: option[0])
            doubt[k] = min(span**2 / max(2 * middle - low - high, BEND_TINY), LARGEST_DOUBT)
    return at + doubt


def _top_of_parabola(low: float, middle: float, high: float) -> float:
    """Where the parabola through (-1, low), (0, middle), (1, high) is highest, no further away than LARGEST_MOVE."""
    bend = low + high - 2 * middle
    if bend < 0:
        return float(np.clip(0.5 * (low - high) / bend, -LARGEST_MOVE, LARGEST_MOVE))
    return LARGEST_MOVE if high > low else -LARGEST_MOVE


def _likelihood(drift: DriftModel, vertical: VerticalDrift, factor: float, asked: Sequence[_Asked]) -> float:
    total = 0.0
    for piece in asked:
        chain = odometry_of(piece.graph, piece.rows, _over_lumps(drift, piece.frames), _over_lumps(vertical, piece.frames), None)
        total += log_marginal_likelihood_of(chain, piece.rows.arranged, factor)
    if not np.isfinite(total):
        raise NoSolutionError("The likelihood of the odometry's drift is not finite: check distances and translations for NaN.")
    return total


def _level_prior(at: Array) -> float:
    """Log prior of (rate, scale, sideways, factor): without it a short scan, by chance, calls its odometry perfect."""
    rate, scale, sideways, factor = at
    parts = ((scale - np.log(TYPICAL_PART)) ** 2 + (sideways - np.log(TYPICAL_PART)) ** 2) / PART_SPREAD**2
    white = ((rate - np.log(TYPICAL_RATE)) / RATE_SPREAD) ** 2 + (factor / FACTOR_SPREAD) ** 2
    return float(-0.5 * (parts + white + ((scale - sideways) / LIKE_SPREAD) ** 2))


def _upright_prior(at: Array) -> float:
    rate, slope = at
    return float(-0.5 * (((rate - np.log(TYPICAL_RATE)) / RATE_SPREAD) ** 2 + ((slope - np.log(TYPICAL_SLOPE)) / PART_SPREAD) ** 2))


def _level_at(drift: DriftModel, at: Array) -> DriftModel:
    rate, scale, sideways, _ = np.exp(at).tolist()
    return within_bounds(replace(drift, rate_m_per_sqrt_m=rate, scale_sigma=scale, sideways_sigma=sideways))


def _upright_at(vertical: VerticalDrift, at: Array) -> VerticalDrift:
    rate, slope = np.exp(at).tolist()
    return vertical_within_bounds(replace(vertical, rate_m_per_sqrt_m=rate, slope_sigma=slope))


def _over_lumps(drift: Drift, n: float) -> Drift:
    """White steps between the mean places of lumps of n frames have `(2 n^2 + 1) / (3 n^2)` of the variance of steps between frames."""
    return replace(drift, rate_m_per_sqrt_m=drift.rate_m_per_sqrt_m * ((2 * n**2 + 1) / (3 * n**2)) ** 0.5)


def _asked(pieces: Sequence[Window], axes: tuple[int, ...], sigma_m: Array, rate: float) -> list[_Asked]:
    useful = [piece for piece in pieces if np.isin(piece.graph.axis, axes).any()]
    places = np.linspace(0, len(useful) - 1, min(WINDOWS_ASKED, len(useful))).round().astype(int)
    length_m, asked = lump_length_m(sigma_m, rate), []
    for i in np.unique(places):
        graph, sigma = lumped(useful[i], sigma_m, length_m)
        asked.append(_Asked(graph, arrange_rows(graph, sigma, axes), len(useful[i].graph.stamp_s) / len(graph.stamp_s)))
    return asked
