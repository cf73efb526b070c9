"""Whether depth values read as metres make rooms of a plausible size, from a few images."""

from collections.abc import Sequence
from pathlib import Path

import numpy as np

from floorplan.model.scan import Problem

SAMPLED_IMAGES = 9
ABSURD_M = (0.08, 20.0)  # a depth camera sees nothing nearer, and nothing beyond
USUAL_M = (0.4, 8.0)  # median of a walk through rooms; outside it the unit may still be right
COMMON_SCALES = (1000.0, 5000.0, 1.0, 100.0, 10000.0)  # per metre, the commonest first
TYPICAL_M = (0.8, 5.0)


def depth_unit_problems(paths: Sequence[Path], metres_per_unit: float) -> tuple[Problem, ...]:
    """Problems with the unit of 16-bit depth images, or with images that hold no depth at all."""
    picked = [paths[i] for i in np.unique(np.linspace(0, len(paths) - 1, SAMPLED_IMAGES).astype(int))]
    medians = [median for median in map(_median_value, picked) if median is not None]
    empty = sum(1 for median in medians if median == 0)
    if not medians:
        return ()  # damaged images are another problem's business
    if empty == len(medians):
        advice = "record again: the sensor saw nothing"
        return (Problem("depth-empty", "no depth in any image looked at", str(picked[0]), empty, advice, fatal=True),)
    median = float(np.median([m for m in medians if m]))
    metres = median * metres_per_unit
    if USUAL_M[0] <= metres <= USUAL_M[1]:
        return ()
    fatal = not ABSURD_M[0] <= metres <= ABSURD_M[1]
    message = f"half of the depth lies beyond {metres:.4g} m: {'wrong depth unit' if fatal else 'is the depth unit right?'}"
    return (Problem("depth-unit", message, str(picked[0]), advice=_advice(median, metres_per_unit), fatal=fatal),)


def _median_value(path: Path) -> float | None:
    """Median of the values that are not 0, 0 when there is none, None when the image cannot be read."""
    import cv2

    image = cv2.imread(str(path), cv2.IMREAD_UNCHANGED)
    if image is None:
        return None
    seen = image[image > 0]
    return float(np.median(seen)) if seen.size else 0.0


def _advice(median: float, metres_per_unit: float) -> str:
    now = f"set read.depth_scale (units per metre, now {1 / metres_per_unit:g})"
    for scale in COMMON_SCALES:
        if TYPICAL_M[0] <= median / scale <= TYPICAL_M[1]:
            return f"{now}; with {scale:g} it would be {median / scale:.2f} m"
    return now
