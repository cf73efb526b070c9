"""Several scans of one floor to one plan: each built on its own in a folder of its own, laid on the others, solved together."""

import hashlib
from collections.abc import Sequence
from contextlib import suppress
from dataclasses import dataclass, replace
from functools import cached_property
from pathlib import Path

from floorplan.build import Job, build, finish, opened_work
from floorplan.config import Config, CorrectionsConfig, EditsConfig, SiteConfig
from floorplan.errors import InputError, UsageError
from floorplan.model.scan import IngestedScan
from floorplan.model.segment import SegmentedScan
from floorplan.reporting import Progress, Reporter, SilentReporter
from floorplan.results import Results
from floorplan.several.correlate import Near
from floorplan.several.join import SolvedScan, joined_scan, part_turned
from floorplan.several.lay import lay_all
from floorplan.several.start import COMMON, MATCH, near_common_start, near_points, read_point_pairs
from floorplan.several.survey import Survey, survey_of
from floorplan.several.turned import in_one_row
from floorplan.stage_counts import count_scan, count_segments
from floorplan.trajectory import keyframe_trajectory
from floorplan.work.folder import Owner, UntilReached, read_stage_record
from floorplan.work.stages import INGEST, PLAN, SEGMENTS


def build_several(job: Job, scans: Sequence[Path], reporter: Reporter | None = None) -> Results | None:
    """Several scans to one plan; `job.scan` names them together. None and errors as `build`."""
    reporter = reporter or SilentReporter()
    check_scans(scans)
    if job.config.merge.method == "paper":
        raise UsageError("the published merge knows one trajectory; several scans need merge.method = evidence")
    singles = [_single_job(job, number, path) for number, path in enumerate(scans, 1)]
    if job.until in (INGEST, SEGMENTS):
        for single in singles:
            build(replace(single, until=job.until), _Named(reporter, single.work.name))
        return None
    finished = [build(single, _Named(reporter, single.work.name)) for single in singles]
    together = _Together(job.config, [results for results in finished if results is not None], singles)
    with opened_work(job, _owner(job, scans, together), reporter) as work, suppress(UntilReached):
        scan = work.stage(INGEST, IngestedScan, lambda: together.scan, count_scan)
        for part in scan.linked:
            reporter.message(f"{part.name} laid on the scans before it: {part.start}")
        segmented = work.stage(SEGMENTS, SegmentedScan, lambda: together.segmented(scan), count_segments)
        return finish(job, work, scan, segmented, reporter)
    return None


def check_scans(scans: Sequence[Path]) -> None:
    """Raise `UsageError` for a scan that is given twice."""
    seen: dict[Path, Path] = {}
    for path in scans:
        if (whole := path.resolve()) in seen:
            raise UsageError(f"{path} is given twice; give each recording once")
        seen[whole] = path


def title_of(scans: Sequence[Path]) -> str:
    """What several scans are called together."""
    return " + ".join(path.resolve().name for path in scans)


def _single_job(job: Job, number: int, path: Path) -> Job:
    """The build of one scan on its own; corrections by hand belong to the joint plan."""
    config = replace(job.config, corrections=CorrectionsConfig(), edits=EditsConfig(), site=SiteConfig())
    redo = job.redo_from if job.redo_from in (INGEST, SEGMENTS) else None
    return Job(path, job.work / f"scan-{number}", config, job.format, redo, None, (), job.jobs)


def _solved(single: Job, results: Results) -> SolvedScan:
    name = f"{single.work.name} ({single.scan.resolve().name})"
    return SolvedScan(name, str(single.scan.resolve()), results.scan, results.segmented, results.plan)


def _owner(job: Job, scans: Sequence[Path], together: "_Together") -> Owner:
    """The joint folder's owner: its fingerprint stands for the finished scans and for how they are started."""
    start = job.config.several
    keys = [record["key"] for single in together.jobs if (record := read_stage_record(single.work, PLAN)) is not None]
    digest = hashlib.sha256("\n".join([*keys, start.start, start.start_sha256]).encode()).hexdigest()
    formats = " + ".join(dict.fromkeys(results.scan.recording.format for results in together.results))
    return Owner(title_of(scans), formats, digest, tuple(str(path.resolve()) for path in scans))


@dataclass(frozen=True)
class _Together:
    """The finished scans, and what they make joined."""

    config: Config
    results: list[Results]
    jobs: list[Job]

    @property
    def scans(self) -> list[SolvedScan]:
        """The finished scans by name."""
        return [_solved(job, results) for job, results in zip(self.jobs, self.results, strict=True)]

    @cached_property
    def scan(self) -> IngestedScan:
        """The joined recording. Raises `InputError` for a scan that cannot be laid on the others."""
        names = [scan.name for scan in self.scans]
        surveys = [_survey(name, results) for name, results in zip(names, self.results, strict=True)]
        return joined_scan(self.scans, lay_all(surveys, names, _Start(self.config, surveys).of))

    def segmented(self, scan: IngestedScan) -> SegmentedScan:
        """All segments in the first scan's axis-aligned world."""
        turned = [part_turned(one.segmented, part) for one, part in zip(self.scans, scan.parts, strict=True)]
        return in_one_row(turned, [one.name for one in self.scans])


@dataclass(frozen=True)
class _Start:
    """Where each scan is looked for, by the settings."""

    config: Config
    surveys: list[Survey]

    def of(self, number: int, survey: Survey) -> Near | None:
        """See `lay_all`."""
        start = self.config.several.start
        if start == MATCH:
            return None
        if start == COMMON:
            return near_common_start(self.surveys[0], survey)
        return near_points(read_point_pairs(Path(start)), number, Path(start))


def _survey(name: str, results: Results) -> Survey:
    """Faces and free space of a finished scan in its plan frame."""
    from floorplan.plan.free_space import free_cells_xy_m
    from floorplan.plan.plan_frame import moved, solved_world

    scan, segmented, plan = results.scan, results.segmented, results.plan
    if not plan.faces:
        raise InputError(f"{name}: no walls in its plan; there is nothing to lay it on the others by")
    keyframes = keyframe_trajectory(scan, segmented.frames.world_from_sensor, results.solution.position_m)
    world = solved_world(scan, segmented, results.layout.tracks, results.solution, keyframes)
    return survey_of(plan, free_cells_xy_m(moved(world, plan.rotation_quarters, plan.shift_m)))


@dataclass(frozen=True)
class _Named:
    """A reporter that says which scan a message is about."""

    reporter: Reporter
    name: str

    def message(self, text: str) -> None:
        """See `Reporter`."""
        self.reporter.message(f"{self.name}: {text}")

    def detail(self, text: str) -> None:
        """See `Reporter`."""
        self.reporter.detail(f"{self.name}: {text}")

    def progress(self, title: str) -> Progress:
        """See `Reporter`."""
        return self.reporter.progress(f"{self.name} {title}")
