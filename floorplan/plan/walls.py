"""Walls as they are drawn: face lines cut where another wall stands against them, outlines, hatch areas, thickness."""

from collections import defaultdict
from dataclasses import dataclass, replace

import numpy as np
from shapely.geometry import LineString
from shapely.geometry import Point as ShapelyPoint
from shapely.geometry.base import BaseGeometry
from shapely.ops import linemerge

from floorplan.model.checks import Array
from floorplan.model.plan import Certainty, Face, Point, Wall
from floorplan.plan.bodies import Body
from floorplan.plan.corners import FaceRun

PROBE_M = 0.01  # how far before a face is looked to see whether another wall stands against it
SNAP_M = 1e-3  # lines nearer than this are the same line
MIN_LINE_M = 0.02  # shorter pieces are not drawn


@dataclass(frozen=True)
class WallDrawing:
    """Faces and walls of the plan; `face_of_run` gives the faces each run became."""

    faces: tuple[Face, ...]
    walls: tuple[Wall, ...]
    owner: tuple[int, ...]  # run of each face


def draw_walls(
    runs: tuple[FaceRun, ...], bodies: tuple[Body, ...], matter: BaseGeometry, covariance_m2: Array | None, plane_ids: tuple[str, ...]
) -> WallDrawing:
    """Every run cut to what can be seen of it, and the bodies' outlines completed by inferred lines."""
    faces, owner = _faces(runs, matter, plane_ids)
    faces_of_run = defaultdict(list)
    for face, run in zip(faces, owner, strict=True):
        faces_of_run[run].append(face)
    drawn = _drawn_lines(faces)
    taken: set[str] = set()
    walls: list[Wall] = []
    for body in bodies:
        mine = [f for run in (body.low_face, body.high_face) for f in faces_of_run[run] if f.id not in taken and _touches(f, body)]
        taken |= {f.id for f in mine}
        walls.append(_body_wall(len(walls), body, mine, runs, matter, drawn, covariance_m2))
    for face in faces:
        if face.id not in taken and face.certainty is Certainty.SEEN:
            walls.append(_single_wall(len(walls), [face]))
        elif face.id not in taken:
            walls.append(Wall(f"W{len(walls) + 1}", (face.id,), (), ((face.start, face.end),)))
    return WallDrawing(tuple(faces), tuple(walls), tuple(owner))


def without_columns(drawing: WallDrawing, column_runs: frozenset[int]) -> tuple[Wall, ...]:
    """The walls but for those made of the sides of columns, which are drawn as columns."""
    sides = {face.id for face, run in zip(drawing.faces, drawing.owner, strict=True) if run in column_runs}
    walls = [wall for wall in drawing.walls if not (wall.faces and set(wall.faces) <= sides)]
    return tuple(replace(wall, id=f"W{k + 1}") for k, wall in enumerate(walls))


def _faces(runs: tuple[FaceRun, ...], matter: BaseGeometry, plane_ids: tuple[str, ...]) -> tuple[list[Face], list[int]]:
    faces: list[Face] = []
    owner: list[int] = []
    for index, run in enumerate(runs):
        for start, end, certainty in certain_parts(run):
            for a, b in _uncovered(run, start, end, matter):
                ends = (point_on(run, a), point_on(run, b))
                plane = plane_ids[run.run.plane]
                faces.append(Face(f"F{len(faces) + 1}", plane, *ends, certainty, run.run.low_m, run.run.high_m))
                owner.append(index)
    return faces, owner


def certain_parts(run: FaceRun) -> list[tuple[float, float, Certainty]]:
    """The run cut into seen and bridged parts, in order."""
    parts, at = [], run.start_m
    for a, b in run.run.seen:
        if a - at > MIN_LINE_M:
            parts.append((at, a, Certainty.INFERRED))
        else:
            a = at
        parts.append((a, b, Certainty.SEEN))
        at = b
    if run.end_m - at > MIN_LINE_M:
        parts.append((at, run.end_m, Certainty.INFERRED))
    return parts


def point_on(run: FaceRun, along_m: float, before_m: float = 0.0) -> Point:
    """The point of a run at a coordinate along it, `before_m` off the surface on the room side."""
    across = float(run.offset_m + run.facing * before_m)
    return (across, float(along_m)) if run.axis == 0 else (float(along_m), across)


def _uncovered(run: FaceRun, start: float, end: float, matter: BaseGeometry) -> list[tuple[float, float]]:
    """Parts of a stretch that no wall matter stands against."""
    line = LineString([point_on(run, start, PROBE_M), point_on(run, end, PROBE_M)])
    rest = line.difference(matter) if line.intersects(matter) else line
    along = 1 - run.axis
    pieces = [np.sort(np.asarray(piece.coords)[:, along]) for piece in getattr(rest, "geoms", [rest]) if not piece.is_empty]
    return [(float(p[0]), float(p[-1])) for p in pieces if p[-1] - p[0] > MIN_LINE_M]


def _drawn_lines(faces: list[Face]) -> BaseGeometry:
    from shapely.ops import unary_union

    return unary_union([LineString([face.start, face.end]).buffer(SNAP_M, cap_style="square") for face in faces])


def _touches(face: Face, body: Body) -> bool:
    middle = ShapelyPoint((face.start[0] + face.end[0]) / 2, (face.start[1] + face.end[1]) / 2)
    return bool(body.rectangle.distance(middle) < SNAP_M)


def _body_wall(
    number: int, body: Body, faces: list[Face], runs: tuple[FaceRun, ...], matter: BaseGeometry, drawn: BaseGeometry, cov: Array | None
) -> Wall:
    low, high = runs[body.low_face], runs[body.high_face]
    edge = body.rectangle.exterior.intersection(matter.boundary).difference(drawn)
    rest = [_on_corners(line, body) for line in lines_of(edge) if line.length > MIN_LINE_M]
    rest = [line for line in rest if not _stands_on_face(line, body, low, high)]
    jambs = [line for line in rest if _is_jamb(line, body, low, high)]
    seen = [(f.start, f.end) for f in faces if f.certainty is Certainty.SEEN] + jambs
    bridged = [(f.start, f.end) for f in faces if f.certainty is Certainty.INFERRED]
    heights = [f.high_m for f in faces if f.high_m is not None]
    corners = tuple((float(x), float(y)) for x, y in list(body.rectangle.exterior.coords)[:-1])
    return Wall(
        f"W{number + 1}",
        tuple(f.id for f in faces),
        merged_lines(seen),
        merged_lines(bridged + [line for line in rest if line not in jambs]),
        corners,
        body.thickness_m,
        distance_sigma_m(low, high, cov),
        max(heights) if heights else None,
    )


def _on_corners(line: LineString, body: Body) -> tuple[Point, ...]:
    """The line with its ends put on the body's corners where they all but lie there."""
    corners = [(float(x), float(y)) for x, y in list(body.rectangle.exterior.coords)[:-1]]
    points = []
    for x, y in line.coords:
        near = [c for c in corners if abs(c[0] - x) + abs(c[1] - y) < 3 * SNAP_M]
        points.append(near[0] if near else (float(x), float(y)))
    return tuple(points)


def _stands_on_face(line: tuple[Point, ...], body: Body, low: FaceRun, high: FaceRun) -> bool:
    """Whether an edge is an end with which the body stands against another wall's face: matter goes on there, nothing is drawn."""
    at = {round(p[1 - body.axis], 6) for p in line}
    if len(at) > 1:
        return False
    end = int(abs(at.pop() - body.start_m) > SNAP_M)
    return low.cornered[end] and high.cornered[end]


def _is_jamb(line: tuple[Point, ...], body: Body, low: FaceRun, high: FaceRun) -> bool:
    """Whether an edge is an end of the body beside which rays passed: a jamb is as good as seen."""
    at = {round(p[1 - body.axis], 6) for p in line}
    if len(at) > 1:
        return False
    starts = abs(at.pop() - body.start_m) < SNAP_M
    return (low.run.open_start and high.run.open_start) if starts else (low.run.open_end and high.run.open_end)


def _single_wall(number: int, faces: list[Face]) -> Wall:
    heights = [f.high_m for f in faces if f.high_m is not None]
    lines = tuple((f.start, f.end) for f in faces)
    return Wall(f"W{number + 1}", tuple(f.id for f in faces), lines, height_m=max(heights) if heights else None)


def distance_sigma_m(first: FaceRun, second: FaceRun, covariance_m2: Array | None) -> float:
    """Standard deviation of the distance between two faces, from their joint covariance, or as if independent without one."""
    a, b = first.run.plane, second.run.plane
    if covariance_m2 is None:
        return float(np.hypot(first.sigma_m, second.sigma_m))
    variance = covariance_m2[a, a] + covariance_m2[b, b] - 2 * covariance_m2[a, b]
    return float(np.sqrt(max(variance, 0.0)))


def lines_of(shape: BaseGeometry) -> list[LineString]:
    """The line strings of any geometry."""
    return [part for part in getattr(shape, "geoms", [shape]) if isinstance(part, LineString) and not part.is_empty]


def merged_lines(lines: list[tuple[Point, ...]]) -> tuple[tuple[Point, ...], ...]:
    """Lines joined end to end to polylines where they meet."""
    if not lines:
        return ()
    rounded = [LineString([(round(x, 6), round(y, 6)) for x, y in line]) for line in lines]
    joined = linemerge(rounded) if len(rounded) > 1 else rounded[0]
    return tuple(tuple((float(x), float(y)) for x, y in line.simplify(SNAP_M).coords) for line in lines_of(joined))
