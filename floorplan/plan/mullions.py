"""Mullions so broad that they were found as pieces of a wall: rows of them are one glass wall, not doors side by side."""

from itertools import groupby

import numpy as np
from shapely.geometry import LineString

from floorplan.model.checks import Array
from floorplan.plan.corners import FaceRun
from floorplan.plan.gaps import OPEN_SHARE, Gap
from floorplan.plan.glazing import MAX_MULLION_M, MAX_SPACING_M, MIN_SPACING_M, REGULAR, STEP_M, GlazedLine

MIN_ROW = 2  # mullions between three panes or more; a single post stands between two doors as well
GLAZED_SHARE = 0.5  # of a gap's width


def mullion_rows(faces: tuple[FaceRun, ...], gaps: tuple[Gap, ...]) -> tuple[GlazedLine, ...]:
    """A glazing line for every row of slender pieces at regular distances, from the wall before the first to the wall after the last."""
    links = {gap.face: gap for gap in gaps if gap.after is not None and gap.passed >= OPEN_SHARE and not gap.is_window}
    found: list[GlazedLine] = []
    for first in links:
        if _is_slender(faces[first]):
            continue
        row = _row_from(first, links, faces)
        for slender, posts in groupby(row[1:-1], key=lambda k: _is_slender(faces[k])):
            centres = np.array([(faces[k].start_m + faces[k].end_m) / 2 for k in posts])
            if slender and len(centres) >= MIN_ROW and _is_regular(centres):
                found.append(GlazedLine(faces[first].axis, faces[first].offset_m, faces[row[0]].end_m, faces[row[-1]].start_m))
    return tuple(found)


def _row_from(first: int, links: dict[int, Gap], faces: tuple[FaceRun, ...]) -> list[int]:
    """The faces from `first` over slender pieces to the next wall."""
    row = [first]
    while (gap := links.get(row[-1])) is not None and gap.after is not None:
        row.append(gap.after)
        if not _is_slender(faces[gap.after]):
            break
    return row


def _is_slender(face: FaceRun) -> bool:
    return face.run.length_m <= MAX_MULLION_M


def _is_regular(centres_m: Array) -> bool:
    steps = np.diff(centres_m)
    return bool(MIN_SPACING_M <= steps.mean() <= MAX_SPACING_M and np.ptp(steps) <= REGULAR * steps.mean())


def unglazed(gaps: tuple[Gap, ...], faces: tuple[FaceRun, ...], glazed: tuple[GlazedLine, ...], path_xy_m: Array) -> tuple[Gap, ...]:
    """The gaps that are no panes: not on a glazing line, or walked through."""
    path = LineString(path_xy_m) if len(path_xy_m) > 1 else LineString()
    return tuple(gap for gap in gaps if not any(_is_pane(gap, faces[gap.face], line, path) for line in glazed))


def _is_pane(gap: Gap, face: FaceRun, line: GlazedLine, path: LineString) -> bool:
    if face.axis != line.axis or abs(face.offset_m - line.offset_m) > STEP_M:
        return False
    ends = ((face.offset_m, gap.start_m), (face.offset_m, gap.end_m))
    sill = LineString(ends if face.axis == 0 else [(y, x) for x, y in ends])
    covered = min(gap.end_m, line.end_m) - max(gap.start_m, line.start_m)
    return covered > GLAZED_SHARE * gap.width_m and not path.intersects(sill)
