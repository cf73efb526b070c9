"""Layout graphs with truth: six scenes of the paper's sizes and a scaling series up to 4 km.

Numbers of frames and tracks, path length and drift follow the table in METHOD.md; the truth is exact.
"""

from dataclasses import dataclass

import numpy as np

from floorplan.model.graph import LayoutGraph
from tests.bench.building import (
    FRAME_SPACING_M,
    STAIR_M,
    STOREY_M,
    Planes,
    Ring,
    Walk,
    ring_planes,
    ring_walk,
    visible_patch,
    walk_along,
)

ODOMETRY_CORRELATION_M = 20.0  # scale and sideways errors of visual odometry persist over about this much walking
VERTICAL_SHARE = 0.3  # gravity keeps the height's drift to this share of the horizontal one
WHITE_STEP_M = 0.002  # jitter of one odometry step
SHORTEST_TRACK = 5  # frames
TRACK_GAP = 2  # frames lost when a track breaks
DRIFT_DRAWS = 64  # processes from which the mean drift of a walk is computed
WALK_SPEED_M_S = 1.0
RINGS_PER_STOREY = 12  # wings of one floor share its floor and its ceiling: most hypotheses are about those
WING_GAP_M = 6.0


@dataclass(frozen=True)
class Errors:
    """What goes wrong with the measurements; the defaults are an ordinary depth camera."""

    sigma_m: float = 0.01
    sigma_per_m: float = 0.002  # grows with distance
    outliers: float = 0.0  # fraction of rows off by up to `outlier_m`
    outlier_m: float = 1.0
    flipped: float = 0.0  # fraction of rows with the wrong sign
    track_bias_m: float = 0.0  # one sigma per track
    odometry_factor: float = 1.0  # times the drift of the table


@dataclass(frozen=True)
class SceneSpec:
    """One scene: `rings` ring corridors walked `laps` times each, `tracks` in all; `drift_m` is the mean drift of its odometry."""

    name: str
    path_m: float
    laps: int
    tracks: int
    planes: int
    drift_m: float
    radius_m: float = 1.0
    close: bool = False
    rings: int = 1


@dataclass(frozen=True)
class Scene:
    """A graph and its truth: `position_m (N, 3)` from the first frame, `plane_of_track (M,)`, and the true `planes`
    with offsets from the first frame."""

    name: str
    graph: LayoutGraph
    radius_m: float
    position_m: np.ndarray
    plane_of_track: np.ndarray
    planes: Planes


@dataclass(frozen=True)
class _Tracked:
    """All rows of a scene: `frame (K,)`, `track (K,)`, `plane (K,)`, the seen `part_m (K, 3, 2)`."""

    frame: np.ndarray
    track: np.ndarray
    plane: np.ndarray
    part_m: np.ndarray


PAPER_SCENES = (
    SceneSpec("area1", path_m=53, laps=1, tracks=48, planes=14, drift_m=0.82),
    SceneSpec("area2", path_m=200, laps=2, tracks=239, planes=34, drift_m=3.06),
    SceneSpec("area3", path_m=249, laps=3, tracks=408, planes=40, drift_m=2.98),
    SceneSpec("area4", path_m=69, laps=1, tracks=89, planes=28, drift_m=0.35),
    SceneSpec("area5", path_m=113, laps=2, tracks=108, planes=25, drift_m=0.81),
    SceneSpec("area6", path_m=67, laps=1, tracks=167, planes=16, drift_m=1.07, close=True),
)


def scale_spec(factor: int) -> SceneSpec:
    """`factor` wings like area 3, `RINGS_PER_STOREY` on one floor, storeys joined by stairs: 16 make 4 km."""
    return SceneSpec(
        f"scale{factor}x", path_m=249 * factor, laps=3, tracks=408 * factor, planes=40 * factor, drift_m=2.98 * factor**0.5, rings=factor
    )


def paper_scene(name: str, seed: int, errors: Errors | None = None) -> Scene:
    """One of `area1` .. `area6`."""
    return make_scene(next(spec for spec in PAPER_SCENES if spec.name == name), seed, errors)


def make_scene(spec: SceneSpec, seed: int, errors: Errors | None = None) -> Scene:
    """The scene of a specification: everything follows from `seed`."""
    errors, rng = errors or Errors(), np.random.default_rng([seed, len(spec.name), spec.tracks])
    planes, walk = _building(spec, rng)
    rows = _tracks(planes, walk, spec.tracks, rng)
    translation = np.diff(walk.position_m, axis=0) + _odometry_error(walk, spec.drift_m * errors.odometry_factor, rng)
    plane_of_track = np.zeros(rows.track.max() + 1, dtype=np.int64)
    plane_of_track[rows.track] = _first_equal(planes)[rows.plane]
    distance = planes.offset_m[rows.plane] - walk.position_m[rows.frame, planes.axis[rows.plane]]
    sigma = errors.sigma_m + errors.sigma_per_m * np.abs(distance)
    dead_reckoned = np.vstack((np.zeros((1, 3)), np.cumsum(translation, axis=0)))
    graph = LayoutGraph(
        stamp_s=np.arange(len(walk.position_m)) * FRAME_SPACING_M / WALK_SPEED_M_S,
        translation_m=translation,
        frame=rows.frame,
        track=rows.track,
        distance_m=_with_errors(distance, sigma, rows.track, errors, rng),
        axis=planes.axis[plane_of_track],
        facing=planes.facing[plane_of_track],
        extent_m=_extents(rows, dead_reckoned - walk.position_m, len(plane_of_track)),
        sigma_m=sigma,
    )
    start = walk.position_m[0]
    from_start = Planes(planes.axis, planes.facing, planes.offset_m - start[planes.axis], planes.extent_m - start[:, None])
    return Scene(spec.name, graph, spec.radius_m, walk.position_m - start, plane_of_track, from_start)


def _building(spec: SceneSpec, rng: np.random.Generator) -> tuple[Planes, Walk]:
    lap_m = spec.path_m / spec.laps / spec.rings - STAIR_M * (spec.rings > 1) / spec.laps
    parts, corners = [], []
    for k in range(spec.rings):
        width = lap_m / 2 * rng.uniform(0.52, 0.65)
        wing, storey = k % RINGS_PER_STOREY, k // RINGS_PER_STOREY
        corner = (wing * (0.65 * lap_m / 2 + WING_GAP_M), rng.uniform(-8, 8))
        ring = Ring(corner, (width, lap_m / 2 - width), STOREY_M * storey)
        parts.append(ring_planes(ring, spec.planes // spec.rings - 10, spec.close, rng))
        corners.append(ring_walk(ring, spec.laps))
    columns = [np.concatenate([getattr(part, name) for part in parts]) for name in Planes.__dataclass_fields__]
    return Planes(*columns), walk_along(np.concatenate(corners), rng)


def _first_equal(planes: Planes) -> np.ndarray:
    """For each plane the first one of equal axis, facing and offset (P,): wings share their floor."""
    _, first, same = np.unique(np.stack((planes.axis, planes.facing, planes.offset_m)), axis=1, return_index=True, return_inverse=True)
    return first[same]


def _tracks(planes: Planes, walk: Walk, wanted: int, rng: np.random.Generator) -> _Tracked:
    """Runs of frames that see one plane, broken at random (or the shortest left out) until there are `wanted`."""
    runs, parts = [], {}
    for plane in range(len(planes.axis)):
        seen, part = visible_patch(planes, plane, walk)
        frames = np.flatnonzero(seen)
        if len(frames) >= SHORTEST_TRACK:
            parts[plane] = part[frames[0] : frames[-1] + 1], frames[0]
            runs += [(plane, run) for run in np.split(frames, np.flatnonzero(np.diff(frames) > TRACK_GAP) + 1)]
    runs = [run for run in runs if len(run[1]) >= SHORTEST_TRACK]
    runs = sorted(runs, key=lambda run: -len(run[1]))[:wanted]
    runs = _broken(runs, wanted, rng)
    order = sorted(range(len(runs)), key=lambda k: (runs[k][1][0], runs[k][0]))
    frame = np.concatenate([runs[k][1] for k in order])
    track = np.repeat(np.arange(len(order)), [len(runs[k][1]) for k in order])
    plane = np.array([runs[k][0] for k in order])[track]
    part_m = np.concatenate([parts[runs[k][0]][0][runs[k][1] - parts[runs[k][0]][1]] for k in order])
    by_frame = np.argsort(frame, kind="stable")
    return _Tracked(frame[by_frame], track[by_frame], plane[by_frame], part_m[by_frame])


def _broken(runs: list[tuple[int, np.ndarray]], wanted: int, rng: np.random.Generator) -> list[tuple[int, np.ndarray]]:
    """Runs broken at places drawn evenly over all frames that see anything."""
    shortest = 2 * SHORTEST_TRACK + TRACK_GAP
    while len(runs) < wanted:
        length = np.array([max(len(frames) - shortest, 0) for _, frames in runs], dtype=float)
        k = int(rng.choice(len(runs), p=length / length.sum()))
        plane, frames = runs[k]
        cut = int(rng.integers(SHORTEST_TRACK, len(frames) - SHORTEST_TRACK - TRACK_GAP))
        runs[k] = (plane, frames[:cut])
        runs.append((plane, frames[cut + TRACK_GAP :]))
    return runs


def _odometry_error(walk: Walk, drift_m: float, rng: np.random.Generator) -> np.ndarray:
    """Error of every step (N-1, 3): scale and sideways rates that persist, and jitter; the end is off by `drift_m` (RMS)."""
    step = np.diff(walk.position_m, axis=0)
    drawn = _rate_errors(step, DRIFT_DRAWS, rng)
    mean_drift = np.sqrt((drawn.sum(axis=1) ** 2).sum(axis=1).mean())
    return _rate_errors(step, 1, rng)[0] * drift_m / mean_drift + rng.normal(0, WHITE_STEP_M, step.shape)


def _rate_errors(step: np.ndarray, draws: int, rng: np.random.Generator) -> np.ndarray:
    """Unit processes of scale, sideways and vertical rates turned into step errors (draws, N-1, 3)."""
    keep = np.exp(-np.linalg.norm(step, axis=1) / ODOMETRY_CORRELATION_M)
    rate = np.empty((draws, len(step), 3))
    state = rng.normal(size=(draws, 3))
    kick = rng.normal(size=(draws, len(step), 3))
    for i, factor in enumerate(keep):
        state = factor * state + np.sqrt(1 - factor**2) * kick[:, i]
        rate[:, i] = state
    length = np.linalg.norm(step, axis=1)
    sideways = np.stack((-step[:, 1], step[:, 0], np.zeros(len(step))), axis=1)
    vertical = np.stack((np.zeros(len(step)), np.zeros(len(step)), VERTICAL_SHARE * length), axis=1)
    return rate[..., :1] * step + rate[..., 1:2] * sideways + rate[..., 2:] * vertical


def _with_errors(distance: np.ndarray, sigma: np.ndarray, track: np.ndarray, errors: Errors, rng: np.random.Generator) -> np.ndarray:
    """Measured distances: noise, one bias per track, outliers, flipped signs. Noise never turns a sign."""
    count = len(distance)
    measured = distance + rng.normal(0, sigma) + rng.normal(0, errors.track_bias_m, track.max() + 1)[track]
    outlier = rng.random(count) < errors.outliers
    measured = np.where(outlier, measured + rng.uniform(-errors.outlier_m, errors.outlier_m, count), measured)
    measured = np.where(np.sign(measured) == np.sign(distance), measured, distance)
    return np.where(rng.random(count) < errors.flipped, -measured, measured)


def _extents(rows: _Tracked, dead_reckoning_error_m: np.ndarray, tracks: int) -> np.ndarray:
    """Union of the seen parts of each track in dead-reckoned coordinates (M, 3, 2)."""
    part = rows.part_m + dead_reckoning_error_m[rows.frame][:, :, None]
    low, high = np.full((tracks, 3), np.inf), np.full((tracks, 3), -np.inf)
    np.minimum.at(low, rows.track, part[:, :, 0])
    np.maximum.at(high, rows.track, part[:, :, 1])
    return np.stack((low, high), axis=2)
