"""The back end alone, on a layout graph from elsewhere: least squares, merge, re-solve, and the answer as JSON."""

import json
import time
from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any, Literal

import numpy as np

from floorplan.config import Config
from floorplan.layout_graph import with_signs_from_facing
from floorplan.least_squares import least_squares
from floorplan.merge import merge
from floorplan.model.graph import LayoutGraph, LayoutSolution, MergeResult
from floorplan.resolve import resolve


@dataclass(frozen=True)
class SolvedGraph:
    """What the back end made of a graph: decisions, solution, rows left out for their sign, seconds in all."""

    merged: MergeResult
    solution: LayoutSolution
    rejected_rows: int
    seconds: float


def solve_graph(
    graph: LayoutGraph,
    config: Config,
    method: Literal["paper", "evidence"] | None = None,
    covariance: bool = True,
    progress: Callable[[int, int], None] = lambda done, total: None,
) -> SolvedGraph:
    """Stages 3 to 5 on `graph`; `method` ("evidence" or "paper") goes before the configuration's.

    The published method takes plain rows. Raises NoSolutionError where a step has no solution that passes our checks.
    """
    started, steps = time.perf_counter(), 3
    merge_config = config.merge if method is None else replace(config.merge, method=method)
    rows = replace(config.least_squares, method="plain") if merge_config.method == "paper" else config.least_squares
    signed, rejected = with_signs_from_facing(graph)
    solution = least_squares(signed, rows)
    progress(1, steps)
    merged = merge(signed, solution, merge_config)
    progress(2, steps)
    resolved = resolve(signed, merged, replace(config.resolve, covariance=covariance))
    progress(3, steps)
    return SolvedGraph(merged, resolved, rejected, time.perf_counter() - started)


def solved_to_json(solved: SolvedGraph) -> str:
    """`OUT.json` of DESIGN.md, section 2. Raises ValueError (a bug) where a number is not finite."""
    merged, solution = solved.merged, solved.solution
    content: dict[str, Any] = {
        "method": merged.method,
        "positions": _numbers(solution.position_m),
        "plane_of_track": solution.plane_of_track.tolist(),
        "plane_axis": solution.plane_axis.tolist(),
        "plane_facing": solution.plane_facing.tolist(),
        "plane_offset_m": _numbers(solution.plane_offset_m),
        "plane_sigma_m": _numbers(solution.plane_sigma_m),
        "hypotheses": len(merged.hypotheses),
        "accepted": int(merged.hypotheses.accepted.sum()),
        "rejected_rows": solved.rejected_rows,
        "objective": merged.objective,
        "delta": merged.delta_m,
        "residual": merged.residual_m,
        "resolve_residual": solution.residual_m,
        "sigma_inflation": solution.sigma_inflation,
        "seconds": solved.seconds,
    }
    if solution.plane_covariance_m2 is not None:
        content["plane_covariance_m2"] = _numbers(solution.plane_covariance_m2)
    if merged.method == "paper":
        content["track_offset_m"] = _numbers(merged.track_offset_m)
    return json.dumps(content, allow_nan=False) + "\n"


def _numbers(array: np.ndarray) -> Any:
    return np.asarray(array).tolist()
