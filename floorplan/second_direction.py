"""A building with two Manhattan directions: a wing whose walls are square to each other, but not to the rest."""

from dataclasses import dataclass

import numpy as np

from floorplan.model.checks import Array
from floorplan.model.scan import Problem
from floorplan.model.segment import AXIS_Z, SegmentedScan

CODE = "two-directions"
BIN_DEG = 1.0
PEAK_DEG = 3.0  # walls of one wing agree to this
MIN_SHARE = 0.10  # of all wall seen, on each of its two directions: a skewed wall has one, a round hall has many
QUARTER_DEG = 90.0


@dataclass(frozen=True)
class SecondDirection:
    """`angle_deg` off the first one, 0 to 90; `share` of the wall seen that follows it, both of its directions together."""

    angle_deg: float
    share: float


def second_direction(segmented: SegmentedScan) -> SecondDirection | None:
    """The second direction, weighted by pixels of upright surfaces; None where there is none."""
    patches, segments = segmented.free_patches, segmented.segments
    along = float(segments.pixels[segments.axis != AXIS_Z].sum())
    whole = along + float(patches.pixels.sum())
    if not len(patches.pixels) or whole == 0:
        return None
    angle = np.degrees(patches.normal_yaw_rad) % (2 * QUARTER_DEG)  # a wall's two sides count as one direction
    folded, square = angle % QUARTER_DEG, (angle // QUARTER_DEG).astype(int) % 2
    peak = _peak_deg(folded, patches.pixels)
    near = np.abs(_off_deg(folded, peak)) < PEAK_DEG
    shares = [float(patches.pixels[near & (square == side)].sum()) / whole for side in range(2)]
    return SecondDirection(peak, sum(shares)) if min(shares) >= MIN_SHARE else None


def _peak_deg(folded: Array, weight: Array) -> float:
    """The angle modulo 90 degrees about which most weight lies."""
    count = int(QUARTER_DEG / BIN_DEG)
    votes = np.bincount((folded / BIN_DEG).astype(int) % count, weight, count)
    width = int(PEAK_DEG / BIN_DEG)
    smooth = sum(np.roll(votes, shift) for shift in range(-width, width + 1))
    off = _off_deg(folded, (float(np.argmax(smooth)) + 0.5) * BIN_DEG)
    near = np.abs(off) < 2 * PEAK_DEG
    return float((np.argmax(smooth) + 0.5) * BIN_DEG + np.average(off[near], weights=weight[near])) % QUARTER_DEG


def _off_deg(folded: Array, middle: float) -> Array:
    """Angle off `middle`, -45 to 45 degrees."""
    return np.asarray((folded - middle + QUARTER_DEG / 2) % QUARTER_DEG - QUARTER_DEG / 2)


def direction_problems(segmented: SegmentedScan) -> tuple[Problem, ...]:
    """The coded problem, where there are two directions."""
    found = second_direction(segmented)
    if found is None:
        return ()
    message = f"the walls show two Manhattan directions: {100 * found.share:.0f} % of them lie {found.angle_deg:.0f} degrees off the others"
    return (Problem(CODE, message, "", 1, "that wing is drawn in lines off the axes; scan it on its own for a plan of it"),)
