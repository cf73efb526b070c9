"""The questions the evidence merge asks: pairs within the joint covariance, their gaps, who was seen apart, chance coincidence."""

from dataclasses import dataclass

import numpy as np

from floorplan.merge.hypotheses import Pairs
from floorplan.model.checks import Array
from floorplan.model.graph import LayoutGraph

UP = 2  # the axis of floors and ceilings
GATE_SIGMAS = 6.0  # pairs further apart than this are no question even after drift is corrected
APART_SIGMAS = 5.0  # of the mean difference of two planes in the frames that saw both: one false bar keeps two whole components apart
APART_BIAS_M = 0.0015  # and the least bias taken for granted then: a millimetre less makes one false bar in a thousand pairs
LIKENESS_NEAR, LIKENESS_FAR = 2.0, -1.5  # log odds beyond chance: surfaces that continue each other; at opposite ends of a building
LIKENESS_FLOORS_FAR = 1.0  # two floors anywhere: a storey has one level more often than not
LIKENESS_OVERLAP = 2.0  # more where one covers the other: a surface hides what is a few centimetres behind it
GAP_DECAY_M = 3.0  # a doorway or a short unseen stretch leaves a wall likely to go on; a room between does not
SHORTEST_M = 0.1  # no wall piece is shorter
BUILDING_MARGIN_M = 1.0  # a group of one offset spans about a corridor's half width
STOREY_MARGIN_M = 2.5  # and of one height a storey
NEAR_M = 0.2  # walls on one line and ceilings of one storey differ by a partition's thickness or a plank
DISTINCT_M, DISTINCT_SIGMAS = 0.02, 3.0  # two planes nearer than either may have been taken for one
GAP_SLACK_SIGMAS = 2.0  # extents drift as much as offsets do


@dataclass(frozen=True)
class Planes:
    """The planes of one system: `tracks (T,)`, `offset_m (T,)`, `covariance_m2 (T, T)`, boxes (T, 3, 2) at solved positions;

    `row_sigma_m (T,)` of one row of each; `square_range_m2 (T,)` mean square of the distances it was seen from."""

    tracks: Array
    axis: Array
    facing: Array
    offset_m: Array
    covariance_m2: Array
    extent_m: Array
    row_sigma_m: Array
    square_range_m2: Array


def gated_pairs(planes: Planes) -> Pairs:
    """Pairs (columns of the system) of equal axis and facing within GATE_SIGMAS of each other."""
    return pairs_within(planes, 0.0, GATE_SIGMAS)


def pairs_within(planes: Planes, distance_m: float, sigmas: float = 0.0) -> Pairs:
    """Pairs of columns of equal axis and facing within a distance or a number of sigmas of their distance."""
    first, second = [], []
    variance = np.diag(planes.covariance_m2)
    group = planes.axis * 2 + (planes.facing > 0)
    for label in np.unique(group):
        mine = np.flatnonzero(group == label)
        delta = planes.offset_m[mine][:, None] - planes.offset_m[mine][None, :]
        joint = variance[mine][:, None] + variance[mine][None, :] - 2 * planes.covariance_m2[np.ix_(mine, mine)]
        a, b = np.nonzero(np.triu(delta**2 <= np.maximum(sigmas**2 * joint, distance_m**2), 1))
        first.append(mine[a])
        second.append(mine[b])
    return Pairs(np.concatenate(first), np.concatenate(second))


def pair_variance_m2(planes: Planes, pairs: Pairs) -> Array:
    """Variance (H,) of the distance of each pair."""
    variance, a, b = np.diag(planes.covariance_m2), pairs.first, pairs.second
    return np.asarray(variance[a] + variance[b] - 2 * planes.covariance_m2[a, b])


def gaps_m(planes: Planes, pairs: Pairs) -> Array:
    """Distance (H,) between the boxes of each pair within their common plane; 0 where they overlap or extents are unknown."""
    return np.asarray(np.linalg.norm(np.maximum(_apart_by(planes, pairs), 0.0), axis=1))


def overlap_share(planes: Planes, pairs: Pairs) -> Array:
    """Part (H,) of the smaller box's length along the wall that the larger one covers; 0 where they do not overlap or are unknown."""
    apart = _apart_by(planes, pairs)
    length = planes.extent_m[:, :, 1] - planes.extent_m[:, :, 0]
    shorter = np.minimum(length[pairs.first], length[pairs.second])
    share = np.clip(-apart / np.maximum(shorter, SHORTEST_M), 0.0, 1.0)
    share[np.arange(len(pairs)), planes.axis[pairs.first]] = 1.0
    return np.asarray(np.nan_to_num(np.min(share, axis=1)))


def _apart_by(planes: Planes, pairs: Pairs) -> Array:
    """Per axis (H, 3), how far the boxes are apart (positive) or overlap (negative); 0 along the planes' own axis and where unknown."""
    low = np.maximum(planes.extent_m[pairs.first, :, 0], planes.extent_m[pairs.second, :, 0])
    high = np.minimum(planes.extent_m[pairs.first, :, 1], planes.extent_m[pairs.second, :, 1])
    apart = np.nan_to_num(low - high)
    apart[np.arange(len(pairs)), planes.axis[pairs.first]] = 0.0
    return np.asarray(apart)


def log_prior(planes: Planes, pairs: Pairs, variance_m2: Array, plane: Array | None) -> Array:
    """Log of (prior odds of being one plane / density of a chance coincidence, per metre) (H,) (E9).

    `plane (T,)`: what an earlier round made of the tracks, to count distinct planes by.
    """
    gap = np.maximum(gaps_m(planes, pairs) - GAP_SLACK_SIGMAS * np.sqrt(variance_m2), 0.0)
    far = np.where((planes.axis == UP) & (planes.facing > 0), LIKENESS_FLOORS_FAR, LIKENESS_FAR)[pairs.first]
    likeness = far + (LIKENESS_NEAR - far) * np.exp(-gap / GAP_DECAY_M)
    likeness += LIKENESS_OVERLAP * overlap_share(planes, pairs)
    return np.asarray(likeness - np.log(_planes_per_metre(planes, plane))[pairs.first])


def _planes_per_metre(planes: Planes, plane: Array | None) -> Array:
    """Per plane, how many distinct planes of its axis and facing there are per metre of the building, near another one."""
    density = np.ones(len(planes.tracks))
    group = planes.axis * 2 + (planes.facing > 0)
    for label in np.unique(group):
        mine = np.flatnonzero(group == label)
        mine = mine[np.argsort(planes.offset_m[mine])]
        offset, sigma = planes.offset_m[mine], np.sqrt(np.diag(planes.covariance_m2)[mine])
        length = np.ptp(offset) + (STOREY_MARGIN_M if planes.axis[mine[0]] == UP else BUILDING_MARGIN_M)
        if plane is None:
            density[mine] = (1 + int((np.diff(offset) > np.minimum(sigma[1:], sigma[:-1])).sum())) / length
        else:
            density[mine] = len(np.unique(plane[mine])) / length * _clustering(planes, mine, plane, float(length))
    return density


def _clustering(planes: Planes, mine: Array, plane: Array, length_m: float) -> float:
    """How many times more often two distinct planes lie NEAR_M or less apart than if they were strewn over `length_m`; at least 1.

    Ceilings of one storey and walls along one corridor keep nearly the same line. Counted are pairs whose distance is surely not
    zero; where drift hides that, a pair tells nothing. One pair more than there are, and one more than chance would make: few
    planes show no habit.
    """
    first = mine[np.unique(plane[mine], return_index=True)[1]]
    offset, variance = planes.offset_m[first], np.diag(planes.covariance_m2)[first]
    joint = variance[:, None] + variance[None, :] - 2 * planes.covariance_m2[np.ix_(first, first)]
    upper = np.triu_indices(len(first), 1)
    surely = np.maximum(DISTINCT_M, DISTINCT_SIGMAS * np.sqrt(np.maximum(joint[upper], 0.0)))
    apart = np.abs(offset[:, None] - offset[None, :])[upper]
    found = int(((apart > surely) & (apart < NEAR_M)).sum())
    by_chance = float(np.maximum(NEAR_M - surely, 0.0).sum()) * 2.0 / length_m
    return max(1.0, (found + 1.0) / (by_chance + 1.0))


def seen_apart(graph: LayoutGraph, sigma_m: Array, bias_m: Array, planes: Planes) -> Pairs:
    """Pairs of columns that some frames saw together, and clearly at different offsets (cannot be one plane); `bias_m (T,)` of each."""
    column = np.full(len(graph.axis), -1)
    column[planes.tracks] = np.arange(len(planes.tracks))
    rows = np.flatnonzero((column[graph.track] >= 0) & np.isfinite(sigma_m))
    side = graph.axis[graph.track[rows]] * 2 + (graph.facing[graph.track[rows]] > 0)
    key = graph.frame[rows] * 6 + side
    order = np.argsort(key, kind="stable")
    rows, key = rows[order], key[order]
    left, right = _within_runs(key)
    a, b = column[graph.track[rows[left]]], column[graph.track[rows[right]]]
    turned = a > b
    a, b = np.where(turned, b, a), np.where(turned, a, b)
    difference = np.where(turned, -1.0, 1.0) * (graph.distance_m[rows[left]] - graph.distance_m[rows[right]])
    weight = 1.0 / (sigma_m[rows[left]] ** 2 + sigma_m[rows[right]] ** 2)
    name, index = np.unique(a * len(planes.tracks) + b, return_inverse=True)
    total = np.bincount(index, weight, len(name))
    mean = np.bincount(index, weight * difference, len(name)) / np.maximum(total, 1e-12)
    bias_m = np.maximum(bias_m, APART_BIAS_M)
    both_m2 = bias_m[name // len(planes.tracks)] ** 2 + bias_m[name % len(planes.tracks)] ** 2
    apart = (np.abs(mean) > APART_SIGMAS * np.sqrt(1.0 / np.maximum(total, 1e-12) + both_m2)) & (name % (len(planes.tracks) + 1) != 0)
    return Pairs(name[apart] // len(planes.tracks), name[apart] % len(planes.tracks))


def _within_runs(key: Array) -> tuple[Array, Array]:
    """All pairs of positions (i < j) whose sorted `key` is equal."""
    last = np.searchsorted(key, key, side="right")
    count = last - np.arange(len(key)) - 1
    left = np.repeat(np.arange(len(key)), count)
    right = left + 1 + np.arange(len(left)) - np.repeat(np.cumsum(count) - count, count)
    return left, right
