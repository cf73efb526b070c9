"""Everything a finished build knows, and the files at the root of its work folder."""

import json
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

import numpy as np

from floorplan.config import Config
from floorplan.initial_layout import InitialLayout
from floorplan.model.checks import Array
from floorplan.model.graph import LayoutSolution, MergeResult
from floorplan.model.plan import Plan
from floorplan.model.scan import IngestedScan, Trajectory
from floorplan.model.segment import SegmentedScan
from floorplan.plan.plan_json import plan_to_json
from floorplan.summary import Summary, Trajectories, summarise
from floorplan.trajectory import PlanFrame, every_frame, in_plan_frame, keyframe_trajectory, odometry_trajectory
from floorplan.work.disk import clear_disk_errors, new_file
from floorplan.work.fingerprint import TRUTH_NAME
from floorplan.work.folder import read_stage_record
from floorplan.work.stages import STAGES
from floorplan.work.values import write_json
from floorplan.writers.tum import write_tum


@dataclass(frozen=True)
class Results:
    """The values of all six stages."""

    scan: IngestedScan
    segmented: SegmentedScan
    layout: InitialLayout
    merged: MergeResult
    solution: LayoutSolution
    plan: Plan


def trajectories(results: Results) -> Trajectories:
    """Every frame's pose after each step of the method, in the plan frame."""
    frame = PlanFrame(results.plan.rotation_quarters, results.plan.shift_m)
    steps = results.layout.graph.translation_m
    dead_reckoned = np.concatenate((np.zeros((1, 3)), np.cumsum(steps, axis=0)))
    rotation = results.segmented.frames.world_from_sensor

    def after(position_m: Array) -> Trajectory:
        return in_plan_frame(every_frame(results.scan, keyframe_trajectory(results.scan, rotation, position_m)), frame)

    return Trajectories(
        odometry=in_plan_frame(odometry_trajectory(results.scan, rotation[0]), frame),
        compass=after(dead_reckoned),
        least_squares=after(results.layout.least_squares.position_m),
        final=after(results.solution.position_m),
    )


def summary(results: Results, paths: Trajectories, scan_path: Path, work: Path, config: Config) -> Summary:
    """The paper's table for this scan."""
    seconds = {stage.folder: record["seconds"] for stage in STAGES if (record := read_stage_record(work, stage)) is not None}
    told = (config.ingest.returns_to_start, _truth_returns_to_start(scan_path), results.scan.recording.returns_to_start)
    returns = next((answer for answer in told if answer is not None), False)
    return summarise(results.scan, results.layout.tracks, results.merged, results.solution, paths, returns, seconds)


def write_root_files(results: Results, scan_path: Path, work: Path, config: Config) -> Summary:
    """Write `plan.json`, the four trajectories and `summary.json` at the root of `work`; gives the summary."""
    paths = trajectories(results)
    table = summary(results, paths, scan_path, work, config)
    with clear_disk_errors(work):
        with new_file(work / "plan.json") as making:
            making.write_text(plan_to_json(results.plan), "utf-8")
        for name, trajectory in _files_of(paths).items():
            with new_file(work / name) as making:
                write_tum(trajectory, making)
        with new_file(work / "summary.json") as making:
            write_json(making, asdict(table))
    return table


def _files_of(paths: Trajectories) -> dict[str, Trajectory]:
    """The trajectories by the name of their file."""
    return {
        "trajectory.tum": paths.final,
        "trajectory-odometry.tum": paths.odometry,
        "trajectory-compass.tum": paths.compass,
        "trajectory-least-squares.tum": paths.least_squares,
    }


def _truth_returns_to_start(scan_path: Path) -> bool | None:
    """What the truth of a simulated scan says of the walk; nothing else is ever read from it."""
    path = scan_path / TRUTH_NAME
    if not path.is_file():
        return None
    truth: dict[str, Any] = json.loads(path.read_text("utf-8"))
    return truth.get("returns_to_start")
