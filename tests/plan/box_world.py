"""A tiny world of boxes, ray-cast exactly: truth for the plan that no code under test has made.

Walls, cabinets and lintels are axis-aligned boxes between a floor at z = 0 and a ceiling. A sensor stands at given places
and looks all round; its points are exact. Planes, tracks and poses are the true ones.
"""

from dataclasses import dataclass
from functools import cache

import numpy as np

from floorplan.config import PlanConfig
from floorplan.model.checks import Array
from floorplan.model.graph import LayoutSolution
from floorplan.model.plan import Plan
from floorplan.model.scan import GravitySource, IngestedScan, NoiseModel, Recording, Sensor, SensorKind, Trajectory
from floorplan.model.segment import NO_SEGMENT, EvidencePoints, FreePatches, ManhattanFrames, SegmentedScan, Segments, Tracks
from floorplan.plan import make_plan

Box = tuple[float, float, float, float, float, float]  # x0, x1, y0, y1, z0, z1
CEILING_M = 2.6
AZIMUTHS = np.deg2rad(np.arange(0.25, 360, 1.0))
ELEVATIONS = np.deg2rad(np.arange(-42, 43, 3.0))
MIN_POINTS = 8  # fewer points of one face in a frame make no segment


@dataclass(frozen=True)
class BoxScan:
    """What `make_plan` is given, for a world of boxes."""

    scan: IngestedScan
    segmented: SegmentedScan
    tracks: Tracks
    solution: LayoutSolution
    trajectory: Trajectory

    def plan(self, config: PlanConfig | None = None) -> Plan:
        return make_plan(self.scan, self.segmented, self.tracks, self.solution, self.trajectory, config or PlanConfig())


def wall_with_gap(axis: int, low: float, high: float, start: float, end: float, gaps: list[tuple[float, float, float]]) -> list[Box]:
    """Boxes of a straight wall normal to `axis` with openings (start, end, head height) cut out of it."""
    pieces: list[Box] = []
    at = start
    for a, b, head in gaps:
        pieces += [_upright(axis, low, high, at, a, 0.0, CEILING_M), _upright(axis, low, high, a, b, head, CEILING_M)]
        at = b
    pieces.append(_upright(axis, low, high, at, end, 0.0, CEILING_M))
    return pieces


def _upright(axis: int, low: float, high: float, start: float, end: float, bottom: float, top: float) -> Box:
    return (low, high, start, end, bottom, top) if axis == 0 else (start, end, low, high, bottom, top)


def cast(boxes: list[Box], sensors: list[tuple[float, float]], seed: int = 1, noise_m: float = 0.0, laser: bool = False) -> BoxScan:
    """Scan the boxes from sensors at 1.4 m above the floor, looking all round."""
    rng = np.random.default_rng(seed)
    position = np.array([(x, y, 1.4) for x, y in sensors])
    directions = _directions(np.zeros(1) if laser else ELEVATIONS)
    frames = [_cast_frame(boxes, p, directions) for p in position]
    faces = np.unique(np.concatenate([hits.face[hits.returned] for hits in frames]), axis=0)
    points = [_noisy(hits, directions, noise_m, rng) for hits in frames]
    segments, rows, owner = _segments(frames, points, faces)
    recording = _recording(position, laser)
    eye = np.tile(np.eye(3), (len(position), 1, 1))
    start = np.concatenate(([0], np.cumsum([len(p) for p in points])))
    evidence = EvidencePoints(start, np.concatenate(points), np.concatenate(rows), np.ones(start[-1]))
    rotations = ManhattanFrames(eye, np.full(len(eye), 1e-3), np.ones(len(eye), bool))
    axis, facing, offset = faces[:, 0].astype(int), faces[:, 1].astype(int), faces[:, 2]
    extent = np.stack([_extent(face, frames, points, position) for face in faces])
    sigma = np.full(len(faces), 0.002)
    solution = LayoutSolution(position, np.arange(len(faces)), axis, facing, offset, sigma, extent, np.diag(sigma**2), residual_m=0.0)
    return BoxScan(
        IngestedScan(recording, np.arange(len(position))),
        SegmentedScan(rotations, segments, no_patches(), evidence),
        Tracks(owner, axis, facing, extent),
        solution,
        Trajectory(recording.stamp_ns, position, eye),
    )


@dataclass(frozen=True)
class _Hits:
    """Where one frame's rays ended: `range_m (D,)`, inf for none, and the face hit as rows (axis, facing, offset) `face (D, 3)`."""

    range_m: Array
    face: Array

    @property
    def returned(self) -> Array:
        return np.isfinite(self.range_m)


def _directions(elevations: Array) -> Array:
    azimuth, elevation = (a.ravel() for a in np.meshgrid(AZIMUTHS, elevations))
    return np.stack((np.cos(azimuth) * np.cos(elevation), np.sin(azimuth) * np.cos(elevation), np.sin(elevation)), axis=1)


def _cast_frame(boxes: list[Box], origin: Array, directions: Array) -> _Hits:
    far = 1e3
    room: list[Box] = [(-far, far, -far, far, -1.0, 0.0), (-far, far, -far, far, CEILING_M, CEILING_M + 1)]
    best = np.full(len(directions), np.inf)
    face = np.zeros((len(directions), 3))
    with np.errstate(divide="ignore", invalid="ignore"):
        for solid in [*boxes, *room]:
            low, high = np.array(solid[::2]), np.array(solid[1::2])
            near, out = (low - origin) / directions, (high - origin) / directions
            enter = np.minimum(near, out)
            axis = np.argmax(enter, axis=1)
            t = enter[np.arange(len(axis)), axis]
            hit = (t < np.maximum(near, out).min(axis=1)) & (t > 1e-6) & (t < best) & (t < far / 2)
            forward = directions[np.arange(len(axis)), axis] > 0
            offset = np.where(forward, low[axis], high[axis])
            face[hit] = np.stack((axis, np.where(forward, -1, 1), offset), axis=1)[hit]
            best[hit] = t[hit]
    return _Hits(best, face)


def _noisy(hits: _Hits, directions: Array, noise_m: float, rng: np.random.Generator) -> Array:
    ranges = hits.range_m + noise_m * rng.standard_normal(len(directions))
    return (directions * ranges[:, None])[hits.returned]


def _segments(frames: list[_Hits], points: list[Array], faces: Array) -> tuple[Segments, list[Array], Array]:
    rows, table, boxes, owner = [], [], [], []
    for number, (hits, xyz) in enumerate(zip(frames, points, strict=True)):
        own = np.full(len(xyz), NO_SEGMENT)
        for k, face in enumerate(faces):
            mine = (hits.face[hits.returned] == face).all(axis=1)
            if mine.sum() >= MIN_POINTS:
                own[mine] = len(table)
                table.append((number, face[0], face[1], xyz[mine, int(face[0])].mean(), mine.sum()))
                boxes.append(np.stack((xyz[mine].min(axis=0), xyz[mine].max(axis=0)), axis=1))
                owner.append(k)
        rows.append(own)
    frame, axis, facing, distance, pixels = np.array(table).T
    n = len(table)
    nothing = np.zeros((n, 3)), np.zeros((n, 3, 3))
    segments = Segments(frame, axis, facing, distance, np.full(n, 0.002), pixels, pixels * 0.01, np.stack(boxes), *nothing)
    return segments, rows, np.array(owner)


def _extent(face: Array, frames: list[_Hits], points: list[Array], position: Array) -> Array:
    mine = [
        xyz[(hits.face[hits.returned] == face).all(axis=1)] + origin for hits, xyz, origin in zip(frames, points, position, strict=True)
    ]
    xyz = np.concatenate(mine)
    return np.stack((xyz.min(axis=0), xyz.max(axis=0)), axis=1)


def no_patches() -> FreePatches:
    return FreePatches(np.zeros(0), np.zeros(0), np.zeros((0, 2)), np.zeros((0, 2)), np.zeros((0, 2)), np.zeros(0), np.zeros(0))


def _recording(position: Array, laser: bool) -> Recording:
    n = len(position)
    kind = SensorKind.LASER if laser else SensorKind.CAMERA
    sensor = Sensor(kind, 1, len(AZIMUTHS), NoiseModel(0.005), 0.1, 50.0, np.deg2rad(1.0))
    down = np.tile([0.0, 0.0, -1.0], (n, 1))
    eye = np.tile(np.eye(3), (n, 1, 1))
    return Recording("boxes", sensor, np.arange(n) * 100_000_000, position, eye, down, GravitySource.LEVEL)


@cache
def two_rooms() -> BoxScan:
    """Rooms of 5 x 4 and 3 x 4 m, a 12 cm wall with a 0.9 m door (head 2.0 m) between them, a cabinet 1.8 m high in the first."""
    boxes: list[Box] = [
        (-0.3, 8.42, -0.3, 0.0, 0.0, CEILING_M),
        (-0.3, 8.42, 4.0, 4.3, 0.0, CEILING_M),
        (-0.3, 0.0, 0.0, 4.0, 0.0, CEILING_M),
        (8.12, 8.42, 0.0, 4.0, 0.0, CEILING_M),
        *wall_with_gap(0, 5.0, 5.12, 0.0, 4.0, [(1.5, 2.4, 2.0)]),
        (1.0, 2.0, 3.5, 4.0, 0.0, 1.8),
    ]
    path = [(x, 1.9) for x in np.linspace(1.2, 7.2, 22)] + [(1.2, 1.2), (3.0, 3.0), (4.2, 1.0), (6.5, 1.0), (6.6, 3.1)]
    return cast(boxes, path)
