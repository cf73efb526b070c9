"""Doors, passages and windows: gaps that rays or the walker went through, with width, head and sill."""

from dataclasses import dataclass, replace

import numpy as np
from shapely.geometry import LineString

from floorplan.config import PlanConfig
from floorplan.model.checks import Array
from floorplan.model.plan import Opening, OpeningKind, Point, Wall
from floorplan.plan.corners import FaceRun
from floorplan.plan.gaps import OPEN_SHARE, Gap
from floorplan.plan.surface_evidence import SAME_SURFACE_M

AT_END_M = 0.10  # jambs of the two faces are drawn within this of the opening's mean end
MAX_DOOR_HEAD_M = 2.3  # door leaves end below; what begins higher is a beam or the head of a passage
RECESS_SHARE = 0.5  # of a gap backed by wall a wall's thickness behind: a recess or the space between piers, no opening
NEARBY_WIDTHS = 2.0  # wall that an opening is in is looked for this many widths to both sides
MIN_SHARED = 0.5  # two gaps of the two faces of a wall are one opening when they share this much of the narrower


@dataclass(frozen=True)
class GapGroup:
    """The gaps of one opening: of one face of a wall or of both."""

    gaps: tuple[Gap, ...]


def find_openings(
    gaps: tuple[Gap, ...], faces: tuple[FaceRun, ...], path_xy_m: Array, bodies: frozenset[int], config: PlanConfig
) -> tuple[Opening, ...]:
    """Openings O1.. from the gaps of wall faces; `bodies` are the faces that have a partner, `path_xy_m (F, 2)` where the sensor went."""
    path = LineString(path_xy_m) if len(path_xy_m) > 1 else LineString()
    openings: list[Opening] = []
    through = [gap for gap in gaps if _may_open(gap, config) and not _is_recess(gap, faces, config)]
    for group in _groups(through, faces, config):
        opening = _opening(len(openings) + 1, group, faces, path, bodies)
        if opening is not None:
            openings.append(opening)
    return tuple(openings)


def _may_open(gap: Gap, config: PlanConfig) -> bool:
    wide_enough = config.min_door_width_m <= gap.width_m <= config.max_opening_width_m
    return gap.passed >= OPEN_SHARE and (gap.is_window or wide_enough)


def _is_recess(gap: Gap, faces: tuple[FaceRun, ...], config: PlanConfig) -> bool:
    """Whether a wall that faces the same way stands close behind the gap."""
    own = faces[gap.face]
    backed = 0.0
    for face in faces:
        behind = (own.offset_m - face.offset_m) * own.facing
        if face.axis == own.axis and face.facing == own.facing and SAME_SURFACE_M < behind <= config.max_thickness_m:
            backed += max(0.0, min(face.end_m, gap.end_m) - max(face.start_m, gap.start_m))
    return backed > RECESS_SHARE * gap.width_m


def _groups(gaps: list[Gap], faces: tuple[FaceRun, ...], config: PlanConfig) -> list[GapGroup]:
    """Gaps of opposite faces of one wall taken together."""
    groups: list[GapGroup] = []
    for gap in gaps:
        for k, group in enumerate(groups):
            if any(_one_opening(gap, other, faces, config) for other in group.gaps):
                groups[k] = GapGroup((*group.gaps, gap))
                break
        else:
            groups.append(GapGroup((gap,)))
    return groups


def _one_opening(a: Gap, b: Gap, faces: tuple[FaceRun, ...], config: PlanConfig) -> bool:
    first, second = faces[a.face], faces[b.face]
    near = first.axis == second.axis and abs(first.offset_m - second.offset_m) <= config.max_thickness_m
    shared = min(a.end_m, b.end_m) - max(a.start_m, b.start_m)
    return near and shared > MIN_SHARED * min(a.width_m, b.width_m)


def _opening(number: int, group: GapGroup, faces: tuple[FaceRun, ...], path: LineString, bodies: frozenset[int]) -> Opening | None:
    gaps = group.gaps
    offsets = [faces[gap.face].offset_m for gap in gaps]
    start, end = float(np.mean([gap.start_m for gap in gaps])), float(np.mean([gap.end_m for gap in gaps]))
    axis = faces[gaps[0].face].axis
    middle, across = (start + end) / 2, (min(offsets) + max(offsets)) / 2
    centre = (across, middle) if axis == 0 else (middle, across)
    walked = bool(path.intersects(_sill_line(axis, across, start, end)))
    in_wall = any(_wall_beside_m(gap, faces) >= gap.width_m for gap in gaps)
    kind = _kind(gaps, walked, any(gap.face in bodies for gap in gaps), in_wall)
    if kind is None:
        return None
    spread = max(float(np.ptp([gap.start_m for gap in gaps])), float(np.ptp([gap.end_m for gap in gaps])))
    known = float(np.sqrt(np.mean([gap.width_sigma_m**2 for gap in gaps])))  # both faces' jambs were seen from the same poses: no average
    sigma = float(np.hypot(known, spread / 2))
    heads = [gap.head_m for gap in gaps if gap.head_m is not None]
    sills = [gap.sill_m for gap in gaps if gap.sill_m is not None]
    return Opening(
        f"O{number}",
        kind,
        centre,
        1 - axis,
        end - start,
        sigma,
        depth_m=max(offsets) - min(offsets),
        head_height_m=float(np.mean(heads)) if heads else None,
        sill_height_m=float(np.mean(sills)) if sills and kind is OpeningKind.WINDOW else None,
        walked_through=walked,
    )


def _sill_line(axis: int, across: float, start: float, end: float) -> LineString:
    ends: tuple[Point, Point] = ((across, start), (across, end)) if axis == 0 else ((start, across), (end, across))
    return LineString(ends)


def _wall_beside_m(gap: Gap, faces: tuple[FaceRun, ...]) -> float:
    """Length of the wall on the gap's line nearby: piers to both sides of a wide gap are no wall that it is an opening of."""
    own = faces[gap.face]
    same = [f for f in faces if f.axis == own.axis and f.facing == own.facing and abs(f.offset_m - own.offset_m) <= SAME_SURFACE_M]
    reach = NEARBY_WIDTHS * gap.width_m
    return sum(max(0.0, min(f.end_m, gap.end_m + reach) - max(f.start_m, gap.start_m - reach)) for f in same)


def _kind(gaps: tuple[Gap, ...], walked: bool, has_body: bool, in_wall: bool) -> OpeningKind | None:
    """Door under a lintel, window over a sill, passage in a wall where nothing is above; None where the evidence does not tell."""
    if not walked and all(gap.is_window for gap in gaps):
        return OpeningKind.WINDOW
    if not walked and all(gap.furnished for gap in gaps) and any(gap.lintel for gap in gaps):
        return OpeningKind.WINDOW  # its sill is hidden, but way through it is none
    if not walked and not any(gap.low_open for gap in gaps) and any(gap.lintel is not None for gap in gaps):
        return None  # hidden near the floor: a door or a window, who knows
    heads = [gap.head_m for gap in gaps if gap.head_m is not None]
    if any(gap.lintel for gap in gaps) and (not heads or min(heads) <= MAX_DOOR_HEAD_M):
        return OpeningKind.DOOR
    if not in_wall:
        return None
    if any(gap.lintel is not None for gap in gaps):
        between_ends = any(gap.after is not None for gap in gaps)  # open to the ceiling up to a wall across: two corridors that cross
        return OpeningKind.PASSAGE if between_ends and (has_body or walked) else None
    if has_body and walked:
        return OpeningKind.DOOR
    in_one_surface = all(gap.after is not None for gap in gaps)
    return OpeningKind.PASSAGE if walked or has_body or in_one_surface else None


def with_walls(openings: tuple[Opening, ...], walls: tuple[Wall, ...]) -> tuple[Opening, ...]:
    """The openings with the ids of the walls that end at them."""
    return tuple(replace(opening, walls=tuple(wall.id for wall in walls if _ends_at(wall, opening))) for opening in openings)


def _ends_at(wall: Wall, opening: Opening) -> bool:
    along = opening.along_axis
    for line in wall.seen:
        for point in line:
            off_end = abs(abs(point[along] - opening.centre[along]) - opening.width_m / 2)
            off_line = abs(point[1 - along] - opening.centre[1 - along])
            if off_end < AT_END_M and off_line < opening.depth_m / 2 + AT_END_M:
                return True
    return False
