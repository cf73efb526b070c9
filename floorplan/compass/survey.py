"""The first look at a recording: sparse frames, coarse pixels, one yaw prior for every keyframe."""

import math
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from itertools import chain

import numpy as np

from floorplan.compass.directions import (
    BIN_RAD,
    NOTHING_UPRIGHT,
    QUARTER_RAD,
    Directions,
    UprightSurfaces,
    quarter_histogram,
    refine_yaw,
    upright_surfaces,
)
from floorplan.compass.path import best_path, step_sigma_rad
from floorplan.compass.prior import CompassPrior, heading_walk
from floorplan.compass.smoothing import smooth_angle
from floorplan.config import CompassConfig
from floorplan.errors import InputError
from floorplan.geometry import level_from_sensor, wrap_to
from floorplan.grid.normals import NoiseScale, pixel_weights, surface_normals
from floorplan.model.checks import Array
from floorplan.model.normal import MAD_TO_SIGMA
from floorplan.model.scan import Frame, IngestedScan, Sensor, SensorKind
from floorplan.readers.base import Source

Progress = Callable[[int, int], None]

_GRID_PX = 88  # columns kept of a camera's image: 1 degree each, enough for normals
_FRAME_SPACING = 4  # every fourth keyframe of a camera
_MAX_SPACING_M = 0.8  # ... but never further apart than this
_MOST_DIRECTIONS = 8_000_000  # of all frames together, 12 bytes each: all pixels of 5000 keyframes of a camera
_PART_FRAMES = 16  # looked at by one thread at a time
_WINDOW_M = 0.35
_NORMAL_SIGMA_RAD = math.radians(2.0)
_NOISE_QUANTILE = 0.3  # edges only ever raise a window's residual
_NOISE_SCALE_RANGE = (1.0, 3.0)
_NORMAL_SCALE_RANGE = (1.0, 4.0)
_NEAR_AXIS_RAD = math.radians(12.0)  # normals this close to the compass belong to its walls
_REFINE_HALF_WIDTH_RAD = math.radians(4.0)
_MAP_HALF_WIDTH_RAD = math.radians(2.0)  # of an odometry that is a map: one direction all over, whatever walls a wing has


@dataclass(frozen=True)
class _Odometry:
    """Levelled odometry at the keyframes: rotations (F, 3, 3), turn and distance of each step (F - 1,)."""

    level_from_sensor: Array
    turn_rad: Array
    step_m: Array


def survey(
    scan: IngestedScan, source: Source, config: CompassConfig, progress: Progress = lambda done, total: None, jobs: int = 1
) -> CompassPrior:
    """The prior yaw of every keyframe, looked for on `jobs` threads. Raises InputError when gravity is unknown or no frame can be read."""
    odometry = _levelled_odometry(scan)
    if config.method == "entropy":
        from floorplan.compass.entropy import entropy_survey

        return entropy_survey(scan, source, odometry.level_from_sensor, odometry.turn_rad, odometry.step_m, progress)
    sample = _sample(scan, odometry.step_m)
    noise_scale, directions = _look(scan, source, sample, odometry, progress, jobs)
    histograms = np.stack([quarter_histogram(d) for d in directions])
    if scan.mapped:
        coarse = np.full(len(sample), histograms.sum(axis=0).argmax() * BIN_RAD)
        return _prior_from_path(coarse, directions, sample, odometry, noise_scale, _MAP_HALF_WIDTH_RAD)
    sample_turn = np.abs(np.add.reduceat(np.concatenate((np.abs(odometry.turn_rad), [0.0])), sample)[:-1])
    peak = histograms.argmax(axis=1) * BIN_RAD
    coarse = best_path(histograms, step_sigma_rad(peak, histograms.max(axis=1), sample_turn))
    return _prior_from_path(coarse, directions, sample, odometry, noise_scale, _REFINE_HALF_WIDTH_RAD)


def _levelled_odometry(scan: IngestedScan) -> _Odometry:
    recording, rows = scan.recording, scan.keyframe
    down, odom = recording.down_sensor[rows], recording.odom_from_sensor[rows]
    if not np.isfinite(down).all():
        raise InputError("The direction of gravity is unknown in some frames. Give it with the recording, or let ingest estimate it.")
    up = np.median(-np.einsum("nij,nj->ni", odom, down), axis=0)
    level = level_from_sensor(down, odom, up)
    relative = level[1:] @ np.swapaxes(level[:-1], 1, 2)
    turn = np.arctan2(relative[:, 1, 0], relative[:, 0, 0])
    # The heading is carried by the levelled rotation; how far it TURNED is the sensor's own motion about the vertical.
    return _Odometry(level, turn, np.linalg.norm(np.diff(recording.position_m[rows], axis=0), axis=1))


def _sample(scan: IngestedScan, step_m: Array) -> Array:
    """Indices into the keyframes that the survey reads: all sweeps of a laser, a quarter of a camera's frames."""
    count = len(scan.keyframe)
    if scan.recording.sensor.kind is not SensorKind.CAMERA:
        return np.arange(count)
    chosen, walked = [0], 0.0
    for k in range(1, count):
        walked += float(step_m[k - 1])
        if k - chosen[-1] >= _FRAME_SPACING or walked >= _MAX_SPACING_M or k == count - 1:
            chosen.append(k)
            walked = 0.0
    return np.array(chosen)


@dataclass(frozen=True)
class _Glance:
    """What one sampled frame showed: `noise_ratio` of its windows to the model, NaN where it has none, and its upright surfaces."""

    noise_ratio: float
    upright: UprightSurfaces


def _look(
    scan: IngestedScan, source: Source, sample: Array, odometry: _Odometry, progress: Progress, jobs: int
) -> tuple[float, list[Directions]]:
    """Noise scale of the sensor and the upright directions of each sampled frame (empty ones where a frame is bad)."""
    sensor = scan.recording.sensor
    stride = max(1, sensor.width // _GRID_PX) if sensor.kind is SensorKind.CAMERA else 1

    step = _pixel_step(sensor, stride, len(sample))

    def look(part: Array) -> list[_Glance]:
        frames = source.frames(scan.keyframe[part].tolist(), stride)
        return [
            _glance(frame, sensor, odometry.level_from_sensor[k], step) if isinstance(frame, Frame) else _Glance(math.nan, NOTHING_UPRIGHT)
            for frame, k in zip(frames, part, strict=True)
        ]

    parts = np.split(sample, range(_PART_FRAMES, len(sample), _PART_FRAMES))
    found: list[list[_Glance]] = []
    with ThreadPoolExecutor(jobs) as pool:
        for glances in pool.map(look, parts):
            found.append(glances)
            progress(min(len(found) * _PART_FRAMES, len(sample)), len(sample))
    seen = list(chain.from_iterable(found))
    ratios = np.array([glance.noise_ratio for glance in seen])
    if not np.isfinite(ratios).any():
        raise InputError("No frame with usable depth was found in the recording.")
    scale = float(np.clip(np.nanmedian(ratios), *_NOISE_SCALE_RANGE))
    found.clear()
    seen.reverse()
    return scale, [seen.pop().upright.directions(scale) for _ in range(len(seen))]  # one by one: not all of them twice in memory


def _pixel_step(sensor: Sensor, stride: int, frames: int) -> int:
    """Every how many-th pixel's direction is kept: all of them, unless the recording is so long that they would fill the memory."""
    pixels = frames * max(sensor.width // stride, 1) * max(sensor.height // stride, 1)
    share = max(pixels / _MOST_DIRECTIONS, 1.0)
    return math.ceil(share if sensor.height == 1 else math.sqrt(share))


def _glance(frame: Frame, sensor: Sensor, level_from_sensor: Array, step: int) -> _Glance:
    weight = pixel_weights(frame.points, frame.confidence)
    normals = surface_normals(frame.points, weight, sensor, NoiseScale(), _WINDOW_M, _NORMAL_SIGMA_RAD)
    ratio = normals.residual_m[weight > 0] / normals.noise_m[weight > 0]
    ratio = ratio[np.isfinite(ratio)]
    upright = upright_surfaces(normals, level_from_sensor, step, max_noise_scale=_NOISE_SCALE_RANGE[1])
    return _Glance(float(np.quantile(ratio, _NOISE_QUANTILE)) if len(ratio) else math.nan, upright)


def _prior_from_path(
    coarse: Array, directions: list[Directions], sample: Array, odometry: _Odometry, noise_scale: float, half_width_rad: float
) -> CompassPrior:
    """Refine the path frame by frame, smooth it, and carry it to the keyframes between."""
    count = len(odometry.level_from_sensor)
    reading, sigma = np.zeros(count), np.full(count, np.inf)
    spreads: list[float] = []
    for k, near, found in zip(sample, coarse, directions, strict=True):
        estimate = refine_yaw(found, near, half_width_rad)
        if estimate is not None:
            reading[k] = near + wrap_to(estimate.yaw_rad - near, QUARTER_RAD)
            sigma[k] = estimate.sigma_rad / max(estimate.share, 0.1)
            spreads.append(_spread(found, estimate.yaw_rad))
    normal_scale = float(np.clip(np.median(spreads), *_NORMAL_SCALE_RANGE)) if spreads else 1.0
    smooth = smooth_angle(reading, sigma, heading_walk(odometry.turn_rad, odometry.step_m), slips=len(sample) < count)
    return CompassPrior(
        odometry.level_from_sensor,
        -smooth.angle_rad,
        smooth.sigma_rad,
        np.isfinite(sigma),
        odometry.turn_rad,
        odometry.step_m,
        NoiseScale(noise_scale, normal_scale),
    )


def _spread(directions: Directions, yaw_rad: float) -> float:
    """How widely the normals of walls spread, in the standard deviations that independent pixels would give."""
    off = np.abs(wrap_to(directions.azimuth_rad - yaw_rad, QUARTER_RAD))
    near = off < _NEAR_AXIS_RAD
    return float(MAD_TO_SIGMA * np.median(off[near] * np.sqrt(directions.weight[near])))
