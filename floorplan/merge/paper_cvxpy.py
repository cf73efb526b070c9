"""The published problem verbatim, all variables, in cvxpy + Clarabel: the reference for the reduced engine."""

from dataclasses import dataclass
from typing import Any

import numpy as np
from scipy import sparse

from floorplan.errors import NoSolutionError
from floorplan.merge.paper_problem import PaperAnswer, PaperProblem, empty_ball
from floorplan.model.checks import Array
from floorplan.rows import AXES, axis_rows, design_matrix, split
from floorplan.signs import least_squares_with_signs

ADVICE = "Try merge.engine = 'reduced', or a smaller merge.radius_m (fewer hypotheses), or a larger merge.eps (a wider ball)."


@dataclass(frozen=True)
class VerbatimMatrices:
    """`A`, `b`, `E`, `D` of METHOD.md over `xi` = per axis p_1 .. p_{N-1}, then that axis' planes.

    `track_column (M,)` and `frame_column (N, 3)` (-1 at the gauge) say where each unknown is; rows of `D` are the graph's measurements.
    """

    a: sparse.csr_array
    b: Array
    e: sparse.csr_array
    d: sparse.csr_array
    track_column: Array
    frame_column: Array


def solve_verbatim(problem: PaperProblem) -> PaperAnswer:
    """Clarabel's answer to the published problem, unchecked. Raises NoSolutionError when it gives none."""
    import cvxpy

    matrices = verbatim_matrices(problem)
    xi = cvxpy.Variable(matrices.a.shape[1])
    gap = cvxpy.Variable(matrices.e.shape[0])
    same = gap == matrices.e @ xi  # a name for `E xi`, so that its dual `y` can be read
    ball = cvxpy.norm2(matrices.a @ xi - matrices.b) <= problem.delta_m
    signs = matrices.d @ xi <= 0
    program = cvxpy.Problem(cvxpy.Minimize(cvxpy.norm1(gap)), [same, ball, signs])
    try:
        program.solve(solver=cvxpy.CLARABEL)
    except cvxpy.error.SolverError as error:
        raise NoSolutionError(
            f"Clarabel gave up on the published problem ({len(problem.pairs)} hypotheses, {matrices.a.shape[1]} unknowns): {error} {ADVICE}"
        ) from error
    if program.status in (cvxpy.INFEASIBLE, cvxpy.INFEASIBLE_INACCURATE):
        raise empty_ball(problem, least_squares_with_signs(problem.graph).residual)
    if xi.value is None:
        raise NoSolutionError(f"Clarabel found no answer (status {program.status}). {ADVICE}")
    return _answer(matrices, np.asarray(xi.value), same.dual_value, signs.dual_value)


def _answer(matrices: VerbatimMatrices, xi: Array, same_dual: Any, sign_dual: Any) -> PaperAnswer:
    position = np.where(matrices.frame_column >= 0, xi[matrices.frame_column], 0.0)
    # cvxpy's Lagrangian is ||gap||_1 + dual^T (gap - E xi), so y, the pull of E, is minus the dual of `same`.
    return PaperAnswer(position, xi[matrices.track_column], -np.asarray(same_dual), np.asarray(sign_dual))


def verbatim_matrices(problem: PaperProblem) -> VerbatimMatrices:
    """`A`, `b`, `E`, `D` of a problem, verbatim."""
    graph, pairs = problem.graph, problem.pairs
    blocks, right, start = [], [], 0
    track_column = np.zeros(len(graph.axis), dtype=np.int64)
    frame_column = np.full((len(graph.stamp_s), 3), -1)
    for axis in AXES:
        rows = axis_rows(graph, axis)
        blocks.append(design_matrix(rows))
        right.append(np.concatenate((rows.distance_m, rows.step_m)))
        frame_column[1:, axis] = start + np.arange(rows.frames - 1)
        track_column[split(graph, axis).track] = start + rows.frames - 1 + np.arange(rows.planes)
        start += rows.frames - 1 + rows.planes
    e = _difference_rows(track_column[pairs.first], track_column[pairs.second], np.ones(len(pairs)), start)
    sensor = frame_column[graph.frame, graph.axis[graph.track]]
    d = _difference_rows(track_column[graph.track], sensor, graph.facing[graph.track].astype(np.float64), start)
    return VerbatimMatrices(sparse.csr_array(sparse.block_diag(blocks)), np.concatenate(right), e, d, track_column, frame_column)


def _difference_rows(plus: Array, minus: Array, scale: Array, columns: int) -> sparse.csr_array:
    """Rows `scale (x_plus - x_minus)`; a column of -1 stands for the gauge, which is 0."""
    row = np.arange(len(plus))
    index = (np.concatenate((row, row)), np.concatenate((plus, minus)))
    value = np.concatenate((scale, -scale))
    known = index[1] >= 0
    return sparse.csr_array(sparse.coo_array((value[known], (index[0][known], index[1][known])), shape=(len(plus), columns)))
