"""The same building after works: one wall set forward, one partition built, for comparing surveys."""

from collections.abc import Iterator
from dataclasses import dataclass, replace

from shapely.geometry import Polygon

from floorplan.simulate.building import Building, Space, SpaceKind
from floorplan.simulate.furnish import CLEAR_OF_PATH_M, OPENING_ZONE_M, against_wall, along_walls
from floorplan.simulate.route import Route

SET_FORWARD_M = 0.15  # insulation and a new lining
PARTITION_M = (1.2, 0.12)  # length into the room, thickness
MIN_RUN_M = 2.0
NO_WALL = "no wall was set forward: none is free of furniture, doors and the walk"
NO_PARTITION = "no partition was built: no second room has a place for it beside furniture, doors and the walk"
GROWN_M = 1e-7  # so that what is taken away leaves no sliver

Run = tuple[int, float, float, float, float]


@dataclass(frozen=True)
class _Candidate:
    space: Space
    run: Run


@dataclass(frozen=True)
class Works:
    """A building after works, and a sentence for each of the two that there was no place for."""

    building: Building
    left_out: tuple[str, ...] = ()


def after_works(building: Building, route: Route) -> Works:
    """The longest free wall of a room set forward by `SET_FORWARD_M`, and a partition square to the next longest of another room."""
    candidates = sorted(_free_runs(building, route), key=lambda c: (-(c.run[2] - c.run[1]), c.space.id))
    if not candidates:
        return Works(building, (NO_WALL, NO_PARTITION))
    forward = candidates[0]
    changed = _without(building, forward.space, _strip(forward.run))
    others = [c for c in candidates if c.space.id != forward.space.id and _is_free(_partition(c.run), c.space, building, route)]
    return Works(_without(changed, others[0].space, _partition(others[0].run))) if others else Works(changed, (NO_PARTITION,))


def _free_runs(building: Building, route: Route) -> Iterator[_Candidate]:
    for space in building.spaces:
        if space.kind is SpaceKind.ROOM:
            for run in along_walls(space):
                if run[2] - run[1] >= MIN_RUN_M and _is_free(_strip(run), space, building, route):
                    yield _Candidate(space, run)


def _strip(run: Run) -> Polygon:
    return against_wall(run, run[1], run[2] - run[1], SET_FORWARD_M)


def _partition(run: Run) -> Polygon:
    """From the middle of the wall into the room."""
    return against_wall(run, (run[1] + run[2] - PARTITION_M[1]) / 2, PARTITION_M[1], PARTITION_M[0])


def _is_free(taken: Polygon, space: Space, building: Building, route: Route) -> bool:
    openings = [o.rect.polygon.buffer(OPENING_ZONE_M) for o in building.openings if space.id in o.spaces]
    blocked = taken.intersects(route.corridor.buffer(CLEAR_OF_PATH_M)) or any(taken.intersects(zone) for zone in openings)
    return not blocked and bool(space.outline.buffer(1e-6).contains(taken))


def _without(building: Building, space: Space, taken: Polygon) -> Building:
    outline = space.outline.difference(taken.buffer(GROWN_M, join_style="mitre"))
    return replace(building, spaces=tuple(replace(s, outline=outline) if s.id == space.id else s for s in building.spaces))
