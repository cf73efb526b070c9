"""Drawings and tables again from the finished stages of a work folder."""

from dataclasses import dataclass, replace
from pathlib import Path
from typing import TypeVar

from floorplan.config import Config
from floorplan.corrections import with_known_ids
from floorplan.drawing_process import DrawingProcess
from floorplan.drawings import Drawing, drawing_beside, write_drawings
from floorplan.errors import WorkFolderError
from floorplan.graph_file import save_graph
from floorplan.initial_layout import InitialLayout, tracked_graph
from floorplan.merge_table import MergeRow, merge_rows
from floorplan.model.advice import Advice
from floorplan.model.graph import LayoutSolution, MergeResult
from floorplan.model.plan import Plan
from floorplan.model.plane_moves import Changes
from floorplan.model.scan import IngestedScan
from floorplan.model.segment import SegmentedScan
from floorplan.model.ties import Calibration
from floorplan.recording_advice import recording_advice
from floorplan.reporting import Reporter
from floorplan.results import Results, summary, trajectories
from floorplan.site import on_site
from floorplan.survey_advice import survey_advice
from floorplan.work.disk import clear_disk_errors, new_file
from floorplan.work.folder import read_owner
from floorplan.work.stages import INGEST, LEAST_SQUARES, MERGE, PLAN, RESOLVE, SEGMENTS, STAGES, Stage
from floorplan.work.status import StageState, StageStatus, current_owner, stages_status
from floorplan.work.values import load_value

T = TypeVar("T")


@dataclass(frozen=True)
class Exported:
    """The files written, and the plan that is in them."""

    files: tuple[Path, ...]
    plan: Plan


def export(work: Path, config: Config, drawings: tuple[Drawing, ...], reporter: Reporter, jobs: int = 1) -> Exported:
    """Write `drawings` from the stages of `work` as they are, with more than one of `jobs` by two processes.

    Raises `WorkFolderError` when a stage is missing.
    """
    with drawing_beside(drawings, jobs) as second:
        second.begin()
        return _export(work, config, drawings, reporter, second)


def _export(work: Path, config: Config, drawings: tuple[Drawing, ...], reporter: Reporter, second: DrawingProcess) -> Exported:
    owner = read_owner(work)
    results = read_results(work)
    results = replace(results, plan=on_site(results.plan, config.site))
    stale = [state for state in stages_status(work, config, current_owner(owner, work)) if state.state is StageState.STALE]
    if stale:
        first, more = stale[0], "" if len(stale) == 1 else f", and {len(stale) - 1} more stages"
        reporter.message(f"note: {first.folder} is stale ({'; '.join(first.reasons)}){more}; 'floorplan build' would make them again")
    scan = Path(owner.scan)
    table = summary(results, trajectories(results), scan, work, config)
    return Exported(write_drawings(results, table, scan, drawings, config, reporter, second), results.plan)


def read_results(work: Path) -> Results:
    """The values of all six stages. Raises `WorkFolderError` naming the first one that is not finished."""
    return Results(
        scan=finished(work, INGEST, IngestedScan),
        segmented=finished(work, SEGMENTS, SegmentedScan),
        layout=finished(work, LEAST_SQUARES, InitialLayout),
        merged=finished(work, MERGE, MergeResult),
        solution=finished(work, RESOLVE, LayoutSolution),
        plan=with_known_ids(finished(work, PLAN, Plan), work),
    )


def read_calibration(work: Path) -> Calibration | None:
    """How the plan of a work folder was calibrated by tape; None where it was not, and for a `plan.json` alone."""
    if not (work / RESOLVE.folder / "stage.json").exists():
        return None
    return load_value(work / RESOLVE.folder, LayoutSolution).calibration


def read_advice(work: Path, states: tuple[StageStatus, ...]) -> tuple[Advice, ...]:
    """What would make the survey better, as far as the stages know that hold as they are."""
    kept = {state.folder for state in states if state.state is StageState.KEPT}
    if len(kept) == len(STAGES):
        return survey_advice(read_results(work))
    if INGEST.folder in kept:
        scan = finished(work, INGEST, IngestedScan)
        return () if scan.parts else recording_advice(scan.recording)
    return ()


def export_graph(work: Path, config: Config, path: Path) -> None:
    """Write the layout graph of `work` to `path`: the one that was solved, or, before that stage, the one its segments make."""
    scan = finished(work, INGEST, IngestedScan)
    states = {state.folder: state.state for state in stages_status(work, config, current_owner(read_owner(work), work))}
    if states[LEAST_SQUARES.folder] is StageState.KEPT:
        graph = finished(work, LEAST_SQUARES, InitialLayout).graph
    else:
        _, graph = tracked_graph(scan, finished(work, SEGMENTS, SegmentedScan), config)
    with clear_disk_errors(path), new_file(path) as making:
        save_graph(graph, making)


def read_merges(work: Path) -> tuple[MergeRow, ...]:
    """Every hypothesis of the finished merge. Raises `WorkFolderError` where it is not finished."""
    read_owner(work)
    layout = finished(work, LEAST_SQUARES, InitialLayout)
    return merge_rows(finished(work, INGEST, IngestedScan), layout, finished(work, MERGE, MergeResult))


def read_changes(work: Path) -> Changes:
    """What the finished merge changed once everything was merged. Raises `WorkFolderError` where it is not finished."""
    read_owner(work)
    merged = finished(work, MERGE, MergeResult)
    return Changes(merged.moves, merged.choices)


def finished(work: Path, stage: Stage, kind: type[T]) -> T:
    """The value of a finished stage of `work`. Raises `WorkFolderError` where it is not finished."""
    if not (work / stage.folder / "stage.json").exists():
        raise WorkFolderError(f"{work}: stage {stage.folder} is not finished; run 'floorplan build' on the scan first")
    return load_value(work / stage.folder, kind)
