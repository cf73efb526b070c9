"""What a scan says about its own errors: the odometry's drift and the weight of every measurement row."""

from dataclasses import dataclass

import numpy as np

from floorplan.model.checks import Array, freeze


@dataclass(frozen=True)
class DriftModel:
    """How far odometry can be trusted; all standard deviations.

    `rate_m_per_sqrt_m` white error of a step of 1 m (grows with the root of the path); `scale_sigma` and `sideways_sigma`
    sizes of the slowly varying rates along and across the step (parts of the step), correlated over
    `correlation_m` of path; `global_scale_sigma` prior of the one scale error of the whole scan.
    """

    rate_m_per_sqrt_m: float
    scale_sigma: float
    sideways_sigma: float
    correlation_m: float = 20.0
    global_scale_sigma: float = 0.05


@dataclass(frozen=True)
class VerticalDrift:
    """The same for the height: white `rate_m_per_sqrt_m` of path, and a slowly varying slope (rise per metre of path)."""

    rate_m_per_sqrt_m: float
    slope_sigma: float
    correlation_m: float = 20.0


@dataclass(frozen=True)
class ScanNoise:
    """Noise of one layout graph with K rows.

    `sigma_m (K,)` effective standard deviation of every measurement (down-weighted rows have a larger one, rejected
    rows infinity); `bias_sigma_m` error that all rows of one track share, `bias_share` the part of the sigma of its rows that
    is in it besides, and `bias_far_per_m` times the square of the distance it was seen from; `drift` of x and y, `vertical` of z;
    `flipped` rows rejected for their sign; `outliers` rows down-weighted by half or more. `step_m (N-1, 3)` the steps as last
    solved, of which scale and sideways rates are parts; None: none solved yet, odometry's own serve.
    """

    sigma_m: Array
    bias_sigma_m: float
    drift: DriftModel
    vertical: VerticalDrift
    flipped: int = 0
    outliers: int = 0
    step_m: Array | None = None
    bias_share: float = 0.0
    bias_far_per_m: float = 0.0

    def __post_init__(self) -> None:
        freeze(self, {"sigma_m": (np.float64, ("K",)), "step_m": (np.float64, ("T", 3))})
