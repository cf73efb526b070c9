"""Level poses joined by measured relative poses: robust Gauss-Newton over all of them at once.

A joint says how one pose is seen from another, with an information matrix: nothing is claimed along a bare corridor. A slip
of the wheels is an outlier and not a drift, like a wrong loop: joints and bearings that fit badly hardly count, though a link of
the chain always a little.
"""

from dataclasses import dataclass

import numpy as np
from scipy import sparse
from scipy.sparse.linalg import splu

from floorplan.geometry import wrap_to
from floorplan.loop_closing.bearings import Bearings
from floorplan.model.checks import Array, freeze

FREEDOM = 4.0  # squared sigmas at which an error begins to count less: a loop 4 sigmas off counts a fifth
CHAIN_HOLDS = 0.02  # of a link of the chain counts whatever it says: without it the chain would fall apart
ROUNDS = 12  # for the last time; while loops are still being looked for a few bring the poses near enough
CONVERGED = 1e-4  # metres and radians
HELD = 1e12  # information of the first pose: the gauge


@dataclass(frozen=True)
class Joints:
    """J joints: `first (J,)`, `second (J,)` poses; `relative (J, 3)` x, y, yaw of the second seen from the first;
    `information (J, 3, 3)` of that."""

    first: Array
    second: Array
    relative: Array
    information: Array

    def __post_init__(self) -> None:
        freeze(
            self,
            {
                "first": (np.int64, ("J",)),
                "second": (np.int64, ("J",)),
                "relative": (np.float64, ("J", 3)),
                "information": (np.float64, ("J", 3, 3)),
            },
        )

    def __len__(self) -> int:
        return len(self.first)

    def joined(self, other: "Joints") -> "Joints":
        """Both together."""
        return Joints(*(np.concatenate((getattr(self, n), getattr(other, n))) for n in ("first", "second", "relative", "information")))


def relative_poses(first: Array, second: Array) -> Array:
    """Poses `second (J, 3)` seen from `first (J, 3)`; the yaw is a difference, not wrapped."""
    c, s = np.cos(first[:, 2]), np.sin(first[:, 2])
    d = second - first
    return np.column_stack((c * d[:, 0] + s * d[:, 1], c * d[:, 1] - s * d[:, 0], d[:, 2]))


def squared_errors(pose: Array, joints: Joints) -> Array:
    """Squared Mahalanobis error (J,) of every joint at the poses (N, 3)."""
    error = _errors(pose, joints)
    return np.asarray(np.einsum("ji,jik,jk->j", error, joints.information, error))


def solve_poses(pose: Array, joints: Joints, bearings: Bearings, rounds: int = ROUNDS) -> Array:
    """Most likely poses (N, 3), started at `pose`, the first held in place."""
    for k in range(rounds):
        step = _step(pose, joints, bearings, drawing_in=2 * k < rounds)
        pose = pose + step
        if 2 * k >= rounds and np.abs(step).max() < CONVERGED:
            break
    return pose


def _errors(pose: Array, joints: Joints) -> Array:
    error = relative_poses(pose[joints.first], pose[joints.second]) - joints.relative
    error[:, 2] = wrap_to(error[:, 2], 2 * np.pi)
    return error


def _step(pose: Array, joints: Joints, bearings: Bearings, drawing_in: bool) -> Array:
    """One Gauss-Newton step (N, 3) with every joint and bearing weighted by how well it fits now.

    `drawing_in`: the first rounds start far away, and loops pull like the chain before those that still do not fit are let go.
    """
    here, there = _jacobians(pose, joints)
    error = _errors(pose, joints)
    poor = 1.0 + np.einsum("ji,jik,jk->j", error, joints.information, error) / FREEDOM
    fitting = np.where(joints.second == joints.first + 1, np.maximum(1.0 / poor, CHAIN_HOLDS), 1.0 / poor)
    weight = 1.0 / np.sqrt(poor) if drawing_in else fitting
    weighted = joints.information * weight[:, None, None]
    count = 3 * len(pose)
    blocks, rows, columns, right = [], [], [], np.zeros((len(pose), 3))
    for at, left in ((joints.first, here), (joints.second, there)):
        turned = np.swapaxes(left, 1, 2) @ weighted
        np.subtract.at(right, at, np.einsum("jik,jk->ji", turned, error))
        for other, side in ((joints.first, here), (joints.second, there)):
            blocks.append(turned @ side)
            rows.append(np.broadcast_to(3 * at[:, None, None] + np.arange(3)[None, :, None], (len(at), 3, 3)))
            columns.append(np.broadcast_to(3 * other[:, None, None] + np.arange(3)[None, None, :], (len(at), 3, 3)))
    own = _own_information(pose, bearings, right)
    flat = [np.concatenate([part.reshape(-1) for part in parts]) for parts in (blocks, rows, columns)]
    information = sparse.coo_matrix((flat[0], (flat[1], flat[2])), shape=(count, count)) + sparse.diags(own)
    return np.asarray(splu(sparse.csc_matrix(information)).solve(right.reshape(-1)).reshape(-1, 3))


def _own_information(pose: Array, bearings: Bearings, right: Array) -> Array:
    """Diagonal (3 N,) of what is known of single poses; adds the bearings' pull to `right (N, 3)`."""
    own = np.zeros((len(pose), 3))
    own[0] = (HELD, HELD, 0.0 if len(bearings.node) else HELD)
    off = wrap_to(pose[bearings.node, 2] - bearings.yaw_rad, 2 * np.pi)
    weight = bearings.sigma_rad**-2 * FREEDOM / (FREEDOM + (off / bearings.sigma_rad) ** 2)
    own[bearings.node, 2] += weight
    right[bearings.node, 2] -= weight * off
    return own.reshape(-1)


def _jacobians(pose: Array, joints: Joints) -> tuple[Array, Array]:
    """Derivatives (J, 3, 3) of the errors by the first and by the second pose."""
    yaw = pose[joints.first, 2]
    c, s = np.cos(yaw), np.sin(yaw)
    seen = relative_poses(pose[joints.first], pose[joints.second])
    here, there = np.zeros((len(yaw), 3, 3)), np.zeros((len(yaw), 3, 3))
    there[:, 0, 0] = there[:, 1, 1] = c
    there[:, 0, 1], there[:, 1, 0] = s, -s
    there[:, 2, 2] = 1.0
    here[:, :2, :2] = -there[:, :2, :2]
    here[:, 0, 2], here[:, 1, 2], here[:, 2, 2] = seen[:, 1], -seen[:, 0], -1.0
    return here, there
