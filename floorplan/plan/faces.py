"""What is wall surface: runs of columns of a plane where rays were stopped at the height of walls, and not seen over the top."""

from collections import defaultdict
from dataclasses import dataclass
from enum import StrEnum

import numpy as np

from floorplan.config import PlanConfig
from floorplan.model.checks import Array
from floorplan.model.plan import Rejection
from floorplan.plan.edges import SEARCH_CELLS, rays_beyond, refined_edge_m
from floorplan.plan.surface_evidence import PlaneEvidence

MIN_GLIMPSES = 2  # keyframes that must have seen a piece on the surface of a wall that is well seen elsewhere, ...
MIN_GLIMPSED_M = 0.8  # ... or one longer than what stands or passes by in a room
MIN_POST_M, MAX_POST_M = 0.06, 0.40  # of a pier between two openings: wider is a wall, narrower a frame
MIN_POST_HEIGHT = 0.7  # of the wall band's rows that a pier must be hit in
TOP_WINDOW_M = 0.4  # how far below the highest evidence "seen over the top" looks
SPARSE_COLUMNS = 3  # points of one surface lie no farther apart than this when it was really looked at
MIN_OF_BLOCKED = 0.1  # what is hit less often than this share of what stands right before it is hit by stray readings alone
SMOOTH_COLUMNS = 2  # neighbours on each side whose rays are counted along with a column's own near the top


class Reason(StrEnum):
    """Why a candidate is not drawn as wall."""

    LOW = "does not reach wall height"
    SEEN_THROUGH = "rays passed through"
    OVER_TOP = "seen over the top"
    BEHIND = "behind what stands before it"
    SHORT = "too short"
    FEW_FRAMES = "seen in too few frames"
    DOUBLED = "doubled by a better supported face"
    REFLECTION = "mirrored by glass"
    PANE = "pane of a window"


@dataclass(frozen=True)
class Run:
    """A straight stretch of wall surface on `plane`, between two coordinates along it.

    `seen (K, 2)` the parts with own evidence, the rest was bridged; `low_m`, `high_m` heights hit; `hits` support;
    `open_start`, `open_end`: rays passed just beyond that end.
    """

    plane: int
    start_m: float
    end_m: float
    seen: tuple[tuple[float, float], ...]
    low_m: float | None
    high_m: float | None
    hits: float
    open_start: bool = False
    open_end: bool = False

    @property
    def length_m(self) -> float:
        return self.end_m - self.start_m


@dataclass(frozen=True)
class FaceEvidence:
    """The runs that are wall, slender ones that are if they stand in a wall's gap, and what was kept off the plan."""

    runs: tuple[Run, ...]
    posts: tuple[Run, ...]
    rejections: tuple[Rejection, ...]


@dataclass(frozen=True)
class ColumnVerdict:
    """Per column (U,): `wall` surface, `open` to rays, or neither; and the reasons against."""

    wall: Array
    open: Array
    low: Array
    over_top: Array


def find_runs(evidence: tuple[PlaneEvidence, ...], config: PlanConfig, heights: bool) -> FaceEvidence:
    """Wall runs of all planes, and rejections counted by reason."""
    runs: list[Run] = []
    posts: list[Run] = []
    lost: dict[Reason, list[float]] = defaultdict(list)
    for plane in evidence:
        verdict = judge_columns(plane, config, heights)
        kept, refused = _runs_of_plane(plane, verdict, config, heights)
        runs += kept
        posts += _posts(plane, verdict, config, heights)
        for reason, length in refused:
            lost[reason].append(length)
    rejections = tuple(Rejection(str(reason), len(lengths), float(sum(lengths))) for reason, lengths in sorted(lost.items()))
    return FaceEvidence(tuple(runs), tuple(posts), rejections)


def judge_columns(evidence: PlaneEvidence, config: PlanConfig, heights: bool) -> ColumnVerdict:
    """Judge every column of a plane by its rays at wall height; level sweeps have only one height to judge by."""
    low, high = (evidence.row(config.wall_band_low_m), evidence.row(config.wall_band_high_m)) if heights else (0, 1)
    hits, passes, blocked = (counts[:, low:high].sum(axis=1) for counts in (evidence.hits, evidence.passes, evidence.blocked))
    nothing = np.zeros(len(hits), dtype=bool)
    if not heights:
        return ColumnVerdict((hits > passes), passes >= np.maximum(hits, 1e-9), nothing, nothing)
    top = _near_the_top(evidence, high)
    over_top = top.passes > top.hits
    struck = (hits > passes) & (hits >= MIN_OF_BLOCKED * blocked)
    hidden = (hits + passes < MIN_OF_BLOCKED * blocked) & (top.hits > top.passes) & (top.hits >= MIN_OF_BLOCKED * top.blocked)
    wall = (struck | hidden) & ~over_top
    any_low = evidence.hits[:, :low].sum(axis=1) > 0
    wall = _continued(wall, any_low & (_rays_above(evidence, low) == 0))
    return ColumnVerdict(wall, passes > hits, any_low & ~wall & ~(hits > 0), over_top & (hits > passes))


def _rays_above(evidence: PlaneEvidence, row: int) -> Array:
    """Rays of any kind (U,) that crossed or ended before the columns from `row` up."""
    return np.asarray((evidence.hits + evidence.passes + evidence.blocked)[:, row:].sum(axis=1))


def _continued(wall: Array, unseen_above: Array) -> Array:
    """`wall (U,)` carried on along columns that were hit lower down and not looked at higher up: the view ends, not the wall."""
    reach = wall | unseen_above
    grown = wall.copy()
    for first, last in spans(reach):
        if wall[first:last].any():
            grown[first:last] = True
    return grown


@dataclass(frozen=True)
class _TopCounts:
    """Rays (U,) near the top of what was looked at."""

    hits: Array
    passes: Array
    blocked: Array


def _near_the_top(evidence: PlaneEvidence, band_top_row: int) -> _TopCounts:
    """The rays in the rows just below the highest ray that reached each column, its neighbours' rays included."""
    hits, passes, blocked = (_with_neighbours(counts) for counts in (evidence.hits, evidence.passes, evidence.blocked))
    rows = hits.shape[1]
    any_ray = hits + passes > 0
    top_row = np.where(any_ray.any(axis=1), rows - 1 - np.argmax(any_ray[:, ::-1], axis=1), 0)
    window = round(TOP_WINDOW_M / evidence.up_step_m)
    row = np.arange(rows)[None, :]
    inside = (row <= top_row[:, None]) & (row > top_row[:, None] - window) & (row >= band_top_row - window)
    return _TopCounts(*((counts * inside).sum(axis=1) for counts in (hits, passes, blocked)))


def _with_neighbours(counts: Array) -> Array:
    """`counts (U, Z)` summed over each column and SMOOTH_COLUMNS on each side of it."""
    around = np.pad(counts, ((SMOOTH_COLUMNS, SMOOTH_COLUMNS), (0, 0)))
    return np.asarray(np.lib.stride_tricks.sliding_window_view(around, 2 * SMOOTH_COLUMNS + 1, axis=0).sum(axis=2))


def _runs_of_plane(
    evidence: PlaneEvidence, verdict: ColumnVerdict, config: PlanConfig, heights: bool
) -> tuple[list[Run], list[tuple[Reason, float]]]:
    kept, glimpsed, refused = [], [], []
    found = bridged_spans(verdict, evidence.along_step_m, config.max_bridged_gap_m)
    for k, (first, last) in enumerate(found):
        before = first - found[k - 1][1] if k else first
        after = found[k + 1][0] - last if k + 1 < len(found) else len(verdict.wall) - last
        run = _run(evidence, verdict, _Span(first, last, before / 2, after / 2), heights)
        seen_in = evidence.frames(first, last)
        if run.length_m < config.min_wall_length_m:
            refused.append((Reason.SHORT, run.length_m))
        elif heights and run.hits < MIN_OF_BLOCKED * evidence.blocked[first:last].sum():
            refused.append((Reason.BEHIND, run.length_m))
        elif seen_in >= config.min_frames:
            kept.append(run)
        else:
            glimpsed.append((run, seen_in))
    on_wall = bool(kept)  # what goes on from a wall is believed sooner than a surface of its own
    for run, seen_in in glimpsed:
        if seen_in >= MIN_GLIMPSES and (on_wall or run.length_m >= MIN_GLIMPSED_M):
            kept.append(run)
        else:
            refused.append((Reason.FEW_FRAMES, run.length_m))
    through = verdict.open & (evidence.hits.sum(axis=1) > 0) & ~verdict.low
    for reason, columns in ((Reason.LOW, verdict.low), (Reason.OVER_TOP, verdict.over_top), (Reason.SEEN_THROUGH, through)):
        lengths = [(b - a) * evidence.along_step_m for a, b in spans(columns)]
        refused += [(reason, length) for length in lengths if length >= config.min_wall_length_m]
    return kept, refused


def _posts(evidence: PlaneEvidence, verdict: ColumnVerdict, config: PlanConfig, heights: bool) -> list[Run]:
    """Slender pieces as high as the wall band with rays past both ends: piers between two openings, if walls go on beyond those."""
    band = slice(evidence.row(config.wall_band_low_m), evidence.row(config.wall_band_high_m)) if heights else slice(0, 1)
    found = []
    for first, last in spans(verdict.wall):
        if (last - first) * evidence.along_step_m > MAX_POST_M + 2 * evidence.along_step_m:
            continue
        run = _run(evidence, verdict, _Span(first, last, SEARCH_CELLS, SEARCH_CELLS), heights)
        upright = (evidence.hits[first:last, band].sum(axis=0) > 0).mean() >= MIN_POST_HEIGHT
        if MIN_POST_M <= run.length_m <= MAX_POST_M and run.open_start and run.open_end and upright:
            found.append(run)
    return found


def spans(mask: Array) -> list[tuple[int, int]]:
    """Half-open index ranges where `mask (U,)` is true."""
    change = np.flatnonzero(np.diff(np.concatenate(([0], np.asarray(mask, dtype=np.int8), [0]))))
    return [(int(a), int(b)) for a, b in change.reshape(-1, 2)]


def bridged_spans(verdict: ColumnVerdict, step_m: float, max_gap_m: float) -> list[tuple[int, int]]:
    """Spans of wall columns, joined over gaps up to `max_gap_m` in which no ray passed."""
    joined: list[tuple[int, int]] = []
    for first, last in spans(verdict.wall):
        if joined:
            gap = slice(joined[-1][1], first)
            if (first - joined[-1][1]) * step_m <= max_gap_m and not (verdict.open[gap] | verdict.over_top[gap]).any():
                joined[-1] = (joined[-1][0], last)
                continue
        joined.append((first, last))
    return joined


def dense_spans(wall: Array) -> list[tuple[int, int]]:
    """Spans of seen columns; gaps of a few columns are the spacing of the thinned points, not something unseen."""
    joined: list[tuple[int, int]] = []
    for a, b in spans(wall):
        if joined and a - joined[-1][1] <= SPARSE_COLUMNS:
            joined[-1] = (joined[-1][0], b)
        else:
            joined.append((a, b))
    return joined


@dataclass(frozen=True)
class _Span:
    """Columns `first` to `last` (exclusive) and half the way to the neighbouring spans, in columns."""

    first: int
    last: int
    before: float
    after: float


def _run(evidence: PlaneEvidence, verdict: ColumnVerdict, span: _Span, heights: bool) -> Run:
    first, last, half = span.first, span.last, (span.last - span.first) / 2
    start = refined_edge_m(evidence, first, +1, half, span.before)
    end = refined_edge_m(evidence, last, -1, half, span.after)
    parts = [(evidence.along_m(first + a), evidence.along_m(first + b)) for a, b in dense_spans(verdict.wall[first:last])]
    seen = tuple((start if k == 0 else a, end if k == len(parts) - 1 else b) for k, (a, b) in enumerate(parts))
    open_ends = (rays_beyond(evidence, first, +1), rays_beyond(evidence, last, -1))
    hit_rows = np.flatnonzero(evidence.hits[first:last].sum(axis=0) > 0)
    low = evidence.up_start_m + hit_rows[0] * evidence.up_step_m if heights and len(hit_rows) else None
    high = evidence.up_start_m + (hit_rows[-1] + 1) * evidence.up_step_m if heights and len(hit_rows) else None
    return Run(evidence.plane, start, end, seen, low, high, float(evidence.hits[first:last].sum()), *open_ends)
