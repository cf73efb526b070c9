"""The rows of `A xi = b`, axis by axis: measurements `m_j - p_i = d_ij` and odometry `p_{i+1} - p_i = t_i`."""

from dataclasses import dataclass

import numpy as np
from scipy import sparse

from floorplan.model.checks import Array, freeze
from floorplan.model.graph import LayoutGraph

AXES = (0, 1, 2)


@dataclass(frozen=True)
class RowWeights:
    """Weight of every row, `1 / sigma^2` in 1/m^2 or 1 where rows are unweighted: `measurement (K,)`, `odometry (N-1, 3)`."""

    measurement: Array
    odometry: Array

    def __post_init__(self) -> None:
        freeze(self, {"measurement": (np.float64, ("K",)), "odometry": (np.float64, ("T", 3))})


@dataclass(frozen=True)
class AxisRows:
    """All rows of one axis, N frames and V planes.

    `frame (K,)`, `plane (K,)`, `distance_m (K,)`, `weight (K,)`: measurements; `step_m (N-1,)`, `step_weight (N-1,)`: odometry.
    """

    planes: int
    frame: Array
    plane: Array
    distance_m: Array
    weight: Array
    step_m: Array
    step_weight: Array

    @property
    def frames(self) -> int:
        """N, with frame 0, whose position is the gauge."""
        return len(self.step_m) + 1


@dataclass(frozen=True)
class AxisSolution:
    """Positions (N,) and plane offsets (V,) along one axis, metres."""

    position_m: Array
    offset_m: Array


@dataclass(frozen=True)
class AxisSplit:
    """Where one axis lies in the graph: `track (V,)` its tracks, `row (K,)` its measurements."""

    axis: int
    track: Array
    row: Array


def unweighted(graph: LayoutGraph) -> RowWeights:
    """Weight 1 for every row, as published."""
    return RowWeights(np.ones(len(graph.frame)), np.ones_like(graph.translation_m))


def split(graph: LayoutGraph, axis: int) -> AxisSplit:
    """The tracks and the measurement rows of `axis`."""
    return AxisSplit(axis, np.flatnonzero(graph.axis == axis), np.flatnonzero(graph.axis[graph.track] == axis))


def axis_rows(graph: LayoutGraph, axis: int, weights: RowWeights | None = None) -> AxisRows:
    """The rows of `axis`; plane v is the v-th track of that axis. Unweighted when `weights` is None."""
    weights = weights or unweighted(graph)
    part = split(graph, axis)
    plane_of_track = np.full(len(graph.axis), len(part.track))
    plane_of_track[part.track] = np.arange(len(part.track))
    return AxisRows(
        planes=len(part.track),
        frame=graph.frame[part.row],
        plane=plane_of_track[graph.track[part.row]],
        distance_m=graph.distance_m[part.row],
        weight=weights.measurement[part.row],
        step_m=graph.translation_m[:, axis],
        step_weight=weights.odometry[:, axis],
    )


def squared_residual(rows: AxisRows, solution: AxisSolution) -> float:
    """Weighted sum of squared residuals of one axis."""
    seen = solution.offset_m[rows.plane] - solution.position_m[rows.frame] - rows.distance_m
    walked = np.diff(solution.position_m) - rows.step_m
    return float(rows.weight @ seen**2 + rows.step_weight @ walked**2)


def residual_norm(graph: LayoutGraph, position_m: Array, track_offset_m: Array) -> float:
    """Unweighted `||A xi - b||_2` over all rows of all three axes, for `position_m (N, 3)` and `track_offset_m (M,)`."""
    along = graph.axis[graph.track]
    seen = track_offset_m[graph.track] - position_m[graph.frame, along] - graph.distance_m
    walked = np.diff(position_m, axis=0) - graph.translation_m
    return float(np.sqrt(np.sum(seen**2) + np.sum(walked**2)))


def sums_by(index: Array, value: Array, size: int) -> Array:
    """Sums of `value (K,)` over equal `index (K,)`, float64 (size,), also when K is 0."""
    return np.bincount(index, value, size).astype(np.float64, copy=False)


def right_hand_side(rows: AxisRows) -> AxisSolution:
    """`A^T W b` split into its frame part (N,), zero at the gauge, and its plane part (V,)."""
    seen, walked = rows.weight * rows.distance_m, rows.step_weight * rows.step_m
    position = -sums_by(rows.frame, seen, rows.frames)
    position[1:] += walked
    position[:-1] -= walked
    position[0] = 0.0
    return AxisSolution(position, sums_by(rows.plane, seen, rows.planes))


def design_matrix(rows: AxisRows) -> sparse.csr_array:
    """`A` of one axis as a sparse matrix: columns p_1 .. p_{N-1}, then the planes; measurements first, then odometry."""
    count, frames = len(rows.frame), rows.frames
    row, step = np.arange(count), np.arange(frames - 1)
    row_index = np.concatenate((row, row, count + step, count + step))
    column = np.concatenate((frames + rows.plane, rows.frame, step + 1, step))
    value = np.concatenate((np.ones(count), -np.ones(count), np.ones(frames - 1), -np.ones(frames - 1)))
    full = sparse.coo_array((value, (row_index, column)), shape=(count + frames - 1, frames + rows.planes))
    return sparse.csr_array(full.tocsc()[:, 1:])
