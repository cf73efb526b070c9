"""Chains of odometry rows: x and y together with scale and sideways rates as states, z with a slope."""

from dataclasses import dataclass, field

import numpy as np

from floorplan.chain import Chain
from floorplan.chain_builder import ChainBuilder
from floorplan.compiled import compiled
from floorplan.model.checks import Array
from floorplan.model.noise import DriftModel, VerticalDrift

PX, PY, SCALE, SIDEWAYS = 0, 1, 2, 3  # states of a frame of the joint chain
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
    builder = ChainBuilder(len(t) + 1, JOINT_STATES, 1)
    builder.add_prior(0, (0.0, 0.0, drift.scale_sigma**-2, drift.sideways_sigma**-2))
    length = np.maximum(np.sqrt((u**2).sum(axis=1)), STEP_FLOOR_M)
    white = np.repeat(step_variance_m2(u, drift)[:, None], 2, axis=1)
    felt = u
    if len(links.row):
        white[links.row] = links.sigma_m[:, :2] ** 2
        felt = u.copy()  # the step that rates and scale act on
        felt[links.row] = 0.0
    sizes = np.array([drift.scale_sigma, drift.sideways_sigma])
    here, there, wide, value, weight = _joint_rows(t, felt, white, _memory(length, drift.correlation_m, links), sizes)
    builder.add_rows(here, there, wide, value, weight)
    if map_sigma_m is not None:
        _add_map(builder, t, map_sigma_m)
    builder.dense_information += drift.global_scale_sigma**-2
    builder.log_weight -= 2 * np.log(drift.global_scale_sigma)
    return builder.chain(pinned=2)


@compiled
def _joint_rows(t: Array, felt: Array, white: Array, memory: Array, sizes: Array) -> tuple[Array, Array, Array, Array, Array]:
    """Rows of every step as `ChainBuilder.add_rows` takes them: x, y (variance `white (N-1, 2)`), scale and sideways rate (E2, E3).

    `t (N-1, 2)` the steps, of which rates and global scale act on `felt (N-1, 2)`; `memory (N-1,)` and `sizes (2,)` of the rates.
    """
    here, there, wide = np.zeros((len(t), 4, JOINT_STATES)), np.zeros((len(t), 4, JOINT_STATES)), np.zeros((len(t), 4, 1))
    value, weight = np.zeros((len(t), 4)), np.empty((len(t), 4))
    for i in range(len(t)):
        for k in range(2):
            here[i, k, k], there[i, k, k] = -1.0, 1.0
            here[i, k, SCALE], wide[i, k, 0] = -felt[i, k], -felt[i, k]
            here[i, k, SIDEWAYS] = felt[i, 1] if k == PX else -felt[i, 0]
            value[i, k], weight[i, k] = t[i, k], 1.0 / white[i, k]
            here[i, 2 + k, SCALE + k], there[i, 2 + k, SCALE + k] = -memory[i], 1.0
            weight[i, 2 + k] = 1.0 / ((1.0 - memory[i] ** 2) * sizes[k] ** 2)
    return here, there, wide, value, weight


def upright_chain(translation_m: Array, drift: VerticalDrift, links: Links = NO_LINKS) -> Chain:
    """z alone, states (pz, r): `p_{i+1} - p_i - r_i l_i = t_i`, l the path length of the step, r AR(1) in the path length."""
    length = np.maximum(np.linalg.norm(translation_m, axis=1), STEP_FLOOR_M)
    count = len(length) + 1
    builder = ChainBuilder(count, UPRIGHT_STATES, 0)
    builder.add_prior(0, (0.0, drift.slope_sigma**-2))
    here, there = np.zeros((count - 1, 2, 2)), np.zeros((count - 1, 2, 2))
    memory = _memory(length, drift.correlation_m, links)
    length[links.row] = 0.0
    here[:, 0, 0], here[:, 0, 1], here[:, 1, 1] = -1.0, -length, -memory
    there[:, 0, 0] = there[:, 1, 1] = 1.0
    variance = np.column_stack([drift.rate_m_per_sqrt_m**2 * length, drift.slope_sigma**2 * (1 - memory**2)])
    variance[links.row, 0] = links.sigma_m[:, 2] ** 2
    value = np.column_stack([translation_m[:, 2], np.zeros(count - 1)])
    builder.add_rows(here, there, None, value, 1.0 / variance)
    return builder.chain(pinned=1)


def _memory(length_m: Array, correlation_m: float, links: Links) -> Array:
    """How much of a rate is left after each step (N-1,); nothing behind a link."""
    memory = np.exp(-length_m / correlation_m)
    memory[links.row] = 0.0
    return np.asarray(memory)


def _add_map(builder: ChainBuilder, t: Array, sigma_m: Array) -> None:
    """Rows `p_i = sum of the steps before`; frames closer together than MAP_CORRELATION_M share one error, and one such row."""
    half = 0.5 * np.linalg.norm(t, axis=1)
    share = np.concatenate((half, [0.0])) + np.concatenate(([0.0], half)) + STANDING_M
    weight = share / MAP_CORRELATION_M / sigma_m**2
    builder.add_places((PX, PY), np.concatenate((np.zeros((1, 2)), np.cumsum(t, axis=0))), weight)
