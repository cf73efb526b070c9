"""Chains of odometry rows: x and y together with scale and sideways rates as states, z with a slope."""

from dataclasses import dataclass, field

import numpy as np

from floorplan.elimination.chain import Chain
from floorplan.elimination.chain_blocks import Blocks, joint_blocks, upright_blocks
from floorplan.model.checks import Array
from floorplan.model.noise import DriftModel, VerticalDrift

PX, PY, SCALE, SIDEWAYS = 0, 1, 2, 3  # states of a frame of the joint chain
SLOPE = 1  # of one of the upright chain, behind its height
JOINT_STATES, UPRIGHT_STATES = 4, 2
MAP_CORRELATION_M = 2.0  # of path: neighbouring places of a map are off together
STANDING_M = 1e-4  # of path that a frame at rest counts for
STEP_FLOOR_M = 0.01  # a sensor that stands still still trembles: keeps every odometry row's variance above zero


@dataclass(frozen=True)
class Links:
    """Rows that are no odometry but the rough pose of one scan against the one before: `row (B,)` of the steps, `sigma_m (B, 3)`.

    The rates of the odometry start anew behind them.
    """

    row: Array = field(default_factory=lambda: np.zeros(0, dtype=np.int64))
    sigma_m: Array = field(default_factory=lambda: np.zeros((0, 3)))


NO_LINKS = Links()


def step_variance_m2(translation_m: Array, drift: DriftModel) -> Array:
    """Variance (N-1,) of the white part of each odometry row, equal along each axis; `translation_m (N-1, 2 or 3)`."""
    length = np.maximum(np.linalg.norm(translation_m, axis=1), STEP_FLOOR_M)
    return np.asarray(drift.rate_m_per_sqrt_m**2 * length)


def joint_chain(
    translation_m: Array, drift: DriftModel, links: Links = NO_LINKS, step_m: Array | None = None, map_sigma_m: Array | None = None
) -> Chain:
    """x and y together, states (px, py, s, w) and one dense column g, the global scale.

    `p_{i+1} - p_i - (s_i + g) u_i - w_i J u_i = t_i`, J a quarter turn; `s` and `w` are AR(1) in the path length. `u_i` is the true step
    as far as it is known: `step_m (N-1, 2 or 3)`, of an earlier solution; None: `t_i` itself, whose error is in the rates as well, so that
    passes that came out short weigh more and long distances come out short by about twice the variance of `s`.
    `map_sigma_m (N,)`: the odometry is a map, and no frame is far from where that has it.
    """
    t = translation_m[:, :2]
    u = t if step_m is None else step_m[:, :2]
    length = np.maximum(np.sqrt((u**2).sum(axis=1)), STEP_FLOOR_M)
    white = np.repeat(step_variance_m2(u, drift)[:, None], 2, axis=1)
    felt = u
    if len(links.row):
        white[links.row] = links.sigma_m[:, :2] ** 2
        felt = u.copy()  # the step that rates and scale act on
        felt[links.row] = 0.0
    blocks = joint_blocks(t, felt, white, _memory(length, drift.correlation_m, links), drift.scale_sigma, drift.sideways_sigma)
    _add_prior(blocks, SCALE, drift.scale_sigma)
    _add_prior(blocks, SIDEWAYS, drift.sideways_sigma)
    if map_sigma_m is not None:
        _add_map(blocks, t, map_sigma_m)
    blocks.dense_information[:] += drift.global_scale_sigma**-2
    blocks.sums[1] -= 2 * np.log(drift.global_scale_sigma)
    return _chain(blocks, pinned=2)


def upright_chain(translation_m: Array, drift: VerticalDrift, links: Links = NO_LINKS) -> Chain:
    """z alone, states (pz, r): `p_{i+1} - p_i - r_i l_i = t_i`, l the path length of the step, r AR(1) in the path length."""
    length = np.maximum(np.linalg.norm(translation_m, axis=1), STEP_FLOOR_M)
    memory = _memory(length, drift.correlation_m, links)
    white = drift.rate_m_per_sqrt_m**2 * length
    white[links.row] = links.sigma_m[:, 2] ** 2
    length[links.row] = 0.0
    blocks = upright_blocks(translation_m[:, 2], length, white, memory, drift.slope_sigma)
    _add_prior(blocks, SLOPE, drift.slope_sigma)
    return _chain(blocks, pinned=1)


def _memory(length_m: Array, correlation_m: float, links: Links) -> Array:
    """How much of a rate is left after each step (N-1,); nothing behind a link."""
    memory = np.exp(-length_m / correlation_m)
    memory[links.row] = 0.0
    return np.asarray(memory)


def _add_prior(blocks: Blocks, state: int, sigma: float) -> None:
    """A zero-mean prior on one state of the first frame."""
    blocks.diagonal[0, state, state] += sigma**-2
    blocks.sums[1] -= 2 * np.log(sigma)


def _add_map(blocks: Blocks, t: Array, sigma_m: Array) -> None:
    """Rows `p_i = sum of the steps before`; frames closer together than MAP_CORRELATION_M share one error, and one such row."""
    half = 0.5 * np.linalg.norm(t, axis=1)
    share = np.concatenate((half, [0.0])) + np.concatenate(([0.0], half)) + STANDING_M
    weight = share / MAP_CORRELATION_M / sigma_m**2
    place = np.concatenate((np.zeros((1, 2)), np.cumsum(t, axis=0)))
    for state in (PX, PY):
        blocks.diagonal[:, state, state] += weight
        blocks.rhs[:, state] += weight * place[:, state]
        blocks.sums[0] += float((weight * place[:, state] ** 2).sum())
        blocks.sums[1] += float(np.log(weight).sum())


def _chain(blocks: Blocks, pinned: int) -> Chain:
    """The sums, with the gauge: the first `pinned` states of frame 0 leave the problem."""
    gone = slice(0, pinned)
    blocks.diagonal[0, gone, :] = blocks.diagonal[0, :, gone] = 0.0
    blocks.diagonal[0, gone, gone] = np.eye(pinned)
    blocks.coupling[:1, :, gone] = 0.0
    blocks.rhs[0, gone] = 0.0
    blocks.dense[0, gone] = 0.0
    square_sum, log_weight = blocks.sums.tolist()
    return Chain(*blocks[:-1], square_sum, log_weight, pinned)
