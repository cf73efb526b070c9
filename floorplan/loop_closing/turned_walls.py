"""Where the walls seen after a sweep that fitted nothing stand askew to those before: the heading may have been lost there."""

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from floorplan.geometry import wrap_to
from floorplan.loop_closing.bearings import azimuths, square_to_walls
from floorplan.model.checks import Array
from floorplan.sweep_matching import RefinedOdometry
from floorplan.sweep_matching.surfaces import SweepSurfaces

_AROUND = 12  # nodes on either side whose walls are looked at: some six metres of path
_FEWEST = 3
_ASKEW_RAD = np.deg2rad(8.0)  # a slip that matching did not see; less is drift
_SQUARE_SHARE = 0.5  # of the surfaces: where fewer stand square to each other no direction is told


@dataclass(frozen=True)
class TurnedWalls:
    """After `sweep` the walls stand off those before by `off_rad`, modulo a quarter turn."""

    sweep: int
    off_rad: float


def turned_walls(refined: RefinedOdometry, lost_share: float) -> tuple[TurnedWalls, ...]:
    """All places where a sweep fitted the map by less than `lost_share` and the walls after it stand askew to those before."""
    lost = np.flatnonzero(refined.matched[1:] < lost_share) + 1
    if not len(lost) or len(refined.node) < 2 * _FEWEST:
        return ()
    breaks = np.unique(np.searchsorted(refined.node, lost))
    found = []
    edges = np.concatenate(([0], breaks, [len(refined.node)]))
    for (first, middle), (_, last) in zip(pairwise(edges[:-1]), pairwise(edges[1:]), strict=True):
        off = _turned(refined, slice(max(first, middle - _AROUND), middle), slice(middle, min(last, middle + _AROUND)))
        if off is not None and abs(off) > _ASKEW_RAD:
            found.append(TurnedWalls(int(refined.node[min(middle, len(refined.node) - 1)]), off))
    return tuple(found)


def _turned(refined: RefinedOdometry, before: slice, after: slice) -> float | None:
    """Angle from the walls of the nodes `before` to those `after`, modulo a quarter turn; None where one of them tells no direction."""
    told = [_square(refined.pose[refined.node[part], 2], refined.surfaces[part]) for part in (before, after)]
    return None if told[0] is None or told[1] is None else float(wrap_to(np.asarray(told[1] - told[0]), np.pi / 2))


def _square(yaw_rad: Array, surfaces: Sequence[SweepSurfaces]) -> float | None:
    if len(yaw_rad) < _FEWEST:
        return None
    facing = np.concatenate([azimuths(seen) + yaw for seen, yaw in zip(surfaces, yaw_rad, strict=True)])
    told = square_to_walls(facing)
    return told.direction_rad if told.share >= _SQUARE_SHARE else None
