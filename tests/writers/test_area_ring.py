"""Rooms with holes as one ring."""

import numpy as np
import pytest
from shapely import Polygon

from floorplan.writers.area_ring import signed_area, slit_ring


def test_a_hall_with_many_columns_becomes_one_ring_of_its_net_area() -> None:
    rng = np.random.default_rng(5)
    outline = ((0.0, 0.0), (40.0, 0.0), (40.0, 20.0), (20.0, 20.0), (20.0, 30.0), (0.0, 30.0))
    holes = []
    for x in range(1, 38, 3):
        for y in range(1, 18, 3):
            w, h = (float(value) for value in rng.uniform(0.2, 1.9, 2))
            holes.append(((x, y), (x, y + h), (x + w, y + h), (x + w, y)))
    ring = slit_ring(outline, tuple(holes))
    room = Polygon(outline, holes)
    assert signed_area(ring) == pytest.approx(room.area, abs=1e-9)
    assert len(ring) == len(outline) + sum(len(hole) + 2 for hole in holes)
    assert Polygon(ring).buffer(0).area == pytest.approx(room.area, abs=1e-6)


def test_a_clockwise_outline_is_turned() -> None:
    assert signed_area(slit_ring(((0.0, 0.0), (0.0, 2.0), (3.0, 2.0), (3.0, 0.0)), ())) == 6.0
