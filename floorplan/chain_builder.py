"""Sums weighted rows between neighbouring frames into the blocks of a chain."""

import numpy as np

from floorplan.chain import Chain
from floorplan.compiled import compiled
from floorplan.model.checks import Array


@compiled
def _add_rows(
    here: Array, there: Array, wide: Array, value: Array, weight: Array, diagonal: Array, coupling: Array, rhs: Array, dense: Array,
    dense_information: Array, dense_rhs: Array,
) -> tuple[float, float]:
    """Sum the rows into the blocks; gives back their weighted squares and the sum of the log weights."""
    square_sum, log_weight = 0.0, 0.0
    for i in range(value.shape[0]):
        for r in range(value.shape[1]):
            w, pulled = weight[i, r], weight[i, r] * value[i, r]
            a, b, c = here[i, r], there[i, r], wide[i, r]
            for j in range(len(a)):
                rhs[i, j] += pulled * a[j]
                rhs[i + 1, j] += pulled * b[j]
                for k in range(len(a)):
                    diagonal[i, j, k] += w * a[j] * a[k]
                    diagonal[i + 1, j, k] += w * b[j] * b[k]
                    coupling[i, j, k] += w * b[j] * a[k]
                for g in range(len(c)):
                    dense[i, j, g] += w * a[j] * c[g]
                    dense[i + 1, j, g] += w * b[j] * c[g]
            for g in range(len(c)):
                dense_rhs[g] += pulled * c[g]
                for k in range(len(c)):
                    dense_information[g, k] += w * c[g] * c[k]
            square_sum += pulled * value[i, r]
            log_weight += np.log(w)
    return square_sum, log_weight


class ChainBuilder:
    """Sums weighted rows into the blocks of a chain."""

    def __init__(self, count: int, states: int, width: int) -> None:
        self.diagonal = np.zeros((count, states, states))
        self.coupling = np.zeros((max(count - 1, 0), states, states))
        self.rhs = np.zeros((count, states))
        self.dense = np.zeros((count, states, width))
        self.dense_information = np.zeros((width, width))
        self.dense_rhs = np.zeros(width)
        self.square_sum = 0.0
        self.log_weight = 0.0

    def add_prior(self, frame: int, weight: tuple[float, ...]) -> None:
        """Independent zero-mean priors on one frame's states; weight 0 means none."""
        self.diagonal[frame] += np.diag(weight)
        self.log_weight += float(np.log([w for w in weight if w > 0]).sum())

    def add_places(self, states: tuple[int, ...], value: Array, weight: Array) -> None:
        """Rows `x_i[state] = value` of the given `weight (N,)` for each of the states: `value (N, len(states))`."""
        for column, state in enumerate(states):
            self.diagonal[:, state, state] += weight
            self.rhs[:, state] += weight * value[:, column]
            self.square_sum += float((weight * value[:, column] ** 2).sum())
            self.log_weight += float(np.log(weight).sum())

    def add_rows(self, here: Array, there: Array, wide: Array | None, value: Array, weight: Array) -> None:
        """Rows `here_i x_i + there_i x_{i+1} + wide_i g = value_i`: (N-1, rows, n), (N-1, rows, G), (N-1, rows)."""
        wide = np.zeros((*value.shape, self.dense.shape[2])) if wide is None else wide
        square_sum, log_weight = _add_rows(
            here, there, wide, value, weight, self.diagonal, self.coupling, self.rhs, self.dense, self.dense_information, self.dense_rhs
        )
        self.square_sum += square_sum
        self.log_weight += log_weight

    def chain(self, pinned: int) -> Chain:
        """The sums, with the gauge: the first `pinned` states of frame 0 leave the problem."""
        gone = slice(0, pinned)
        self.diagonal[0, gone, :] = self.diagonal[0, :, gone] = 0.0
        self.diagonal[0, gone, gone] = np.eye(pinned)
        self.coupling[:1, :, gone] = 0.0
        self.rhs[0, gone] = 0.0
        self.dense[0, gone] = 0.0
        return Chain(
            self.diagonal, self.coupling, self.rhs, self.dense, self.dense_information, self.dense_rhs, self.square_sum,
            self.log_weight, pinned,
        )
