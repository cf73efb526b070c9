"""Interruptions of a wall face: between two runs of one surface, or between a run's end and the wall that crosses its line."""

from dataclasses import dataclass

import numpy as np

from floorplan.config import PlanConfig
from floorplan.model.checks import Array
from floorplan.plan.corners import MIN_SIDE_M, FaceRun
from floorplan.plan.surface_evidence import FINE_CELLS, SAME_SURFACE_M, PlaneEvidence

OPEN_SHARE = 0.6  # share of a gap's columns that rays must have passed for it to be an opening
MIN_LINTEL_SHARE = 0.5  # share of a gap's seen columns that must be hit above for a lintel
HEAD_ROOM_M = 1.7  # a lintel begins no lower than this
SILL_MAX_M = 1.3  # a window's sill ends no higher than this, a standing person looks out
SILL_MIN_M = 0.3  # lower is a threshold or a step
SILL_SHARE = 0.6  # share of a gap's columns that must be wall below the sill
LOW_M = 0.8  # a door is open below this; a window is not
FURNISHED_SHARE = 0.9  # of the rays below sill height that end at what stands before a gap: nobody goes through there
SILL_CLEAR_M = 0.15  # thresholds and skirting are no sill
JAMB_SIGMA_M = 0.009  # of a jamb that rays passed close to: widths of walked doors are off by 12 mm rms on simulated scans


@dataclass(frozen=True)
class Gap:
    """A gap along face `face` from `start_m` to `end_m`; `after` the run at its other end, or None for a crossing wall.

    `passed` share of its columns that rays went through at wall height; `lintel` whether it is hit above, None where
    nothing was seen there; `head_m`, `sill_m` heights of its upper and lower edge where seen; `low_open` whether rays
    went through near the floor, None where nothing was seen there; `furnished` whether something
    stands before all of it; `width_sigma_m` from how close to its ends rays passed.
    """

    face: int
    after: int | None
    start_m: float
    end_m: float
    passed: float
    lintel: bool | None
    head_m: float | None
    sill_m: float | None
    low_open: bool | None = None
    furnished: bool = False
    width_sigma_m: float = JAMB_SIGMA_M * np.sqrt(2)

    @property
    def width_m(self) -> float:
        return self.end_m - self.start_m

    @property
    def is_window(self) -> bool:
        """Wall below, no wall at eye height."""
        return self.sill_m is not None and self.sill_m >= SILL_MIN_M


def find_gaps(faces: tuple[FaceRun, ...], evidence: tuple[PlaneEvidence, ...], config: PlanConfig, heights: bool) -> tuple[Gap, ...]:
    """Every gap up to the widest door or, over a sill, window, with what the rays say about it."""
    by_plane = {item.plane: item for item in evidence}
    gaps = []
    for index, face in enumerate(faces):
        for start, end, after in _bounds(index, faces):
            if not MIN_SIDE_M < end - start <= config.max_window_width_m:
                continue
            gap = _gap(index, after, start, end, by_plane[face.run.plane], config, heights)
            if gap.width_m <= config.max_opening_width_m or gap.is_window:
                gaps.append(gap)
    return tuple(gaps)


def _bounds(index: int, faces: tuple[FaceRun, ...]) -> list[tuple[float, float, int | None]]:
    """Gaps beyond the two free ends of a face: to the next run of its surface, else to the next wall across its line."""
    face = faces[index]
    found: list[tuple[float, float, int | None]] = []
    for direction in (+1, -1):
        at = face.end_m if direction > 0 else face.start_m
        if face.inner[direction > 0]:
            continue
        ahead = [(_distance(face, faces[k], at, direction), k) for k in range(len(faces)) if k != index]
        distance, other = min(ahead, default=(np.inf, -1))
        if not np.isfinite(distance):
            continue
        parallel = faces[other].axis == face.axis
        if parallel and direction < 0:
            continue  # found from the other side
        start, end = (at, at + distance) if direction > 0 else (at - distance, at)
        found.append((start, end, other if parallel else None))
    return found


def _distance(face: FaceRun, other: FaceRun, at: float, direction: int) -> float:
    """How far ahead of an end the other face begins or crosses; inf where it does neither."""
    if other.axis == face.axis:
        if other.facing != face.facing or abs(other.offset_m - face.offset_m) > SAME_SURFACE_M:
            return np.inf
        ahead = (other.start_m - at) if direction > 0 else (at - other.end_m)
    else:
        if other.facing != -direction or not other.start_m - MIN_SIDE_M <= face.offset_m <= other.end_m + MIN_SIDE_M:
            return np.inf
        ahead = (other.offset_m - at) * direction
    return ahead if ahead > 0 else np.inf


def _gap(face: int, after: int | None, start: float, end: float, evidence: PlaneEvidence, config: PlanConfig, heights: bool) -> Gap:
    first, last = (
        int(np.clip(np.round((x - evidence.along_start_m) / evidence.along_step_m), 0, len(evidence.hits))) for x in (start, end)
    )
    last = max(last, first + 1)
    hits, passes, sigma = evidence.hits[first:last], evidence.passes[first:last], _width_sigma_m(start, end, evidence)
    if not heights:
        passed = float((passes.sum(axis=1) > hits.sum(axis=1)).mean())
        return Gap(face, after, start, end, passed, None, None, None, width_sigma_m=sigma)
    low, high = evidence.row(config.wall_band_low_m), evidence.row(config.wall_band_high_m)
    passed = float((passes[:, low:high].sum(axis=1) > hits[:, low:high].sum(axis=1)).mean())
    lintel, head = _lintel(hits, passes, evidence)
    sill, open_low = _sill_m(hits, passes, evidence), _low_open(hits, passes, evidence)
    furnished = _is_furnished(evidence, first, last)
    return Gap(face, after, start, end, passed, lintel, head, sill, open_low, furnished, sigma)


def _width_sigma_m(start: float, end: float, evidence: PlaneEvidence) -> float:
    """Of the distance of two jambs: each may lie anywhere from the wall's end, where it is drawn, to the ray that passed next to it."""
    step = evidence.along_step_m / FINE_CELLS
    first, last = (int(np.clip((x - evidence.along_start_m) / step, 0, len(evidence.fine_passes))) for x in (start, end))
    passed = np.flatnonzero(evidence.fine_passes[first:last])
    unseen = (passed[0], last - first - 1 - passed[-1]) if len(passed) else ((last - first) / 2, (last - first) / 2)
    return float(np.sqrt(sum(JAMB_SIGMA_M**2 + (cells * step) ** 2 / 3 for cells in unseen)))  # evenly from one end: length / sqrt(3)


def _lintel(hits: Array, passes: Array, evidence: PlaneEvidence) -> tuple[bool | None, float | None]:
    """Whether the columns are hit above head room, and the height at which the hits begin."""
    base = evidence.row(HEAD_ROOM_M)
    wall, free = hits[:, base:].sum(axis=0), passes[:, base:].sum(axis=0)
    rows = np.flatnonzero(wall + free > 0)
    if not len(rows):
        return None, None
    solid = wall > free
    top = rows[solid[rows]]
    covered = (hits[:, base:].sum(axis=1) > 0).mean()
    if not len(top) or covered < MIN_LINTEL_SHARE or not solid[rows[-1]]:
        return False, None
    free_below = np.flatnonzero(~solid[: top[-1]] & (free[: top[-1]] > 0))
    first = int(free_below[-1]) + 1 if len(free_below) else None
    if first is None:
        return True, None
    share = free[first - 1] / max(free[max(first - 2, 0)], free[first - 1], 1e-9) if wall[first - 1] > 0 else 1.0
    return True, evidence.up_start_m + (base + first - 1 + float(share)) * evidence.up_step_m


def _low_open(hits: Array, passes: Array, evidence: PlaneEvidence) -> bool | None:
    """Whether more rays passed than hit below the height of sills."""
    low, high = evidence.row(SILL_CLEAR_M), evidence.row(LOW_M)
    hit, passed = float(hits[:, low:high].sum()), float(passes[:, low:high].sum())
    return None if hit + passed == 0 else passed > hit


def _is_furnished(evidence: PlaneEvidence, first: int, last: int) -> bool:
    """Whether something stands right before every column below the height of sills, and next to no ray reached the gap there."""
    low, high = evidence.row(SILL_CLEAR_M), evidence.row(LOW_M)
    reached, blocked = (evidence.hits + evidence.passes)[first:last, low:high], evidence.blocked[first:last, low:high]
    every_column = bool((blocked.sum(axis=1) > 0).all())
    return every_column and float(blocked.sum()) >= FURNISHED_SHARE * float(blocked.sum() + reached.sum())


def _sill_m(hits: Array, passes: Array, evidence: PlaneEvidence) -> float | None:
    """Height up to which the gap is wall, or None where it is open to the floor."""
    low, high = evidence.row(SILL_CLEAR_M), evidence.row(SILL_MAX_M)
    wall = hits[:, low:high].sum(axis=0) > passes[:, low:high].sum(axis=0)
    if not wall.any() or (hits[:, low:high].sum(axis=1) > 0).mean() < SILL_SHARE:
        return None
    open_rows = np.flatnonzero(~wall & (passes[:, low:high].sum(axis=0) > 0))
    top = np.flatnonzero(wall)[-1]
    if len(open_rows) and open_rows[0] < top:
        return None
    return evidence.up_start_m + (low + int(top) + 1) * evidence.up_step_m
