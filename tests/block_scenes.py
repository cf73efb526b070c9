"""Layout graphs with truth for the back end's tests: corridors round jagged blocks, walked in loops with drifting odometry."""

import itertools
from dataclasses import dataclass

import numpy as np

from floorplan.model.checks import Array
from floorplan.model.graph import LayoutGraph

CORRIDOR_M = 2.0
RANGE_M = 6.0
STEP_M = 0.15
EYE_M = 1.4
HEIGHT_M = 2.6


@dataclass(frozen=True)
class SceneSettings:
    """What goes wrong in a scene; standard deviations."""

    columns: int = 2
    rows: int = 2
    legs: int = 14
    depth_sigma_m: float = 0.010
    bias_sigma_m: float = 0.0
    rate_m_per_sqrt_m: float = 0.010
    scale_sigma: float = 0.02
    sideways_sigma: float = 0.01
    global_scale: float = 0.0
    outliers: float = 0.0
    flipped: float = 0.0
    recess_m: tuple[float, float] = (0.1, 1.5)


@dataclass(frozen=True)
class Scene:
    """A graph and its truth: `plane_of_track (M,)`, `offset_m (M,)` relative to the start, `position_m (N, 3)` with p_0 = 0."""

    graph: LayoutGraph
    plane_of_track: Array
    offset_m: Array
    position_m: Array


@dataclass(frozen=True)
class Wall:
    axis: int
    offset: float
    low: float
    high: float
    facing: int


def make_scene(seed: int, settings: SceneSettings = SceneSettings()) -> Scene:
    """One seeded scene; walls of equal axis, facing and coordinate are one true plane."""
    rng = np.random.default_rng(seed)
    xs = np.cumsum(rng.uniform(7, 12, settings.columns + 1))
    ys = np.cumsum(rng.uniform(7, 12, settings.rows + 1))
    walls = _walls(rng, xs, ys, settings)
    path, heading = _walk(rng, xs, ys, settings.legs)
    seen = _see(path, heading, walls)
    return _graph(rng, path, walls, seen, settings)


def _walls(rng: np.random.Generator, xs: Array, ys: Array, settings: SceneSettings) -> list[Wall]:
    """Four sides per block, each in pieces of which some stand back from the corridor; plus the outer ring."""
    half, walls = CORRIDOR_M / 2, []
    for x0, x1 in itertools.pairwise(xs):
        for y0, y1 in itertools.pairwise(ys):
            walls += _side(rng, 0, x0 + half, (y0 + half, y1 - half), -1, settings)
            walls += _side(rng, 0, x1 - half, (y0 + half, y1 - half), 1, settings)
            walls += _side(rng, 1, y0 + half, (x0 + half, x1 - half), -1, settings)
            walls += _side(rng, 1, y1 - half, (x0 + half, x1 - half), 1, settings)
    for axis, (a, b) in ((0, (xs, ys)), (1, (ys, xs))):
        span = (b[0] - half, b[-1] + half)
        walls += _side(rng, axis, a[0] - half, span, 1, settings)
        walls += _side(rng, axis, a[-1] + half, span, -1, settings)
    return walls


def _side(
    rng: np.random.Generator, axis: int, offset: float, span: tuple[float, float], facing: int, settings: SceneSettings
) -> list[Wall]:
    cuts = [span[0]]
    while cuts[-1] < span[1] - 4:
        cuts.append(cuts[-1] + rng.uniform(1.5, 3.5))
    cuts.append(span[1])
    walls, last = [], offset
    for k, (low, high) in enumerate(itertools.pairwise(cuts)):
        inside = 0 < k < len(cuts) - 2
        back = rng.uniform(*settings.recess_m) if inside and rng.random() < 0.4 else 0.0
        here = round(offset - facing * back, 3)
        walls.append(Wall(axis, here, low, high, facing))
        if here != last:
            step = facing if (here - last) * facing < 0 else -facing
            walls.append(Wall(1 - axis, low, min(here, last), max(here, last), 1 if step == facing else -1))
        last = here
    return walls


def _walk(rng: np.random.Generator, xs: Array, ys: Array, legs: int) -> tuple[Array, Array]:
    """Legs along the corridor grid, no immediate return where avoidable, and back to the start at the end."""
    here, before, nodes = (0, 0), None, [(0, 0)]
    for _ in range(legs):
        options = [(here[0] + a, here[1] + b) for a, b in ((1, 0), (-1, 0), (0, 1), (0, -1))]
        options = [n for n in options if 0 <= n[0] < len(xs) and 0 <= n[1] < len(ys) and n != before]
        before, here = here, options[rng.integers(len(options))]
        nodes.append(here)
    while here[0] > 0:
        here = (here[0] - 1, here[1])
        nodes.append(here)
    while here[1] > 0:
        here = (here[0], here[1] - 1)
        nodes.append(here)
    points, yaws = [], []
    corners = np.array([(xs[a], ys[b]) for a, b in nodes])
    yaw = 0.0
    for a, b in itertools.pairwise(corners):
        goal = float(np.arctan2(*(b - a)[::-1]))
        turn = (goal - yaw + np.pi) % (2 * np.pi) - np.pi
        for k in range(round(abs(turn) / 0.2)):
            points.append(a + rng.normal(0, 0.01, 2))
            yaws.append(yaw + turn * k / max(round(abs(turn) / 0.2), 1))
        yaw = goal
        steps = round(np.hypot(*(b - a)) / STEP_M)
        for k in range(steps):
            points.append(a + (b - a) * k / steps + rng.normal(0, 0.02, 2))
            yaws.append(goal + 0.15 * np.sin(k / 5))
    return np.array([*points, corners[-1]]), np.array([*yaws, yaw])


@dataclass(frozen=True)
class Sight:
    """One wall in one frame: the span of it that was hit."""

    frame: int
    wall: int
    low: float
    high: float


def _see(path: Array, heading: Array, walls: list[Wall]) -> list[Sight]:
    rays = np.linspace(-0.75, 0.75, 60)
    axis = np.array([w.axis for w in walls])
    offset, low, high, facing = (np.array([getattr(w, name) for w in walls]) for name in ("offset", "low", "high", "facing"))
    sights = []
    for i, (p, yaw) in enumerate(zip(path, heading, strict=True)):
        direction = np.stack([np.cos(yaw + rays), np.sin(yaw + rays)], 1)
        along = direction[:, axis]
        with np.errstate(divide="ignore", invalid="ignore"):
            reach = (offset - p[axis]) / along
        at = p[1 - axis] + reach * direction[:, 1 - axis]
        hit = (reach > 0.2) & (reach < RANGE_M) & (at >= low) & (at <= high)
        reach = np.where(hit, reach, np.inf)
        first = np.argmin(reach, 1)
        solid = np.isfinite(reach[np.arange(len(rays)), first]) & (along[np.arange(len(rays)), first] * facing[first] < 0)
        for w in np.unique(first[solid]):
            places = at[np.nonzero(solid & (first == w))[0], w]
            if len(places) >= 3 and np.ptp(places) > 0.25:
                sights.append(Sight(i, int(w), float(places.min()), float(places.max())))
    return sights


def _graph(rng: np.random.Generator, path: Array, walls: list[Wall], sights: list[Sight], settings: SceneSettings) -> Scene:
    count = len(path)
    true = np.column_stack([path - path[0], np.zeros(count)])
    steps = np.diff(true, axis=0)
    translation = _odometry(rng, steps, settings)
    dead = np.vstack([np.zeros(3), np.cumsum(translation, 0)])
    names = {key: k for k, key in enumerate(sorted({(w.axis, w.facing, w.offset) for w in walls}))}
    frame, track, distance, track_wall = [], [], [], []
    boxes: list[Array] = []
    last: dict[int, tuple[int, int]] = {}
    bias: list[float] = []
    for s in sights:
        wall = walls[s.wall]
        before = last.get(s.wall)
        if before is None or s.frame - before[0] > 3:
            track_wall.append(s.wall)
            boxes.append(np.array([[np.inf, -np.inf]] * 3))
            bias.append(rng.normal(0, settings.bias_sigma_m) if settings.bias_sigma_m else 0.0)
            before = (s.frame, len(track_wall) - 1)
        j = before[1]
        last[s.wall] = (s.frame, j)
        d = wall.offset - path[s.frame, wall.axis]
        frame.append(s.frame)
        track.append(j)
        distance.append(d + bias[j] + rng.normal(0, settings.depth_sigma_m))
        other = 1 - wall.axis
        spread = np.array([s.low, s.high]) - path[s.frame, other] + dead[s.frame, other]
        box = boxes[j]
        box[other] = min(box[other, 0], spread[0]), max(box[other, 1], spread[1])
        place = dead[s.frame, wall.axis] + d
        box[wall.axis] = min(box[wall.axis, 0], place), max(box[wall.axis, 1], place)
        box[2] = -EYE_M, HEIGHT_M - EYE_M
    d = np.array(distance)
    wild = rng.random(len(d)) < settings.outliers
    d[wild] += rng.uniform(-0.5, 0.5, int(wild.sum()))
    turned = rng.random(len(d)) < settings.flipped
    d[turned] *= -1
    of = [walls[w] for w in track_wall]
    graph = LayoutGraph(
        np.arange(count) / 10.0, translation, np.array(frame), np.array(track), d, np.array([w.axis for w in of]),
        np.array([w.facing for w in of]), np.array(boxes),
    )
    plane = np.array([names[(w.axis, w.facing, w.offset)] for w in of])
    offset = np.array([w.offset - path[0, w.axis] for w in of])
    return Scene(graph, plane, offset, true)


def _odometry(rng: np.random.Generator, steps: Array, settings: SceneSettings) -> Array:
    length = np.linalg.norm(steps, axis=1)
    rates = np.zeros((len(steps), 2))
    rate = rng.normal(0, 1, 2)
    for i, step in enumerate(length):
        memory = np.exp(-step / 20.0)
        rate = memory * rate + np.sqrt(1 - memory**2) * rng.normal(0, 1, 2)
        rates[i] = rate
    scale = rates[:, :1] * settings.scale_sigma + settings.global_scale
    turned = np.column_stack([-steps[:, 1], steps[:, 0], np.zeros(len(steps))])
    noise = rng.normal(0, 1, steps.shape) * settings.rate_m_per_sqrt_m * np.sqrt(np.maximum(length, 1e-4))[:, None]
    noise[:, 2] *= 0.0
    return np.asarray((steps + noise - turned * rates[:, 1:] * settings.sideways_sigma) / (1 + scale))


@dataclass(frozen=True)
class Score:
    precision: float
    recall: float
    plane_error: int
    drift_m: float
    wall_to_wall_m: float


def score(scene: Scene, plane_of_track: Array, offset_m: Array, position_m: Array) -> Score:
    """Pairs of tracks against the truth; drift at the end; mean error of distances between tracks of one axis."""
    same = plane_of_track[:, None] == plane_of_track[None, :]
    true = scene.plane_of_track[:, None] == scene.plane_of_track[None, :]
    upper = np.triu(np.ones_like(true), 1).astype(bool)
    hits, said, there = (int((m & upper).sum()) for m in (same & true, same, true))
    planes = len(np.unique(plane_of_track)) - len(np.unique(scene.plane_of_track))
    error = offset_m - scene.offset_m
    gaps = np.abs(error[:, None] - error[None, :])[upper & (scene.graph.axis[:, None] == scene.graph.axis[None, :])]
    drift = float(np.linalg.norm((position_m - scene.position_m)[-1]))
    return Score(hits / max(said, 1), hits / max(there, 1), planes, drift, float(gaps.mean()))
