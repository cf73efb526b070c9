"""Rooms beside walls off the axes."""

import numpy as np
import pytest
from shapely import GeometryCollection, Polygon, box

from floorplan.model.checks import Array
from floorplan.model.plan import FreeLine
from floorplan.plan.free_space import CELL_M, FreeSpace
from floorplan.plan.skewed_sides import with_skewed_sides

WALL = FreeLine("L1", (0.0, 1.0), (4.0, 0.0), 0.005, 14.0)  # the south side of a room of 4 x 4 m, 14 degrees off
ROOM = Polygon([(0, 1), (4, 0), (4, 4), (0, 4)])


def space_of(free: Polygon) -> FreeSpace:
    """Rays crossed exactly the cells whose middles lie in `free`, in a square from -1 to 5 m."""
    middles = -1 + (np.arange(round(6 / CELL_M)) + 0.5) * CELL_M
    x, y = np.meshgrid(middles, middles, indexing="ij")
    crossed = _contains(free, x, y)
    integral = np.zeros((crossed.shape[0] + 1, crossed.shape[1] + 1))
    integral[1:, 1:] = crossed.cumsum(axis=0).cumsum(axis=1)
    return FreeSpace(np.array([-1.0, -1.0]), integral)


def _contains(free: Polygon, x: Array, y: Array) -> Array:
    import shapely

    return np.asarray(shapely.contains_xy(free, x, y))


@pytest.mark.parametrize("south_m", [0.0, 0.4, 0.7, 1.0])
def test_a_room_ends_at_the_skewed_wall_wherever_the_cells_that_it_cuts_were_drawn(south_m: float) -> None:
    (room,) = with_skewed_sides([box(0, south_m, 4, 4)], (WALL,), GeometryCollection(), space_of(ROOM))
    assert room.symmetric_difference(ROOM).area < 0.02
    assert room.is_valid


def test_a_partition_with_space_on_both_sides_cuts_nothing_off() -> None:
    whole = box(0, 0, 4, 4)
    assert with_skewed_sides([whole], (WALL,), GeometryCollection(), space_of(whole)) == [whole]


def test_the_room_beyond_the_wall_keeps_what_is_its_own() -> None:
    behind = Polygon([(0, -1), (4, -1), (4, -0.2), (0, 0.8)])
    rooms = with_skewed_sides([box(0, 0.7, 4, 4), box(0, -1, 4, -0.25)], (WALL,), GeometryCollection(), space_of(ROOM.union(behind)))
    assert rooms[1].area == pytest.approx(3.0)
