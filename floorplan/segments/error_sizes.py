"""How large the errors of segments are, learnt from the recording itself.

Two parallel surfaces seen together in two keyframes give the double difference `(d_a - d_b) - (d_a' - d_b')`: how far apart they are
does not depend on where they are seen from, so it is zero but for the errors of four segments. Odometry drops out of it.
So does what lasts: a scale of the depth, and ripple that lies on a surface alike in both views.
"""

from dataclasses import dataclass

import numpy as np

from floorplan.model.checks import Array
from floorplan.model.segment import Segments
from floorplan.non_negative import non_negative_least_squares

_OTHER_VIEW_RAD, _OTHER_VIEW_M = np.deg2rad(8.0), 0.25  # so that the sensor's pattern lies elsewhere on the surface
_MOST_TOGETHER = 8  # parallel segments in one keyframe that are compared with each other
_FEWEST = 60  # double differences that tell three sizes
_ROUNDS = 8
_STRAY = 4.0  # standard deviations: two surfaces taken for one; nearer ones are views worse than most
_KEPT_VARIANCE = 0.9989  # of a normal variable cut off there
_NOISE_RANGE, _TURN_RANGE = (0.5, 5.0), (0.5, 2.0)  # factors on standard deviations; further off, something else is wrong
_LEAST_M2 = 1e-12


@dataclass(frozen=True)
class SegmentErrors:
    """What a segment's error is made of: `noise_m (S,)` of its pixels, `lever_m (S, 3)` by how much it moves per standard deviation of its
    keyframe's rotation about x, y, z."""

    noise_m: Array
    lever_m: Array


@dataclass(frozen=True)
class ErrorSizes:
    """Factors `noise` and `turn` on the standard deviations of `SegmentErrors`, and `hidden_m` that no pixel of a segment shows."""

    noise: float
    turn: float
    hidden_m: float


@dataclass(frozen=True)
class _DoubleDifferences:
    """`square_m2 (N,)`, and `segment (N, 4)`: surfaces a and b in one keyframe, a and b in another."""

    square_m2: Array
    segment: Array


def learnt_sizes(
    segments: Segments, surface: Array, errors: SegmentErrors, position_m: Array, world_from_sensor: Array
) -> ErrorSizes | None:
    """The sizes that explain the double differences best; None where there are too few.

    `surface (S,)` of each segment, `position_m (F, 3)` by odometry, `world_from_sensor (F, 3, 3)`.
    """
    seen = _double_differences(segments, surface, position_m, world_from_sensor)
    if len(seen.square_m2) < _FEWEST:
        return None
    a, b, c, d = seen.segment.T
    noise = (errors.noise_m[seen.segment] ** 2).sum(axis=1)
    turn = ((errors.lever_m[a] - errors.lever_m[b]) ** 2).sum(axis=1) + ((errors.lever_m[c] - errors.lever_m[d]) ** 2).sum(axis=1)
    sizes = np.sqrt(_variance_sizes(seen.square_m2, np.stack((noise, turn, np.full(len(noise), 4.0)), axis=1)))
    return ErrorSizes(float(np.clip(sizes[0], *_NOISE_RANGE)), float(np.clip(sizes[1], *_TURN_RANGE)), float(sizes[2]))


def _double_differences(segments: Segments, surface: Array, position_m: Array, world_from_sensor: Array) -> _DoubleDifferences:
    """Of every pair of surfaces, the views that lie half of their common life apart and differ."""
    a, b = _seen_together(segments)
    swap = surface[a] > surface[b]
    a, b = np.where(swap, b, a), np.where(swap, a, b)
    order = np.lexsort((segments.frame[a], surface[b], surface[a]))
    a, b = a[order], b[order]
    begins = np.concatenate(([True], (np.diff(surface[a]) != 0) | (np.diff(surface[b]) != 0)))[: len(a)]
    views = np.bincount(np.cumsum(begins) - 1, minlength=1)[np.cumsum(begins) - 1]
    number = np.arange(len(a)) - np.flatnonzero(begins)[np.cumsum(begins) - 1]
    one = np.flatnonzero((views > 1) & (number < views - views // 2))
    other = one + views[one] // 2
    first, second = segments.frame[a[one]], segments.frame[a[other]]
    moved = np.linalg.norm(position_m[first] - position_m[second], axis=1) > _OTHER_VIEW_M
    cosine = 0.5 * (np.einsum("nij,nij->n", world_from_sensor[first], world_from_sensor[second]) - 1)
    differ = moved | (cosine < np.cos(_OTHER_VIEW_RAD))
    rows = np.stack((a[one], b[one], a[other], b[other]), axis=1)[differ]
    distance = segments.distance_m[rows]
    return _DoubleDifferences((distance[:, 0] - distance[:, 1] - distance[:, 2] + distance[:, 3]) ** 2, rows)


def _seen_together(segments: Segments) -> tuple[Array, Array]:
    """Pairs of segments of one keyframe and axis."""
    key = segments.frame.astype(np.int64) * 3 + segments.axis
    order = np.argsort(key, kind="stable")
    key = key[order]
    pairs = [np.flatnonzero(key[:-lag] == key[lag:]) for lag in range(1, _MOST_TOGETHER)]
    later = [same + lag for lag, same in enumerate(pairs, start=1)]
    return order[np.concatenate(pairs)], order[np.concatenate(later)]


def _variance_sizes(square: Array, parts: Array) -> Array:
    """The non-negative sizes (C,) with `square (N,)` on average `parts (N, C) @ sizes`: each row weighed by what is expected of it."""
    expected = np.full(len(square), np.median(square) + _LEAST_M2)
    use = np.ones(len(square), dtype=bool)
    sizes = np.zeros(parts.shape[1])
    for _ in range(_ROUNDS):
        sizes = non_negative_least_squares(parts[use] / expected[use, None], square[use] / expected[use] / _KEPT_VARIANCE)
        expected = np.maximum(parts @ sizes, _LEAST_M2)
        use = square < _STRAY**2 * expected
    return np.asarray(sizes)
