"""What there is to see of a survey, in the colours of the paper's figures: x red, y green, z blue, the path black."""

from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from floorplan.model.checks import Array
from floorplan.model.plan import Face, PlanPlane
from floorplan.model.segment import AXIS_Z
from floorplan.placed_points import placed_points, points_on_segments, tape_scale
from floorplan.results import Results, trajectories

AXIS_COLOURS = ((214, 39, 40), (44, 150, 44), (31, 90, 190))  # red, green, blue, dark enough for a white ground
PATH_COLOUR = (0, 0, 0)
RAW_PATH_COLOUR = (150, 150, 150)
MOST_POINTS = 600_000  # a window stays smooth, a picture has no more pixels
CEILING_FACING = -1


@dataclass(frozen=True)
class Line3D:
    """A polyline `points_m (N, 3)` in one colour (RGB, 0 to 255); `dotted` for planes."""

    points_m: Array
    colour: tuple[int, int, int]
    dotted: bool = False


@dataclass(frozen=True)
class Scene3D:
    """`points_m (P, 3)` with `colours (P, 3) uint8`, and lines, all in the plan frame; `framed_m (K, 3)` is what a picture must hold."""

    points_m: Array
    colours: Array
    lines: tuple[Line3D, ...]
    framed_m: Array


def make_scene(results: Results, ceilings: bool = False) -> Scene3D:
    """The finished survey. Ceilings hide everything from above, so they are left out unless asked for."""
    paths = trajectories(results)
    placed = placed_points(results, paths.final, points_on_segments(results, MOST_POINTS), tape_scale(results))
    shown = np.full(len(placed.axis), True) if ceilings else ~((placed.axis == AXIS_Z) & (placed.facing == CEILING_FACING))
    planes = [plane for plane in results.plan.planes if ceilings or plane.axis != AXIS_Z or plane.facing != CEILING_FACING]
    outlines = tuple(Line3D(outline(plane), AXIS_COLOURS[plane.axis], dotted=True) for plane in planes)
    before = Line3D(paths.odometry.position_m, RAW_PATH_COLOUR)
    after = Line3D(paths.final.position_m, PATH_COLOUR)
    colours = np.array(AXIS_COLOURS, dtype=np.uint8)[placed.axis[shown]]
    framed = np.concatenate([*(_wall_corners(face) for face in results.plan.faces), after.points_m])
    return Scene3D(placed.point_m[shown], colours, (*outlines, before, after), framed)


def _wall_corners(face: Face) -> Array:
    """A wall face's four corners (4, 3); of level sweeps both heights are 0."""
    heights = (face.low_m or 0.0, face.high_m or 0.0)
    return np.array([(*end, height) for end in (face.start, face.end) for height in heights])


def outline(plane: PlanPlane) -> Array:
    """The plane's extent as a closed rectangle (5, 3)."""
    along = [axis for axis in range(3) if axis != plane.axis]
    corners = np.full((5, 3), plane.offset_m)
    for corner, (first, second) in enumerate(((0, 0), (1, 0), (1, 1), (0, 1), (0, 0))):
        corners[corner, along[0]] = plane.extent_m[along[0]][first]
        corners[corner, along[1]] = plane.extent_m[along[1]][second]
    return corners


def sampled(points_m: Array, step_m: float, dotted: bool) -> Array:
    """Points (N, 3) along a polyline, `step_m` apart; a dotted one has gaps as long as its dots."""
    pieces = []
    for start, end in pairwise(points_m[np.isfinite(points_m).all(axis=1)]):
        count = max(2, int(np.ceil(np.linalg.norm(end - start) / step_m)) + 1)
        share = np.linspace(0.0, 1.0, count)
        pieces.append((start + share[:, None] * (end - start))[_drawn(count, dotted)])
    return np.concatenate(pieces) if pieces else np.zeros((0, 3))


DOT_STEPS = 4  # samples that a dot is long, and the gap after it


def _drawn(count: int, dotted: bool) -> Array:
    return np.arange(count) % (2 * DOT_STEPS) < DOT_STEPS if dotted else np.full(count, True)
