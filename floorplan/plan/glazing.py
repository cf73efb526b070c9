"""See-through partitions: hits at regular places on one line (mullions), rays that went through between them."""

from dataclasses import dataclass

import numpy as np

from floorplan.config import PlanConfig
from floorplan.model.checks import Array
from floorplan.model.plan import Glazing, Point
from floorplan.plan.arrangement import Barrier
from floorplan.plan.corners import FaceRun
from floorplan.plan.faces import spans
from floorplan.plan.plan_frame import PlanWorld

BIN_M = 0.05
LINE_HALF_WIDTH_M = 0.10  # a mullion's depth, and the scatter of readings at its edges
NEAR_FACE_M = 0.15  # points this near to a drawn face belong to it
MIN_MULLIONS = 3  # two posts may be anything
MAX_MULLION_M = 0.30
POST_SHARE = 0.1  # of the best cells' points: less is the trail of stray readings beside a post
MIN_SPACING_M, MAX_SPACING_M = 0.4, 2.5
REGULAR = 0.20  # spread of the spacings relative to their mean; mullions are set out by a grid
MIN_POINTS_PER_MULLION = 6
MIN_MULLION_HEIGHT_M = 0.4  # within the wall band: a post, not a shelf's edge
MIN_RAYS_BETWEEN = 5
STEP_M = 0.30  # a glazing line and the wall it goes on from stand no farther apart: a wall's thickness


@dataclass(frozen=True)
class GlazedLine:
    """A glazing line normal to `axis` at `offset_m`, from `start_m` to `end_m`."""

    axis: int
    offset_m: float
    start_m: float
    end_m: float

    @property
    def ends(self) -> tuple[Point, Point]:
        if self.axis == 0:
            return (self.offset_m, self.start_m), (self.offset_m, self.end_m)
        return (self.start_m, self.offset_m), (self.end_m, self.offset_m)


def glazed_lines(world: PlanWorld, faces: tuple[FaceRun, ...], config: PlanConfig) -> tuple[GlazedLine, ...]:
    """Lines with at least three regularly set mullions; none for level sweeps, which cannot tell a post from a leg."""
    if not world.heights:
        return ()
    z = world.point_m[:, 2]
    rows = np.flatnonzero((z > config.wall_band_low_m) & (z < config.wall_band_high_m))
    rows = rows[~_on_faces(world.point_m[rows], faces)]
    found: list[GlazedLine] = []
    for axis in (0, 1):
        for offset in _peaks(world.point_m[rows, axis]):
            line = _glazed_line(world, rows, axis, offset, faces, config)
            if line is not None:
                found.append(line)
    return tuple(found)


def as_glazing(lines: tuple[GlazedLine, ...]) -> tuple[Glazing, ...]:
    """The lines as they are drawn."""
    return tuple(Glazing(f"G{k + 1}", *line.ends) for k, line in enumerate(lines))


def _on_faces(point_m: Array, faces: tuple[FaceRun, ...]) -> Array:
    """Points (P,) that belong to a drawn face; one no wider than a mullion may be one of them."""
    near = np.zeros(len(point_m), dtype=bool)
    for axis in (0, 1):
        order = np.argsort(point_m[:, axis])  # so that each face looks at the few points beside it
        across = point_m[order, axis]
        for face in (face for face in faces if face.axis == axis and face.end_m - face.start_m > MAX_MULLION_M):
            first, last = np.searchsorted(across, (face.offset_m - NEAR_FACE_M, face.offset_m + NEAR_FACE_M))
            beside = order[first:last]
            along = point_m[beside, 1 - axis]
            near[beside[(along > face.start_m - NEAR_FACE_M) & (along < face.end_m + NEAR_FACE_M)]] = True
    return near


def _peaks(coordinate: Array) -> list[float]:
    """Coordinates at which points gather, best first, no two nearer than a line's width."""
    if not len(coordinate):
        return []
    low = float(coordinate.min())
    counts = np.bincount(((coordinate - low) / BIN_M).astype(np.int64)).astype(np.float64)
    smooth = np.convolve(counts, np.ones(3), mode="same")
    peaks: list[float] = []
    for bin_ in np.argsort(-smooth, kind="stable"):
        if smooth[bin_] < MIN_MULLIONS * MIN_POINTS_PER_MULLION:
            break
        at = low + (bin_ + 0.5) * BIN_M
        if all(abs(at - other) > 2 * LINE_HALF_WIDTH_M for other in peaks):
            peaks.append(float(at))
    return peaks


def _glazed_line(
    world: PlanWorld, rows: Array, axis: int, offset: float, faces: tuple[FaceRun, ...], config: PlanConfig
) -> GlazedLine | None:
    mine = rows[np.abs(world.point_m[rows, axis] - offset) < LINE_HALF_WIDTH_M]
    along, z = world.point_m[mine, 1 - axis], world.point_m[mine, 2]
    low = float(along.min()) - BIN_M
    cell = ((along - low) / BIN_M).astype(np.int64)
    counts = np.bincount(cell, minlength=cell.max() + 2)
    occupied = counts >= max(2.0, POST_SHARE * np.percentile(counts[counts > 0], 90))
    posts = []
    for a, b in spans(occupied):
        inside = (cell >= a) & (cell < b)
        high_enough = np.ptp(z[inside]) >= MIN_MULLION_HEIGHT_M
        if inside.sum() >= MIN_POINTS_PER_MULLION and (b - a) * BIN_M <= MAX_MULLION_M and high_enough:
            posts.append(float(np.median(along[inside])))
    regular = _regular(np.array(posts))
    if regular is None or not _seen_through(world, axis, offset, regular) or _before_a_wall(faces, axis, offset, regular, config):
        return None
    spacing = float(np.diff(regular).mean())
    ends = [_end_at_wall(faces, axis, offset, at, sign, spacing) for at, sign in ((regular[0], -1), (regular[-1], 1))]
    return GlazedLine(axis, float(np.median(world.point_m[mine, axis])), ends[0], ends[1])


def _regular(posts: Array) -> Array | None:
    """The longest sequence of posts with equal spacing, or None when shorter than three."""
    best: Array | None = None
    for first in range(len(posts)):
        for last in range(first + MIN_MULLIONS, len(posts) + 1):
            steps = np.diff(posts[first:last])
            fits = MIN_SPACING_M <= steps.mean() <= MAX_SPACING_M and np.ptp(steps) <= REGULAR * steps.mean()
            if fits and (best is None or last - first > len(best)):
                best = posts[first:last]
    return best


def _seen_through(world: PlanWorld, axis: int, offset: float, posts: Array) -> bool:
    """Whether rays crossed the line between all neighbouring posts."""
    sensor = world.trajectory.position_m
    before, beyond = sensor[world.point_frame, axis] - offset, world.point_m[:, axis] - offset
    through = np.flatnonzero((before * beyond < 0) & (np.abs(beyond) > 2 * LINE_HALF_WIDTH_M))
    t = before[through] / (before - beyond)[through]
    start = sensor[world.point_frame[through], 1 - axis]
    along = start + t * (world.point_m[through, 1 - axis] - start)
    counts = np.histogram(along, bins=posts)[0]
    return bool((counts >= MIN_RAYS_BETWEEN).all())


def _before_a_wall(faces: tuple[FaceRun, ...], axis: int, offset: float, posts: Array, config: PlanConfig) -> bool:
    """Whether a wall stands so near behind or before most of the posts that nothing could be seen through them but itself."""
    beside = np.zeros(len(posts), dtype=bool)
    for face in faces:
        if face.axis == axis and abs(face.offset_m - offset) <= config.max_thickness_m:
            beside |= (posts > face.start_m) & (posts < face.end_m)
    return bool(beside.mean() > 0.5)


def _end_at_wall(faces: tuple[FaceRun, ...], axis: int, offset: float, at: float, sign: int, spacing: float) -> float:
    """The nearest wall within one spacing beyond the last mullion, across the line or going on from it, else the mullion itself."""
    walls = []
    for face in faces:
        if face.axis != axis and face.start_m - NEAR_FACE_M <= offset <= face.end_m + NEAR_FACE_M:
            walls.append(face.offset_m)
        elif face.axis == axis and abs(face.offset_m - offset) <= STEP_M:
            walls.append(face.start_m if sign > 0 else face.end_m)
    ahead = [wall for wall in walls if 0 < (wall - at) * sign <= spacing * (1 + REGULAR)]
    return min(ahead, key=lambda wall: abs(wall - at)) if ahead else float(at)


def barriers_of(line: GlazedLine, faces: tuple[FaceRun, ...]) -> tuple[Barrier, ...]:
    """The line as a barrier, and the steps to walls that go on from its ends a little to the side."""
    barriers = [Barrier(line.axis, line.offset_m, line.start_m, line.end_m)]
    for at in (line.start_m, line.end_m):
        for face in faces:
            beside = face.axis == line.axis and 0 < abs(face.offset_m - line.offset_m) <= STEP_M
            if beside and at in (face.start_m, face.end_m):
                low, high = sorted((face.offset_m, line.offset_m))
                barriers.append(Barrier(1 - line.axis, at, low, high))
    return tuple(barriers)
