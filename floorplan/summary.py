"""`summary.json`: the rows of the paper's table for one scan."""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from floorplan.model.graph import LayoutSolution, MergeResult
from floorplan.model.range_bias import RangeBias
from floorplan.model.scan import NANOSECONDS_PER_SECOND, IngestedScan, Problem, Trajectory, Wheels
from floorplan.model.segment import Tracks
from floorplan.trajectory import path_length_m


@dataclass(frozen=True)
class Trajectories:
    """The trajectory of every frame after each step of the method, in the plan frame."""

    odometry: Trajectory
    compass: Trajectory
    least_squares: Trajectory
    final: Trajectory


@dataclass(frozen=True)
class Drift:
    """Distance between the start and the end of the trajectory after each step, m; they were the same place."""

    odometry_m: float
    compass_m: float
    least_squares_m: float
    final_m: float


@dataclass(frozen=True)
class Summary:
    """The paper's table for one scan; `drift` is None where nothing says that the walk ended where it began.

    `complexity_reduction` = 1 - final planes / initial planes. `wheels` is what a laser's sweeps say about its robot's odometry,
    `range_bias` what the scan shows of its depth's own errors, None where nothing was estimated. `problems` are the bad data met;
    `key` stands for the stages this table was made from.
    """

    format: str
    frames: int
    keyframes: int
    duration_s: float
    path_length_m: float
    segments: int
    merge_method: str
    hypotheses_considered: int
    hypotheses_accepted: int
    initial_planes: int
    final_planes: int
    complexity_reduction: float
    residual_m: float
    delta_m: float
    drift: Drift | None
    wheels: Wheels | None
    range_bias: RangeBias | None
    problems: tuple[Problem, ...]
    seconds: Mapping[str, float]
    key: str


def summarise(
    scan: IngestedScan,
    tracks: Tracks,
    merged: MergeResult,
    solution: LayoutSolution,
    trajectories: Trajectories,
    returns_to_start: bool,
    range_bias: RangeBias | None,
    problems: tuple[Problem, ...],
    seconds: Mapping[str, float],
    key: str,
) -> Summary:
    """The table's rows; `seconds` per stage are those of the run that made each stage, `key` stands for all of them."""
    recording, initial, final = scan.recording, len(tracks.axis), len(solution.plane_axis)
    return Summary(
        format=recording.format,
        frames=len(recording),
        keyframes=len(scan.keyframe),
        duration_s=sum(float(np.ptp(recording.stamp_ns[rows])) for rows in scan.stretches) / NANOSECONDS_PER_SECOND,
        path_length_m=sum(path_length_m(trajectories.final.position_m[rows]) for rows in scan.stretches),
        segments=len(tracks.track_of_segment),
        merge_method=merged.method,
        hypotheses_considered=len(merged.hypotheses),
        hypotheses_accepted=int(merged.hypotheses.accepted.sum()),
        initial_planes=initial,
        final_planes=final,
        complexity_reduction=1 - final / initial if initial else 0.0,
        residual_m=solution.residual_m,
        delta_m=merged.delta_m,
        drift=_drift(trajectories) if returns_to_start else None,
        wheels=scan.wheels,
        range_bias=range_bias,
        problems=problems,
        seconds=seconds,
        key=key,
    )


def _drift(trajectories: Trajectories) -> Drift:
    steps = (trajectories.odometry, trajectories.compass, trajectories.least_squares, trajectories.final)
    return Drift(*(float(np.linalg.norm(step.position_m[-1] - step.position_m[0])) for step in steps))
