"""By how much flat surfaces come out bent: the sensor's own ripple, and what single segments show beyond it."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from floorplan.model.checks import Array
from floorplan.segments.values import SegmentedChunk

_LEAST_BLOCKS = 12  # of a segment whose ripple can be told from noise
_ORDINARY = 2.0  # the sensor's own ripple varies by this factor from surface to surface
_BY_CHANCE = 2.0  # standard deviations of what white noise alone makes of a ripple


@dataclass(frozen=True)
class Ripple:
    """`sensor_m` of the typical flat surface; `own_m (S,)` of each segment where it is out of the ordinary: two surfaces in one, a pane
    before a wall."""

    sensor_m: float
    own_m: Array


def ripple_of(chunks: Sequence[SegmentedChunk]) -> Ripple:
    """The ripple of a whole recording, from the larger segments' blocks of pixels; chunks in the order of their segments."""
    square = np.concatenate([np.zeros(0), *(c.ripple_m2 for c in chunks)])
    large = np.concatenate([np.zeros(0), *(c.blocks for c in chunks)]) >= _LEAST_BLOCKS
    typical = max(float(np.median(square[large])), 0.0) if large.any() else 0.0
    excess = square - _ORDINARY**2 * typical
    own = large & (excess > _BY_CHANCE * _of_white_noise_m2(chunks))
    return Ripple(float(np.sqrt(typical)), np.sqrt(np.where(own, excess, 0.0)))


def _of_white_noise_m2(chunks: Sequence[SegmentedChunk]) -> Array:
    """Standard deviation (S,) of the ripple of flat surfaces whose pixels err alone, as the mean of `blocks` squares.

    Those squares have the mean `blocks sigma_m^2` (a segment's sigma is that of the mean of its blocks), of which the ripple is a part.
    """
    each = (np.sqrt(2.0 / np.maximum(c.blocks, 1)) * np.maximum(c.blocks * c.segments.sigma_m**2 - c.ripple_m2, 0.0) for c in chunks)
    return np.concatenate([np.zeros(0), *each])
