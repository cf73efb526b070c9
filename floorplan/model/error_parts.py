"""What the errors of a distance come from: each part of the variance by its cause."""

from dataclasses import dataclass
from enum import StrEnum

import numpy as np

from floorplan.model.checks import Array, freeze


class ErrorCause(StrEnum):
    """Why a distance may be off."""

    PATH = "path"  # noise of the rows, and the odometry's drift between the places that the surfaces were seen from
    SURFACES = "surfaces"  # what all sightings of one surface share
    MERGES = "merges"  # surfaces taken for one that may be two
    SCALE = "scale"  # of the sensor's ranges, stated or known by tape
    SENSOR = "sensor"  # its constant bias, stated
    TAPE = "tape"  # of the distances measured by hand


STORED = tuple(cause for cause in ErrorCause if cause is not ErrorCause.PATH)  # the path's part is what these leave


@dataclass(frozen=True)
class SigmaParts:
    """Standard deviations whose squares add up to that of one distance, metres, one for each `ErrorCause`."""

    path_m: float
    surfaces_m: float
    merges_m: float
    scale_m: float
    sensor_m: float
    tape_m: float

    @property
    def by_size(self) -> tuple[tuple[ErrorCause, float], ...]:
        """Every cause with its standard deviation, the one to do something about first."""
        sizes = (self.path_m, self.surfaces_m, self.merges_m, self.scale_m, self.sensor_m, self.tape_m)
        return tuple(sorted(zip(ErrorCause, sizes, strict=True), key=lambda part: -part[1]))


@dataclass(frozen=True)
class ErrorParts:
    """Parts of the joint covariance of L planes: `covariance_m2 (len(STORED), L, L)`, in that order; what is left is the path's.

    Four bytes a number: parts are told in per cent.
    """

    covariance_m2: Array

    def __post_init__(self) -> None:
        freeze(self, {"covariance_m2": (np.float32, (len(STORED), "L", "L"))})

    def with_added(self, cause: ErrorCause, covariance_m2: Array) -> "ErrorParts":
        """The parts with that much more of one cause."""
        whole = self.covariance_m2.copy()
        whole[STORED.index(cause)] += covariance_m2
        return ErrorParts(whole)

    def seen_through(self, gain: Array) -> "ErrorParts":
        """The parts of planes that are `gain (M, L)` times these."""
        return ErrorParts(gain @ self.covariance_m2 @ gain.T)

    def of_distance(self, a: int, b: int, sigma_m: float) -> SigmaParts:
        """The parts of the distance between planes a and b, whose standard deviation is `sigma_m`."""
        C = self.covariance_m2
        variance = np.maximum(C[:, a, a].astype(np.float64) + C[:, b, b] - 2.0 * C[:, a, b], 0.0)
        path = max(sigma_m**2 - float(variance.sum()), 0.0)
        return SigmaParts(*np.sqrt([path, *variance]).tolist())


def no_parts(planes: int) -> ErrorParts:
    """Of planes of whose errors nothing is known yet."""
    return ErrorParts(np.zeros((len(STORED), planes, planes), dtype=np.float32))
