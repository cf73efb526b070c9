"""Tracks about the planes of a partition: offsets, what each track says against its plane, and the log evidence of the partition."""

from typing import NamedTuple

import numpy as np

from floorplan.compiled import compiled
from floorplan.model.checks import Array


class PlaneFit(NamedTuple):
    """Generalised least squares of `offset = G plane + error`, `W (T, T)` the inverse of the error's covariance, T tracks, K planes.

    `label (T,)`; `plane_m (K,)`, `covariance_m2 (K, K)` C; `WG (K, T)` = `(W G)^T`, `U (K, T)` = `C (W G)^T`, `pull (T,)` =
    `W (offset - G plane)`; `chi_square` of all residuals, `log_evidence` of the tracks' distances, planes integrated out, but for
    a constant (E14).
    """

    W: Array
    label: Array
    plane_m: Array
    covariance_m2: Array
    WG: Array
    U: Array
    residual_m: Array
    pull: Array
    chi_square: float
    log_evidence: float


def fit_planes(W: Array, offset_m: Array, label: Array) -> PlaneFit:
    """The planes of the labels `label` 0..K-1."""
    planes = int(label.max()) + 1
    WG = _column_sums(W, label, planes)
    information = np.zeros((planes, planes))
    np.add.at(information, label, WG.T)
    covariance = np.linalg.inv(information)
    plane = covariance @ (WG @ offset_m)
    residual = offset_m - plane[label]
    pull = W @ residual
    log_det = float(np.linalg.slogdet(information)[1])
    freedom = len(label) - planes
    chi_square = float(residual @ pull)
    evidence = -0.5 * (log_det + chi_square + freedom * np.log(2 * np.pi))
    return PlaneFit(W, label, plane, covariance, WG, covariance @ WG, residual, pull, chi_square, evidence)


@compiled
def _column_sums(W: Array, label: Array, planes: int) -> Array:
    """`(W G)^T` (K, T) of a symmetric `W`: the rows of each plane's tracks summed."""
    sums = np.zeros((planes, len(label)))
    for t in range(len(label)):
        row = sums[label[t]]
        for u in range(len(label)):
            row[u] += W[t, u]
    return sums
