"""Distances measured by hand between planes of the solution: rows `m_upper - m_lower = L`."""

from dataclasses import dataclass, replace

import numpy as np

from floorplan.model.checks import Array, freeze


@dataclass(frozen=True)
class DistanceTies:
    """T rows: `lower (T,)`, `upper (T,)` final planes (indices, as in LayoutSolution); `length_m (T,)`; `sigma_m (T,)`.

    `scale_sigma`: how well the common scale of all distances is known before these rows; `bias_sigma_m` of one surface: what the
    sensor gets wrong in the same way all scan long, so that the distance in the scan is another one than the measured.
    """

    lower: Array
    upper: Array
    length_m: Array
    sigma_m: Array
    scale_sigma: float = 0.0
    bias_sigma_m: float = 0.0

    def __post_init__(self) -> None:
        freeze(
            self,
            {"lower": (np.int64, ("T",)), "upper": (np.int64, ("T",)), "length_m": (np.float64, ("T",)), "sigma_m": (np.float64, ("T",))},
        )

    def __len__(self) -> int:
        return len(self.lower)

    def matrix(self, planes: int) -> Array:
        """`H (T, planes)`: `H m` are the distances."""
        H = np.zeros((len(self), planes))
        row = np.arange(len(self))
        np.add.at(H, (row, self.upper), 1.0)
        np.add.at(H, (row, self.lower), -1.0)
        return H

    def only(self, kept: Array) -> "DistanceTies":
        """The rows of the boolean or index array `kept`."""
        return replace(self, lower=self.lower[kept], upper=self.upper[kept], length_m=self.length_m[kept], sigma_m=self.sigma_m[kept])


@dataclass(frozen=True)
class TiedDistance:
    """What became of one measured distance: `before_m` the plan without any, `after_m` with all, `predicted_m` with all but this one.

    `predicted_sigma_m` of that prediction; `used` False where it was left out because everything else contradicts it.
    """

    line: int
    name: str
    measured_m: float
    sigma_m: float
    before_m: float
    after_m: float
    predicted_m: float
    predicted_sigma_m: float
    used: bool


@dataclass(frozen=True)
class Calibration:
    """A plan calibrated by tape: the common `scale` of all distances (1 where too few say so), its sigma, every row, sentences.

    `plan_quarters`, `plan_shift_m` (x, y): the frame of the plan in which the distances were measured; the calibrated plan keeps it.
    """

    scale: float
    scale_sigma: float
    rows: tuple[TiedDistance, ...]
    warnings: tuple[str, ...] = ()
    plan_quarters: int = 0
    plan_shift_m: tuple[float, float] = (0.0, 0.0)
