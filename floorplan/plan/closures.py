"""Where a space ends although no wall was seen: openings of door width, and narrow gaps between ends of walls that line up."""

from collections.abc import Iterator
from dataclasses import dataclass

from floorplan.config import PlanConfig
from floorplan.plan.arrangement import Barrier
from floorplan.plan.corners import MIN_SIDE_M, FaceRun
from floorplan.plan.free_space import CELL_M
from floorplan.plan.gaps import OPEN_SHARE, Gap
from floorplan.plan.surface_evidence import MAX_LINE_GAP_M, SAME_SURFACE_M

MIN_WALL_PER_GAP = 1.0  # drawn wall in line with a gap, in gap widths: a doorway is in a wall, the space between two piers is not
NEARBY_WIDTHS = 2.0  # that wall is looked for this many widths to both sides
BACKED_SHARE = 0.5  # of a gap with a wall close behind: a recess


def opening_barriers(faces: tuple[FaceRun, ...], gaps: tuple[Gap, ...], thick: frozenset[int], config: PlanConfig) -> tuple[Barrier, ...]:
    """Openings up to door width, seen through or not, in walls known to be walls: thick, hit above the gap, or unseen there."""
    closed = []
    for gap in gaps:
        face = faces[gap.face]
        after = face if gap.after is None else faces[gap.after]
        seen_or_thick = gap.lintel or gap.passed < OPEN_SHARE or gap.face in thick or gap.after in thick
        in_wall = seen_or_thick or (gap.lintel is None and gap.after is not None)
        wide_in_wall = (gap.lintel or gap.lintel is None) and _in_wall(face, faces, gap.start_m, gap.end_m)
        closes = in_wall if gap.width_m <= config.max_door_width_m else gap.width_m <= config.max_opening_width_m and wide_in_wall
        if gap.is_window or closes:
            closed += [Barrier(face.axis, face.offset_m, gap.start_m, gap.end_m, solid=False)]
            closed += _step(face, after, gap.end_m if after.start_m >= gap.end_m - CELL_M else gap.start_m)
        elif gap.after is not None and gap.passed < OPEN_SHARE and gap.width_m <= config.max_opening_width_m:
            closed.append(Barrier(face.axis, face.offset_m, gap.start_m, gap.end_m, solid=False))
    return tuple(closed)


def _step(face: FaceRun, after: FaceRun, at_m: float) -> list[Barrier]:
    """The jog between two sides of an opening that are not quite in line."""
    low, high = sorted((face.offset_m, after.offset_m))
    return [Barrier(1 - face.axis, at_m, low, high, solid=False)] if high > low and face.axis == after.axis else []


@dataclass(frozen=True)
class _Ahead:
    """What stands ahead of a wall's end: at `at_m` along its line, `face`, `aside_m` the coordinate its near end has across the line."""

    at_m: float
    face: FaceRun
    across_m: float


def narrow_barriers(faces: tuple[FaceRun, ...], config: PlanConfig) -> tuple[Barrier, ...]:
    """Gaps up to door width ahead of wall ends: to a wall that goes on within a wall's thickness of the line, or to one across it."""
    closed: list[Barrier] = []
    for face in faces:
        for direction in (-1, +1):
            end = face.end_m if direction > 0 else face.start_m
            if face.inner[direction > 0]:
                continue
            ahead = min(_ahead(face, faces, end, direction, config), key=lambda one: abs(one.at_m - end), default=None)
            if ahead is None or abs(ahead.at_m - end) > config.max_door_width_m:
                continue
            low, high = sorted((end, ahead.at_m))
            if not _in_wall(face, faces, low, high) or _is_backed(face, faces, low, high, config):
                continue
            closed.append(Barrier(face.axis, face.offset_m, low, high, solid=False, weak=True))
            aside = sorted((face.offset_m, ahead.across_m))
            if aside[1] - aside[0] > MIN_SIDE_M:
                closed.append(Barrier(1 - face.axis, ahead.at_m, aside[0], aside[1], solid=False, weak=True))
    return tuple(closed)


def mouth_barriers(faces: tuple[FaceRun, ...], config: PlanConfig) -> tuple[Barrier, ...]:
    """Gaps wider than a door between ends of walls in line, in more wall than gap: what begins behind may be another space."""
    closed: list[Barrier] = []
    for face in faces:
        after = min((f for f in faces if _goes_on(face, f)), key=lambda f: f.start_m, default=None)
        if face.inner[1] or after is None:
            continue
        low, high = face.end_m, after.start_m
        wide = config.max_door_width_m < high - low <= MAX_LINE_GAP_M
        if wide and _in_wall(face, faces, low, high) and not _is_backed(face, faces, low, high, config):
            closed += [Barrier(face.axis, face.offset_m, low, high, solid=False, weak=True), *_step(face, after, high)]
    return tuple(closed)


def _goes_on(face: FaceRun, other: FaceRun) -> bool:
    """Whether a surface goes on as `other` beyond the end of `face`."""
    in_line = abs(other.offset_m - face.offset_m) <= SAME_SURFACE_M
    return other.axis == face.axis and other.facing == face.facing and in_line and other.start_m > face.end_m


def _ahead(face: FaceRun, faces: tuple[FaceRun, ...], end_m: float, direction: int, config: PlanConfig) -> Iterator[_Ahead]:
    for other in faces:
        if other is face:
            continue
        if other.axis == face.axis:
            at = other.start_m if direction > 0 else other.end_m
            if abs(other.offset_m - face.offset_m) <= config.max_thickness_m and (at - end_m) * direction > 0:
                yield _Ahead(at, other, other.offset_m)
        elif (other.offset_m - end_m) * direction > MIN_SIDE_M:
            across = min(max(face.offset_m, other.start_m), other.end_m)
            if abs(across - face.offset_m) <= config.max_thickness_m:
                yield _Ahead(other.offset_m, other, across)


def _in_wall(face: FaceRun, faces: tuple[FaceRun, ...], low_m: float, high_m: float) -> bool:
    """Whether enough wall is drawn in line with a gap."""
    width = high_m - low_m
    low, high = low_m - NEARBY_WIDTHS * width, high_m + NEARBY_WIDTHS * width
    in_line = [f for f in faces if f.axis == face.axis and abs(f.offset_m - face.offset_m) <= SAME_SURFACE_M]
    return sum(max(0.0, min(f.end_m, high) - max(f.start_m, low)) for f in in_line) >= MIN_WALL_PER_GAP * width


def _is_backed(face: FaceRun, faces: tuple[FaceRun, ...], low_m: float, high_m: float, config: PlanConfig) -> bool:
    """Whether a wall that faces the same way stands close behind a gap: a recess is part of its room."""
    backed = 0.0
    for other in faces:
        behind = (face.offset_m - other.offset_m) * face.facing
        if other.axis == face.axis and other.facing == face.facing and SAME_SURFACE_M < behind <= config.max_thickness_m:
            backed += max(0.0, min(other.end_m, high_m) - max(other.start_m, low_m))
    return backed > BACKED_SHARE * (high_m - low_m)
