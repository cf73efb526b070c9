"""Planes of accepted pairs where some pairs of tracks must never be one plane, not even through others."""

import numpy as np

from floorplan.merge.hypotheses import Pairs, numbered
from floorplan.model.checks import Array


def planes_kept_apart(tracks: int, accepted: Pairs, never: Pairs) -> Array:
    """Components (M,) of the accepted pairs, taken in the order given; a pair that would join two components holding a pair of
    `never` is left out."""
    label = np.arange(tracks)
    for first, second in zip(accepted.first, accepted.second, strict=True):
        a, b = label[first], label[second]
        x, y = label[never.first], label[never.second]
        if a != b and not (((x == a) & (y == b)) | ((x == b) & (y == a))).any():
            label[label == b] = a
    return numbered(label)
