"""What two aligned surveys say of one wall, with the uncertainty of both and of the alignment itself.

Of all wall pairs square to one axis, d = offset(second) - offset(first) has the covariance S = C_first + C_second. The shift between
the surveys is the mean of the d of those that stayed, m = w^T d, so a residual d - m has P S P^T with P = I - 1 w^T.
"""

from dataclasses import dataclass

import numpy as np

from floorplan.compare.pairs import PlanePair
from floorplan.model.checks import Array
from floorplan.model.normal import MAD_TO_SIGMA, NORMAL_95
from floorplan.model.plan import Plan

STAYED_M = 0.05  # from the median: what the mean shift is taken over; a wall that was moved must not pull it
STAYED_SIGMAS = 3.0  # ... or within this many spreads of all, where surveys are worse than that


@dataclass(frozen=True)
class AxisDifferences:
    """Per pair (K,) square to one axis: how much the second survey's wall lies further along it, and its standard deviation."""

    moved_m: Array
    sigma_m: Array
    shift_m: float


def axis_differences(first: Plan, second: Plan, pairs: tuple[PlanePair, ...]) -> AxisDifferences:
    """Residual offsets of pairs that are all square to one axis, `second` in `first`'s frame."""
    a, b = [pair.first for pair in pairs], [pair.second for pair in pairs]
    raw = np.array([second.planes[j].offset_m - first.planes[i].offset_m for i, j in zip(a, b, strict=True)])
    length = np.array([pair.length_m for pair in pairs])
    apart = np.abs(raw - np.median(raw))
    stayed = apart <= max(STAYED_M, STAYED_SIGMAS * MAD_TO_SIGMA * float(np.median(apart)))
    weight = np.where(stayed, length, 0.0)
    weight /= weight.sum()
    shift = float(weight @ raw)
    project = np.eye(len(raw)) - weight
    covariance = project @ (plane_covariance(first, a) + plane_covariance(second, b)) @ project.T
    return AxisDifferences(raw - shift, np.sqrt(np.maximum(np.diag(covariance), 0.0)), shift)


def plane_covariance(plan: Plan, planes: list[int]) -> Array:
    """Covariance (K, K) of the offsets of some planes; a plane may stand twice. As if independent where the plan has no covariance."""
    if plan.plane_covariance_m2 is not None:
        return np.asarray(plan.plane_covariance_m2[np.ix_(planes, planes)])
    variance = np.array([plan.planes[plane].sigma_m ** 2 for plane in planes])
    return np.asarray(np.where(np.equal.outer(planes, planes), variance[:, None], 0.0))


@dataclass(frozen=True)
class Repeatability:
    """How well two surveys agree: absolute differences in m; `share_within` inside their combined 95 % interval."""

    count: int
    median_m: float
    p95_m: float
    share_within: float


def repeatability(difference_m: Array, sigma_m: Array) -> Repeatability | None:
    """Over all that was found in both; None where nothing was."""
    apart = np.abs(difference_m)
    if len(apart) == 0:
        return None
    within = float(np.mean(apart <= NORMAL_95 * sigma_m))
    return Repeatability(len(apart), float(np.median(apart)), float(np.percentile(apart, 95)), within)
