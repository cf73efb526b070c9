"""Everything a finished build knows, and the files at the root of its work folder."""

import hashlib
import json
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

import numpy as np

from floorplan import __version__
from floorplan.config import Config, SiteConfig
from floorplan.initial_layout import InitialLayout
from floorplan.model.checks import Array
from floorplan.model.graph import LayoutSolution, MergeResult
from floorplan.model.plan import Plan
from floorplan.model.scan import IngestedScan, Problem, Trajectory
from floorplan.model.segment import SegmentedScan
from floorplan.plan_names import NAME as BOOK_NAME
from floorplan.readers.simulated import returns_to_start as truth_returns_to_start
from floorplan.second_direction import direction_problems
from floorplan.summary import Summary, Trajectories, summarise
from floorplan.trajectory import PlanFrame, every_frame, in_plan_frame, keyframe_trajectory, odometry_trajectory
from floorplan.work.disk import clear_disk_errors, new_file
from floorplan.work.folder import read_stage_record
from floorplan.work.stages import STAGES
from floorplan.work.values import decode, write_json

PLAN_NAME, SUMMARY_NAME = "plan.json", "summary.json"
TRAJECTORY_NAMES = ("trajectory.tum", "trajectory-odometry.tum", "trajectory-compass.tum", "trajectory-least-squares.tum")
ROOT_KEY_DIGITS = 16


@dataclass(frozen=True)
class Results:
    """The values of all six stages."""

    scan: IngestedScan
    segmented: SegmentedScan
    layout: InitialLayout
    merged: MergeResult
    solution: LayoutSolution
    plan: Plan

    @property
    def problems(self) -> tuple[Problem, ...]:
        """Bad data met in the recording, then in the frames that were looked at."""
        return self.scan.recording.problems + self.segmented.problems + direction_problems(self.segmented)


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
        least_squares=after(results.layout.before_merge(results.merged.method).position_m),
        final=after(results.solution.position_m),
    )


def summary(results: Results, paths: Trajectories, scan_path: Path, work: Path, config: Config) -> Summary:
    """The paper's table for this scan."""
    seconds = {folder: record["seconds"] for folder, record in _records(work).items()}
    returns = _returns_to_start(results, scan_path, config)
    key = root_key(work, returns, config)
    layout = results.layout
    return summarise(
        results.scan, layout.tracks, results.merged, results.solution, paths, returns, layout.range_bias, results.problems, seconds, key
    )


def write_root_files(results: Results, scan_path: Path, work: Path, config: Config) -> Summary:
    """Bring `plan.json`, the four trajectories and `summary.json` at the root of `work` up to date; gives the summary.

    Files that were made from the very same stages are left as they are. The summary goes first and comes last: while it
    stands there, the others belong to it.
    """
    if (known := _kept_summary(work, root_key(work, _returns_to_start(results, scan_path, config), config))) is not None:
        return known
    from floorplan.plan.plan_json import plan_to_json
    from floorplan.writers.tum import write_tum

    paths = trajectories(results)
    table = summary(results, paths, scan_path, work, config)
    with clear_disk_errors(work):
        (work / SUMMARY_NAME).unlink(missing_ok=True)
        with new_file(work / PLAN_NAME) as making:
            making.write_text(plan_to_json(results.plan), "utf-8")
        for name, trajectory in _files_of(paths).items():
            with new_file(work / name) as making:
                write_tum(trajectory, making)
        for number, trajectory in enumerate(_of_each_scan(results.scan, paths.final), 1):
            with new_file(work / f"trajectory-scan-{number}.tum") as making:
                write_tum(trajectory, making)
        with new_file(work / SUMMARY_NAME) as making:
            write_json(making, asdict(table))
    return table


def root_key(work: Path, returns_to_start: bool, config: Config) -> str:
    """What the root files depend on: stages by their keys, book of ids, version, the setting that only the summary reads, the site."""
    site = [config.site.control_sha256, config.site.north_deg] if config.site != SiteConfig() else []
    keys = [record["key"] for record in _records(work).values()]
    book = (work / BOOK_NAME).read_text("utf-8") if (work / BOOK_NAME).exists() else ""
    return hashlib.sha256(json.dumps([*keys, book, __version__, returns_to_start, *site]).encode()).hexdigest()[:ROOT_KEY_DIGITS]


def _kept_summary(work: Path, key: str) -> Summary | None:
    """The summary at the root, where it and all files beside it were made under `key`."""
    if not all((work / name).is_file() for name in (SUMMARY_NAME, PLAN_NAME, *TRAJECTORY_NAMES)):
        return None
    tree = json.loads((work / SUMMARY_NAME).read_text("utf-8"))
    return decode(Summary, tree, {}) if tree.get("key") == key and tree.keys() == Summary.__dataclass_fields__.keys() else None


def _records(work: Path) -> dict[str, dict[str, Any]]:
    return {stage.folder: record for stage in STAGES if (record := read_stage_record(work, stage)) is not None}


def _returns_to_start(results: Results, scan_path: Path, config: Config) -> bool:
    truth = None if config.ingest.trim else truth_returns_to_start(scan_path)  # of the whole walk
    told = (config.ingest.returns_to_start, truth, results.scan.recording.returns_to_start)
    return next((answer for answer in told if answer is not None), False)


def _of_each_scan(scan: IngestedScan, path: Trajectory) -> list[Trajectory]:
    """The trajectory of each of several scans; none of a single one."""
    if not scan.parts:
        return []
    return [Trajectory(path.stamp_ns[rows], path.position_m[rows], path.world_from_sensor[rows]) for rows in scan.stretches]


def _files_of(paths: Trajectories) -> dict[str, Trajectory]:
    """The trajectories by the name of their file."""
    return dict(zip(TRAJECTORY_NAMES, (paths.final, paths.odometry, paths.compass, paths.least_squares), strict=True))
