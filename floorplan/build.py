"""The whole job, in one function: read this first."""

from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from dataclasses import dataclass, field
from pathlib import Path
from typing import TypeVar

from floorplan.chunked_segments import segment_in_chunks
from floorplan.config import Config
from floorplan.corrections import Corrections, Surveyed
from floorplan.drawings import Drawing, check_sheet, drawing_beside
from floorplan.initial_layout import InitialLayout, initial_layout
from floorplan.kept_config import kept_config
from floorplan.kept_drawings import draw_what_changed
from floorplan.model.graph import LayoutSolution, MergeResult
from floorplan.model.plan import Plan
from floorplan.model.scan import IngestedScan
from floorplan.model.segment import SegmentedScan
from floorplan.readers import open_scan
from floorplan.reporting import Reporter, SilentReporter, in_one_step, tell_problems
from floorplan.results import Results, write_root_files
from floorplan.second_direction import direction_problems
from floorplan.several.shared import shared_planes, tell_shared
from floorplan.site import on_site
from floorplan.stage_counts import count_layout, count_merge, count_plan, count_scan, count_segments, count_solution
from floorplan.stage_functions import ingest
from floorplan.trim import trimmed
from floorplan.work.fingerprint import begun_fingerprint
from floorplan.work.folder import Owner, UntilReached, WorkFolder, claim
from floorplan.work.lock import locked
from floorplan.work.stages import INGEST, LEAST_SQUARES, MERGE, PLAN, RESOLVE, SEGMENTS, Stage

T = TypeVar("T")


@dataclass(frozen=True)
class Job:
    """What to build: the scan, where to keep its stages, which ones to make again or stop at, what to draw.

    `work` defaults to the scan's name with `.floorplan` beside it; `format` None is sniffed; `jobs` threads.
    """

    scan: Path
    work: Path
    config: Config = field(default_factory=Config)
    format: str | None = None
    redo_from: Stage | None = None
    until: Stage | None = None
    drawings: tuple[Drawing, ...] = ()
    jobs: int = 1


def build(job: Job, reporter: Reporter | None = None) -> Results | None:
    """Scan to plan; None when `job.until` stops before the plan. Raises `FloorplanError` for all a user can mend."""
    config, reporter = job.config, reporter or SilentReporter()
    fingerprint = begun_fingerprint(job.scan, job.work)
    source = trimmed(open_scan(job.scan, job.format, config.read), config.ingest.trim)
    check_sheet(job.drawings, config.drawing, source.recording.position_m[:, :2])
    owner = Owner(str(job.scan.resolve()), source.recording.format, fingerprint.result())
    with opened_work(job, owner, reporter) as work, suppress(UntilReached):
        scan = work.stage(INGEST, IngestedScan, lambda: ingest(source, config.ingest, reporter.progress), count_scan)
        tell_problems(reporter, scan.recording.problems)
        segmented = work.stage(SEGMENTS, SegmentedScan, lambda: segment_in_chunks(source, scan, config, work, job.jobs), count_segments)
        tell_problems(reporter, segmented.problems)
        return finish(job, work, scan, segmented, reporter)
    return None


def finish(job: Job, work: WorkFolder, scan: IngestedScan, segmented: SegmentedScan, reporter: Reporter) -> Results:
    """From segments to the plan, its files and drawings. Raises `UntilReached` where `job.until` stops before."""
    config = job.config

    def step(title: str, make: Callable[[], T]) -> Callable[[], T]:
        return lambda: in_one_step(reporter.progress(title), make)

    layout = work.stage(LEAST_SQUARES, InitialLayout, step("planes", lambda: initial_layout(scan, segmented, config)), count_layout)
    corrected = Corrections(config, work.path, reporter, job.jobs)
    merged = work.stage(MERGE, MergeResult, step("merging planes", lambda: corrected.merged(layout)), count_merge)
    known = Surveyed(scan, segmented, layout, merged)
    solution = work.stage(RESOLVE, LayoutSolution, step("solving again", lambda: corrected.solution(known)), count_solution)
    tell_problems(reporter, direction_problems(segmented))
    tell_shared(reporter, shared_planes(scan, layout.graph, solution))
    with drawing_beside(job.drawings, job.jobs) as second:

        def drawn() -> Plan:
            second.begin()
            return corrected.plan(known, solution)

        plan = work.stage(PLAN, Plan, step("plan", drawn), count_plan)
        results = Results(scan, segmented, layout, merged, solution, on_site(corrected.named(plan), config.site))
        table = write_root_files(results, job.scan, work.path, config)
        draw_what_changed(results, table, job.scan, job.drawings, config, reporter, work.path, second)
    return results


@contextmanager
def opened_work(job: Job, owner: Owner, reporter: Reporter) -> Iterator[WorkFolder]:
    """The work folder of `owner`'s scan, locked, with the effective configuration beside the stages."""
    claim(job.work, owner)
    with locked(job.work) as left_behind:
        if left_behind is not None:
            reporter.message(f"a build that ended early ({left_behind}) left this folder; what it finished is used")
        with kept_config(job.work, job.config):
            work = WorkFolder(job.work, owner, job.config, job.redo_from, job.until, reporter)
            work.forget_redone()
            yield work
