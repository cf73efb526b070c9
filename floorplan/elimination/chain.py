"""The rows of one chain as values: measurements of planes, odometry between neighbouring frames."""

from dataclasses import dataclass

from floorplan.model.checks import Array


@dataclass(frozen=True)
class Rows:
    """Measurement rows of one chain, R rows sorted by frame: `m[column] - x[frame, component] = distance_m`.

    `weight (R,)` is 1 / sigma^2 (1 / m^2); a row of weight 0 is left out.
    """

    frame: Array
    component: Array
    column: Array
    distance_m: Array
    weight: Array


@dataclass(frozen=True)
class Chain:
    """Odometry part of the normal equations of N frames with n states each, and G columns that touch every frame.

    `diagonal (N, n, n)`; `coupling (N-1, n, n)` block of frame i + 1 against frame i; `rhs (N, n)`; `dense (N, n, G)`,
    `dense_information (G, G)`, `dense_rhs (G,)`; `square_sum` the rows' weighted squared right-hand sides;
    `log_weight` sum of the log weights of the odometry rows; the first `pinned` states of frame 0 are zero (the gauge).
    """

    diagonal: Array
    coupling: Array
    rhs: Array
    dense: Array
    dense_information: Array
    dense_rhs: Array
    square_sum: float
    log_weight: float
    pinned: int
