"""Non-negative least squares against the optimality conditions and against another solver."""

import numpy as np
import pytest
from scipy.optimize import nnls

from floorplan.non_negative import non_negative_least_squares


@pytest.mark.parametrize("seed", range(20))
def test_the_solution_meets_the_optimality_conditions_and_is_another_solvers(seed: int) -> None:
    random = np.random.default_rng(seed)
    columns = random.random((50, 3)) * (1.0, 1e-3, 1e3)
    right = columns @ (random.normal(size=3) / (1.0, 1e-3, 1e3)) + 0.1 * random.normal(size=50)
    x = non_negative_least_squares(columns, right)
    slope = columns.T @ (columns @ x - right) / (np.linalg.norm(columns, axis=0) * np.linalg.norm(right))
    assert (x >= 0).all()
    assert (slope > -1e-9).all()
    assert np.abs(slope[x > 0]).max(initial=0.0) < 1e-9
    assert x == pytest.approx(nnls(columns, right)[0], rel=1e-8, abs=1e-12)


def test_where_every_unknown_would_be_negative_all_are_zero() -> None:
    assert (non_negative_least_squares(np.eye(3), -np.ones(3)) == 0).all()


def test_equal_columns_and_fewer_rows_than_unknowns_give_an_answer_as_close_as_any() -> None:
    twice = np.ones((5, 2))
    assert twice @ non_negative_least_squares(twice, np.arange(5.0)) == pytest.approx(np.full(5, 2.0))
    assert non_negative_least_squares(np.array([[1.0, 2.0, 4.0]]), np.array([8.0])) @ (1, 2, 4) == pytest.approx(8.0)
