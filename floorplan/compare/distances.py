"""The first plan's dimensions as the second survey has them: between the same walls, whatever the alignment."""

import math
from collections.abc import Mapping
from dataclasses import dataclass

from floorplan.compare.pairs import PlanePair
from floorplan.laser.spans import HEIGHT_AXIS, distance_sigma_m
from floorplan.model.normal import NORMAL_95
from floorplan.model.plan import Dimension, Plan, Point


@dataclass(frozen=True)
class DistanceChange:
    """One dimension in both surveys, second minus first, within `interval_m` (95 % of both together) or moved.

    `second` is the number of the same dimension in the second plan, empty where that one does not draw it.
    """

    first: str
    second: str
    room: str
    first_m: float
    second_m: float
    difference_m: float
    interval_m: float
    moved: bool
    start: Point
    end: Point
    is_height: bool


def compare_distances(first: Plan, second: Plan, walls: tuple[PlanePair, ...], levels: Mapping[int, int]) -> tuple[DistanceChange, ...]:
    """Every dimension of `first` whose two planes have a partner in `second`: a pair of `walls`, or of floors and ceilings, `levels`."""
    index = {plane.id: k for k, plane in enumerate(first.planes)}
    numbers = {frozenset((d.from_plane, d.to_plane)): d.id for d in second.dimensions}
    found = []
    for dimension in first.dimensions:
        ends = [_partner(index[plane], dimension, walls, levels) for plane in (dimension.from_plane, dimension.to_plane)]
        if ends[0] is not None and ends[1] is not None:
            found.append(_change(dimension, second, (ends[0], ends[1]), numbers))
    return tuple(found)


def _partner(plane: int, dimension: Dimension, walls: tuple[PlanePair, ...], levels: Mapping[int, int]) -> int | None:
    """The plane of the second survey; where one plane became two, the one at the dimension."""
    if dimension.axis == HEIGHT_AXIS:
        return levels.get(plane)
    along_m = dimension.start[1 - dimension.axis]
    candidates = [(pair.away_m(along_m), pair.second) for pair in walls if pair.first == plane]
    return min(candidates)[1] if candidates else None


def _change(dimension: Dimension, second: Plan, ends: tuple[int, int], numbers: Mapping[frozenset[str], str]) -> DistanceChange:
    one, other = second.planes[ends[0]], second.planes[ends[1]]
    length = abs(other.offset_m - one.offset_m)
    interval = NORMAL_95 * math.hypot(dimension.sigma_m, distance_sigma_m(second, *ends))
    difference = length - dimension.distance_m
    return DistanceChange(
        dimension.id,
        numbers.get(frozenset((one.id, other.id)), ""),
        dimension.room,
        dimension.distance_m,
        length,
        difference,
        interval,
        abs(difference) > interval,
        dimension.start,
        dimension.end,
        dimension.axis == HEIGHT_AXIS,
    )
