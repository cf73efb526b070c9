"""The gravity of every frame of a recording whose reader knew none."""

from collections.abc import Iterable, Iterator
from dataclasses import dataclass, replace
from heapq import merge

import numpy as np

from floorplan.gravity.normals import OrientedPoints, oriented_points
from floorplan.gravity.search import UpInWorld, search_up, world_normals
from floorplan.gravity.smoothing import VerticalFilter, smooth_up
from floorplan.gravity.upright import up_of_frame
from floorplan.model.checks import Array
from floorplan.model.scan import Frame, GravitySource, Problem, Recording
from floorplan.readers.base import Source
from floorplan.reporting import Progress

SEARCH_FRAMES = 60  # for the recording as a whole
MEASURED_FRAMES = 600  # at most, for the wander of the vertical
GRID_CELLS = 80  # columns of the thinned grid: normals of floors and walls need no more
WORLD_UP = np.array([0.0, 0.0, 1.0])  # the convention of motion capture, robots and most SLAM systems
ALIGNED_RAD = np.deg2rad(1.0)  # a world whose z is vertical to this was made so
WANDER_RAD = np.deg2rad(1.5)  # spread of the vertical over its smooth mean in such a world
MIN_MEASURED_SHARE = 0.05  # of the looked-at frames; fewer leave the vertical to the odometry alone


@dataclass(frozen=True)
class Look:
    """A frame that could be read: its row of the recording, and its oriented points."""

    row: int
    oriented: OrientedPoints


@dataclass(frozen=True)
class Measured:
    """Verticals measured in single frames, odometry's world: `row (K,)`, `up_world (K, 3)`, `sigma_rad (K,)`."""

    row: Array
    up_world: Array
    sigma_rad: Array


def estimate_gravity(source: Source, candidates: Array, progress: Progress) -> Recording:
    """The recording with gravity found from floor and ceiling; or with a fatal problem that says why it could not be.

    `candidates (F,)` rows of frames worth looking at. The result's `gravity_source` is WORLD when floor and
    ceiling confirm that the odometry's +z is up everywhere, else ESTIMATED.
    """
    recording = source.recording
    looked = list(_looks(source, _evenly(candidates, SEARCH_FRAMES), progress))  # some 25 MB
    found = search_up(world_normals([(look.oriented, recording.odom_from_sensor[look.row]) for look in looked])) if looked else None
    if found is None:
        return _without(recording, "no floor or ceiling was seen that tells which way is up")
    measured = _measure(recording, looked, found)
    if _is_z_up(measured, len(looked)):
        return _with_up(recording, np.tile(WORLD_UP, (len(recording), 1)), GravitySource.WORLD)
    others = np.setdiff1d(_evenly(candidates, MEASURED_FRAMES), [look.row for look in looked])
    if len(others):
        in_order = merge(looked, _looks(source, others, progress), key=lambda look: look.row)
        measured = _measure(recording, in_order, found)
    count = len(looked) + len(others)
    if len(measured.row) < max(1, MIN_MEASURED_SHARE * count):
        return _without(recording, f"only {len(measured.row)} of {count} frames looked at show a floor or ceiling")
    return _with_up(recording, _along_odometry(recording, measured), GravitySource.ESTIMATED)


def _evenly(rows: Array, count: int) -> Array:
    """At most `count` of `rows`, evenly spread."""
    return np.asarray(rows[np.unique(np.linspace(0, len(rows) - 1, min(count, len(rows))).astype(int))])


def _looks(source: Source, rows: Array, progress: Progress) -> Iterator[Look]:
    """Oriented points of the frames that can be read, one at a time."""
    stride = max(1, source.recording.sensor.width // GRID_CELLS)
    for done, frame in enumerate(source.frames(rows.tolist(), stride), 1):
        if isinstance(frame, Frame):
            yield Look(frame.index, oriented_points(frame.points))
        progress(done, len(rows))


def _measure(recording: Recording, looks: Iterable[Look], found: UpInWorld) -> Measured:
    """The vertical of each frame, sought near the one filtered so far: odometry may bend far from where it began.

    What lies further off than drift and noise explain (a ramp, a chair's back) is no vertical.
    """
    rows, ups, sigmas = [], [], []
    filtered = VerticalFilter.starting_at(found.up_world)
    for look in looks:
        rotation = recording.odom_from_sensor[look.row]
        filtered = filtered.at(float(recording.stamp_ns[look.row]) * 1e-9)
        up = up_of_frame(look.oriented, rotation.T @ filtered.up_world, recording.sensor.noise)
        if up is None or not filtered.admits(rotation @ up.up_sensor, up.sigma_rad):
            continue
        filtered = filtered.with_measured(rotation @ up.up_sensor, up.sigma_rad)
        rows.append(look.row)
        ups.append(rotation @ up.up_sensor)
        sigmas.append(up.sigma_rad)
    return Measured(np.array(rows, dtype=np.int64), np.array(ups).reshape(-1, 3), np.array(sigmas))


def _is_z_up(measured: Measured, looked: int) -> bool:
    if len(measured.row) < max(1, MIN_MEASURED_SHARE * looked):
        return False
    off = np.arccos(np.clip(measured.up_world @ WORLD_UP, -1.0, 1.0))
    median = np.median(measured.up_world, axis=0)
    mean_off = float(np.arccos(np.clip(median @ WORLD_UP / np.linalg.norm(median), -1.0, 1.0)))
    return bool(mean_off < ALIGNED_RAD and np.median(off) < WANDER_RAD)


def _along_odometry(recording: Recording, measured: Measured) -> Array:
    """The vertical (N, 3) in the odometry's world at every frame: smoothed, between measurements by time."""
    time = (recording.stamp_ns - recording.stamp_ns[0]) * 1e-9
    knots = time[measured.row]
    smooth = smooth_up(knots, measured.up_world, measured.sigma_rad)
    up = np.stack([np.interp(time, knots, smooth[:, i]) for i in range(3)], axis=1)
    return np.asarray(up / np.linalg.norm(up, axis=1, keepdims=True))


def _with_up(recording: Recording, up_world: Array, source: GravitySource) -> Recording:
    down = -np.einsum("nji,nj->ni", recording.odom_from_sensor, up_world)
    return replace(recording, down_sensor=down, gravity_source=source)


def _without(recording: Recording, reason: str) -> Recording:
    advice = "set read.world_up to the axis of the odometry's world that points up (+z, -y, ...)"
    return replace(recording, problems=(*recording.problems, Problem("gravity-missing", reason, advice=advice, fatal=True)))
