"""What a person adds to a scan: distances measured by hand. The two last stages with them."""

import hashlib
from collections.abc import Callable
from dataclasses import dataclass, field, replace
from pathlib import Path

from floorplan.config import Config, SiteConfig
from floorplan.edits.file import Edits, read_edits
from floorplan.edits.merges import edit_merge, merge_notes
from floorplan.edits.plans import edit_plan, furniture_notes, furniture_tracks, without_tracks
from floorplan.errors import InputError, UsageError
from floorplan.initial_layout import InitialLayout
from floorplan.laser.spans import Span, find_span
from floorplan.laser.table import BadRow, LaserTable, read_laser
from floorplan.model.graph import LayoutSolution, MergeResult
from floorplan.model.plan import Plan
from floorplan.model.scan import IngestedScan
from floorplan.model.segment import SegmentedScan, Tracks
from floorplan.model.ties import Calibration
from floorplan.plan_names import NAME, Book, book_text, load_book, named
from floorplan.reporting import Reporter, SilentReporter
from floorplan.second_direction import direction_problems
from floorplan.several.start import COMMON, MATCH, read_point_pairs
from floorplan.site import read_control
from floorplan.stage_functions import make_plan, merge, resolve
from floorplan.trajectory import keyframe_trajectory
from floorplan.work.disk import clear_disk_errors, new_file

FULL_TURN_DEG = 360.0
LASER_NEEDS_WEIGHTS = "--laser needs the weighted rows of merge.method = evidence; the published merge has none"


@dataclass(frozen=True)
class Surveyed:
    """What is known of the scan before the two last stages."""

    scan: IngestedScan
    segmented: SegmentedScan
    layout: InitialLayout
    merged: MergeResult


@dataclass
class Corrections:
    """The corrections of one job on the work folder `work`, on `jobs` threads; the book of ids grows with every plan that is named."""

    config: Config
    work: Path
    reporter: Reporter = field(default_factory=SilentReporter)
    jobs: int = 1

    @property
    def edits(self) -> Edits:
        """The corrections by hand; none without a file."""
        path = self.config.edits.edits_file
        return read_edits(Path(path)) if path else Edits()

    def merged(self, layout: InitialLayout) -> MergeResult:
        """The merge, with what a person forbade or forced."""
        edits = self.edits
        result = merge(layout.graph, layout.least_squares, self.config.merge, edits)
        if not edits.never_merge and not edits.always_merge:
            return result
        return edit_merge(layout.graph, layout.before_merge(result.method), result, edits)

    def solution(self, known: Surveyed) -> LayoutSolution:
        """The re-solve, with the measured distances where there are any. Raises UsageError for a merge that has no covariance."""
        plain = resolve(known.layout.graph, known.merged, self.config.resolve)
        if not self.config.corrections.laser_file:
            return plain
        if known.merged.noise is None:
            raise UsageError(LASER_NEEDS_WEIGHTS)
        if plain.plane_covariance_m2 is None:
            plain = resolve(known.layout.graph, known.merged, replace(self.config.resolve, covariance=True))
        return self._calibrated(known, plain, read_laser(Path(self.config.corrections.laser_file)))

    def plan(self, known: Surveyed, solution: LayoutSolution) -> Plan:
        """The plan of a solution, corrected by hand; what was and what could not be is in its notes."""
        plan, edits = self.drawn(known, solution, known.layout.tracks), self.edits
        if edits == Edits():
            return plan
        base = self.named(plan)
        start = known.layout.before_merge(known.merged.method)
        notes = [*merge_notes(known.layout.graph, start, known.merged, edits), *furniture_notes(base, edits)]
        if gone := furniture_tracks(base, edits):
            base = self.named(self.drawn(known, solution, without_tracks(known.layout.tracks, gone)))
        edited = edit_plan(base, edits)
        return replace(edited.plan, notes=(*edited.plan.notes, *notes, *edited.notes))

    def drawn(self, known: Surveyed, solution: LayoutSolution, tracks: Tracks) -> Plan:
        """The plan of a solution as it is; the depth points follow its scale."""
        keyframes = keyframe_trajectory(known.scan, known.segmented.frames.world_from_sensor, solution.position_m)
        scale = solution.calibration.scale if solution.calibration else 1.0
        segmented = known.segmented if scale == 1.0 else scaled_segments(known.segmented, scale)
        plan = make_plan(known.scan, segmented, tracks, solution, keyframes, self.config.plan, self.jobs)
        return replace(plan, notes=(*plan.notes, *(f"{p.message}; {p.advice}." for p in direction_problems(known.segmented))))

    def named(self, plan: Plan) -> Plan:
        """The plan under the ids its things had in earlier builds."""
        return with_known_ids(plan, self.work)

    def _calibrated(self, known: Surveyed, plain: LayoutSolution, table: LaserTable) -> LayoutSolution:
        base = self.named(self.drawn(known, plain, known.layout.tracks))
        found = [find_span(base, row) for row in table.rows]
        bad = [*table.bad, *(BadRow(row.line, text) for row, text in zip(table.rows, found, strict=True) if isinstance(text, str))]
        for one in sorted(bad, key=lambda one: one.line):
            self.reporter.message(f"not used: {one.text}")
        spans = tuple(span for span in found if isinstance(span, Span))
        if not spans:
            raise InputError(f"{self.config.corrections.laser_file}: none of its {len(table.rows) + len(table.bad)} rows can be used")
        from floorplan.laser.calibrate import calibrate

        solution = calibrate(known.layout.graph, known.merged, plain, spans)
        return solution if solution.calibration is None else replace(solution, calibration=_framed(solution.calibration, base))


def _framed(calibration: Calibration, plan: Plan) -> Calibration:
    shift = float(plan.shift_m[0]), float(plan.shift_m[1])
    return replace(calibration, plan_quarters=plan.rotation_quarters, plan_shift_m=shift)


def with_known_ids(plan: Plan, work: Path) -> Plan:
    """The plan under the ids of the work folder's book, to which its new things are added."""
    book: Book = load_book(work)
    result = named(plan, book)
    if result.book != book:
        with clear_disk_errors(work), new_file(work / NAME) as making:
            making.write_text(book_text(result.book), "utf-8")
    return result.plan


def scaled_segments(segmented: SegmentedScan, scale: float) -> SegmentedScan:
    """Depth points and off-axis patches times `scale`."""
    points, patches = segmented.evidence, segmented.free_patches
    return replace(
        segmented,
        evidence=replace(points, point_sensor_m=points.point_sensor_m * scale),
        free_patches=replace(patches, start_m=patches.start_m * scale, end_m=patches.end_m * scale, height_m=patches.height_m * scale),
    )


def with_laser(config: Config, laser: Path | None) -> Config:
    """The configuration that uses the measured distances of a file.

    Raises InputError when it cannot be read, UsageError when the merge has no weighted rows to add it to.
    """
    path, digest = _checked_file(laser, config.corrections.laser_file, read_laser)
    if path and config.merge.method != "evidence":
        raise UsageError(LASER_NEEDS_WEIGHTS)
    return replace(config, corrections=replace(config.corrections, laser_file=path, laser_sha256=digest))


def with_edits(config: Config, edits: Path | None) -> Config:
    """The configuration that uses the edits of a file. Raises ConfigError when they cannot be read."""
    path, digest = _checked_file(edits, config.edits.edits_file, read_edits)
    return replace(config, edits=replace(config.edits, edits_file=path, edits_sha256=digest))


def with_start(config: Config, start: str | None) -> Config:
    """The configuration that lays several scans as `--start` says: a word, or a file of point pairs, which is read here to be sure."""
    word = start or config.several.start
    if word in (MATCH, COMMON):
        return replace(config, several=replace(config.several, start=word, start_sha256=""))
    path, digest = _checked_file(Path(word), "", read_point_pairs)
    return replace(config, several=replace(config.several, start=path, start_sha256=digest))


def with_site(config: Config, control: Path | None, north_deg: float | None) -> Config:
    """The configuration that places the plan on the site grid. Raises InputError when the control points cannot be read,
    UsageError for an angle that is none."""
    path, digest = _checked_file(control, config.site.control_file, read_control)
    north = config.site.north_deg if north_deg is None else north_deg
    if north is not None and not abs(north) <= FULL_TURN_DEG:
        raise UsageError(f"north at {north:g} degrees: give an angle from -360 to 360, counter-clockwise from the plan's +y")
    return replace(config, site=SiteConfig(path, digest, north))


def _checked_file(given: Path | None, configured: str, read: Callable[[Path], object]) -> tuple[str, str]:
    """Path and SHA-256 of the file given, else of the one configured; both empty without one. Whatever `read` raises is passed on."""
    path = str(given.resolve()) if given is not None else configured
    if not path:
        return "", ""
    read(Path(path))
    return path, hashlib.sha256(Path(path).read_bytes()).hexdigest()
