"""Edges of walls beside openings, from rays whose course is known."""

import numpy as np
import pytest

from floorplan.model.checks import Array
from floorplan.plan.edges import refined_edge_m
from floorplan.plan.surface_evidence import FINE_CELLS, PlaneEvidence

STEP_M = 0.05
COLUMNS = 40
JAMB_M = 1.0


def evidence(hits_m: Array, passes_m: Array) -> PlaneEvidence:
    """A plane from 0 to 2 m with hits and passes of weight 1 at given places."""
    cells = np.linspace(0, COLUMNS * STEP_M, COLUMNS * FINE_CELLS + 1)
    hits, passes = (np.histogram(places, cells)[0].astype(float) for places in (hits_m, passes_m))
    coarse = np.zeros((COLUMNS, 1))
    return PlaneEvidence(0, 0.0, STEP_M, 0.0, 6.0, coarse, coarse, coarse, hits, passes, np.zeros((0, 2), dtype=np.int32))


def edge_m(hits_m: Array, passes_m: Array) -> float:
    return refined_edge_m(evidence(hits_m, passes_m), round(JAMB_M / STEP_M), +1, 10, 10)


def test_a_far_jamb_is_where_the_wall_begins_though_no_ray_passed_close_to_it() -> None:
    rng = np.random.default_rng(1)
    hits, passes = rng.uniform(JAMB_M, 1.6, 800), rng.uniform(0.4, JAMB_M - 0.12, 300)
    assert edge_m(hits, passes) == pytest.approx(JAMB_M, abs=0.006)


def test_readings_that_noise_pushed_over_a_jamb_do_not_move_it_far() -> None:
    rng = np.random.default_rng(2)
    hits = rng.uniform(JAMB_M, 1.6, 1200) + rng.normal(0, 0.015, 1200)
    passes = rng.uniform(0.4, JAMB_M - 0.12, 300)
    assert edge_m(hits, passes) == pytest.approx(JAMB_M, abs=0.015)
    assert hits.min() < JAMB_M - 0.03


def test_a_jamb_with_sparse_hits_lies_between_the_last_ray_and_the_first_hit() -> None:
    away = 0.022 + 0.045 * np.arange(12)
    hits, passes = JAMB_M + away, JAMB_M - away
    assert edge_m(hits, passes) == pytest.approx(JAMB_M, abs=0.006)
