"""How far the depth of a scan is off, as far as the scan itself shows it."""

from dataclasses import dataclass

from floorplan.model.normal import NORMAL_95


@dataclass(frozen=True)
class RangeBias:
    """`scale` by which ranges are too long against the odometry's steps (a part: of a true 1 m the sensor reads 1 + scale), `offset_m` by
    which every reading is too long; standard deviations."""

    scale: float
    scale_sigma: float
    offset_m: float
    offset_sigma_m: float

    @property
    def scale_is_significant(self) -> bool:
        """Whether zero lies outside the 95 % interval."""
        return abs(self.scale) > NORMAL_95 * self.scale_sigma

    @property
    def offset_is_significant(self) -> bool:
        """Whether zero lies outside the 95 % interval."""
        return abs(self.offset_m) > NORMAL_95 * self.offset_sigma_m
