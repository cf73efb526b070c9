"""Frontal elimination against dense least squares."""

from dataclasses import dataclass

import numpy as np
import pytest

from floorplan.elimination.chain import Chain, Rows
from floorplan.elimination.frontal import (
    Eliminated,
    arrange,
    eliminate_in_order,
    joint_covariance,
    least_squares,
    log_marginal_likelihood,
    log_marginal_likelihood_of,
)
from floorplan.elimination.odometry_chain import NO_LINKS, Links, joint_chain, step_variance_m2
from floorplan.errors import NoSolutionError
from floorplan.model.checks import Array
from floorplan.model.noise import DriftModel

DRIFT = DriftModel(rate_m_per_sqrt_m=0.02, scale_sigma=0.03, sideways_sigma=0.02)
FRAMES, PLANES = 60, 9


@dataclass(frozen=True)
class Dense:
    """All rows of a scan as one whitened system `A x = b`: states in frame order, then planes, then the global scale."""

    A: Array
    b: Array


def random_rows(rng: np.random.Generator, components: int) -> Rows:
    start = rng.integers(0, FRAMES - 12, PLANES)
    start[0] = 0
    axis = rng.integers(0, components, PLANES)
    frame = np.concatenate([np.arange(s, s + 12) for s in start])
    column = np.repeat(np.arange(PLANES), 12)
    weight = rng.uniform(0.5, 2.0, len(frame)) * 1e4
    return Rows(frame, axis[column], column, rng.normal(0, 2, len(frame)), weight)


def eliminated_of(chain: Chain, rows: Rows, planes: int) -> Eliminated:
    return eliminate_in_order(chain, arrange(rows, chain.rhs.shape, planes, chain.pinned))


def plain_chain(t: Array) -> Chain:
    """Rows `p_{i+1} - p_i = t_i` of weight 1, `p_0 = 0`."""
    count = len(t) + 1
    diagonal, rhs = np.full((count, 1, 1), 2.0), np.zeros((count, 1))
    diagonal[[0, -1]] = 1.0
    rhs[1:, 0] += t
    rhs[1:-1, 0] -= t[1:]
    coupling = -np.ones((count - 1, 1, 1))
    coupling[0] = 0.0
    return Chain(diagonal, coupling, rhs, np.zeros((count, 1, 0)), np.zeros((0, 0)), np.zeros(0), float(t @ t), 0.0, 1)


def dense_joint(t: Array, drift: DriftModel, rows: Rows, links: Links = NO_LINKS) -> Dense:
    states = 4 * FRAMES
    A, b = [], []

    def add(entries: dict[int, float], value: float, weight: float) -> None:
        row = np.zeros(states + PLANES + 1)
        for place, entry in entries.items():
            row[place] += entry
        A.append(row * np.sqrt(weight))
        b.append(value * np.sqrt(weight))

    g = states + PLANES
    variance = step_variance_m2(t, drift)
    for i in range(FRAMES - 1):
        k, (x, y) = 4 * i, t[i]
        if i in links.row:  # a rough pose: no scale, no memory of the rates
            sigma = links.sigma_m[list(links.row).index(i)]
            add({k: -1, k + 4: 1}, x, sigma[0] ** -2)
            add({k + 1: -1, k + 5: 1}, y, sigma[1] ** -2)
            add({k + 6: 1}, 0, drift.scale_sigma**-2)
            add({k + 7: 1}, 0, drift.sideways_sigma**-2)
            continue
        add({k: -1, k + 4: 1, k + 2: -x, k + 3: y, g: -x}, x, 1 / variance[i])
        add({k + 1: -1, k + 5: 1, k + 2: -y, k + 3: -x, g: -y}, y, 1 / variance[i])
        memory = np.exp(-max(np.hypot(x, y), 0.01) / drift.correlation_m)
        add({k + 2: -memory, k + 6: 1}, 0, 1 / (drift.scale_sigma**2 * (1 - memory**2)))
        add({k + 3: -memory, k + 7: 1}, 0, 1 / (drift.sideways_sigma**2 * (1 - memory**2)))
    add({2: 1}, 0, drift.scale_sigma**-2)
    add({3: 1}, 0, drift.sideways_sigma**-2)
    add({g: 1}, 0, drift.global_scale_sigma**-2)
    for f, c, j, d, w in zip(rows.frame, rows.component, rows.column, rows.distance_m, rows.weight, strict=True):
        add({4 * f + c: -1, states + j: 1}, d, w)
    return Dense(np.delete(np.array(A), [0, 1], axis=1), np.array(b))


LINKED = Links(np.array([20, 44]), np.array([[0.1, 0.2, 0.05], [0.3, 0.1, 0.05]]))


@pytest.mark.parametrize(("seed", "links"), [(1, NO_LINKS), (2, NO_LINKS), (3, NO_LINKS), (4, LINKED)])
def test_the_joint_chain_gives_the_dense_least_squares_solution_and_covariance(seed: int, links: Links) -> None:
    rng = np.random.default_rng(seed)
    t = rng.normal(0, 0.2, (FRAMES - 1, 2))
    rows = random_rows(rng, 2)
    eliminated = eliminated_of(joint_chain(t, DRIFT, links), rows, PLANES)
    solved = least_squares(eliminated)
    dense = dense_joint(t, DRIFT, rows, links)
    want = np.linalg.lstsq(dense.A, dense.b, rcond=None)[0]
    np.testing.assert_allclose(np.concatenate([solved.state.ravel()[2:], solved.column]), want[:-1], atol=1e-9)
    inverse = np.linalg.inv(dense.A.T @ dense.A)
    planes = slice(-PLANES - 1, -1)
    np.testing.assert_allclose(joint_covariance(eliminated), inverse[planes, planes], rtol=1e-6, atol=1e-12)
    pull = rng.normal(0, 10, PLANES)
    moved = least_squares(eliminated, pull)
    np.testing.assert_allclose(moved.column, want[planes] + inverse[planes, planes] @ pull, atol=1e-9)
    np.testing.assert_allclose(moved.state.ravel()[2:], (want + inverse[:, planes] @ pull)[: 4 * FRAMES - 2], atol=1e-9)


def test_the_marginal_likelihood_is_that_of_the_dense_system() -> None:
    rng = np.random.default_rng(4)
    t = rng.normal(0, 0.2, (FRAMES - 1, 2))
    rows = random_rows(rng, 2)
    values = []
    for rate in (0.01, 0.03):
        drift = DriftModel(rate, 0.03, 0.02)
        dense = dense_joint(t, drift, rows)
        best = np.linalg.lstsq(dense.A, dense.b, rcond=None)[0]
        cost = float(((dense.A @ best - dense.b) ** 2).sum())
        weights = -2 * (FRAMES - 1) * np.log(rate**2)  # the part of the rows' weights that depends on the rate
        dense_value = 0.5 * (weights - np.linalg.slogdet(dense.A.T @ dense.A)[1] - cost)
        values.append(log_marginal_likelihood(eliminated_of(joint_chain(t, drift), rows, PLANES)) - dense_value)
    assert values[0] == pytest.approx(values[1], abs=1e-6)


def test_a_long_walk_past_many_planes_opens_few_seats_and_forgets_nothing() -> None:
    rng = np.random.default_rng(5)
    frames, planes = 400, 40
    start = np.linspace(0, frames - 21, planes).astype(int)
    frame = np.concatenate([np.arange(s, s + 20) for s in start])
    column = np.repeat(np.arange(planes), 20)
    rows = Rows(frame, np.zeros_like(frame), column, rng.normal(0, 1, len(frame)), np.ones(len(frame)))
    t = rng.normal(0, 0.1, frames - 1)
    eliminated = eliminated_of(plain_chain(t), rows, planes + 1)
    solved = least_squares(eliminated)
    assert eliminated.factor.felt.shape[1] < 5  # no more seats than planes open at one time
    assert solved.column[planes] == 0.0  # never seen
    assert joint_covariance(eliminated)[planes, planes] == np.inf
    A = np.zeros((frames - 1 + len(frame), frames + planes))
    A[np.arange(frames - 1), np.arange(frames - 1)] = -1
    A[np.arange(frames - 1), np.arange(1, frames)] = 1
    at = np.arange(len(frame)) + frames - 1
    A[at, frame], A[at, frames + column] = -1, 1
    b = np.concatenate([t, rows.distance_m])
    want = np.linalg.lstsq(A[:, 1:], b, rcond=None)[0]
    np.testing.assert_allclose(np.concatenate([solved.state[1:, 0], solved.column[:planes]]), want, atol=1e-9)
    inverse = np.linalg.inv(A[:, 1:].T @ A[:, 1:])
    np.testing.assert_allclose(joint_covariance(eliminated)[:planes, :planes], inverse[-planes:, -planes:], rtol=1e-7)


def test_odometry_without_numbers_is_refused() -> None:
    t = np.full((FRAMES - 1, 2), 0.1)
    t[7] = np.nan
    with pytest.raises(NoSolutionError, match="singular"):
        eliminated_of(joint_chain(t, DRIFT), random_rows(np.random.default_rng(6), 2), PLANES)


@pytest.mark.parametrize("factor", [1.0, 1.7])
def test_the_likelihood_without_a_factor_to_keep_is_that_of_the_rows_with_every_sigma_times_the_factor(factor: float) -> None:
    rng = np.random.default_rng(7)
    chain, rows = joint_chain(rng.normal(0, 0.2, (FRAMES - 1, 2)), DRIFT), random_rows(rng, 2)
    weaker = Rows(rows.frame, rows.component, rows.column, rows.distance_m, rows.weight / factor**2)
    expected = log_marginal_likelihood(eliminated_of(chain, weaker, PLANES))
    found = log_marginal_likelihood_of(chain, arrange(rows, chain.rhs.shape, PLANES, chain.pinned), factor)
    assert found == pytest.approx(expected, rel=1e-12)
