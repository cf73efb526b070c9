"""Milliseconds per frame of every step of the front end, beside two peers on the same frames in the same run.

Peers: Open3D (normals, then planar patches) and a plain NumPy form of our own labelling. Run with
`python -m tests.bench.front_end SCAN` on any recording; times are CPU time of one thread.
"""

import sys
import time
from collections.abc import Callable
from pathlib import Path

import numpy as np

from floorplan.compass import CompassPrior, survey
from floorplan.config import CompassConfig, Config, SegmentsConfig
from floorplan.grid.normals import pixel_weights, surface_normals
from floorplan.ingest import ingest
from floorplan.model.checks import Array
from floorplan.model.scan import Frame, IngestedScan
from floorplan.readers import open_scan
from floorplan.readers.base import Source
from floorplan.segments import grid_stride, segment_frame
from floorplan.simulate.raycast import load_open3d

_FRAMES = 40
_MAX_HALF_PX, _GATE_M, _SUPPORT = 7, 0.03, 0.6  # of the NumPy vote
_PATCH_FRAMES = 5  # Open3D's patches take a good part of a second each


def milliseconds(work: Callable[[Frame], object], frames: list[Frame]) -> float:
    """CPU milliseconds per frame, after one frame to warm up."""
    work(frames[0])
    start = time.thread_time()
    for frame in frames:
        work(frame)
    return (time.thread_time() - start) / len(frames) * 1e3


def numpy_labels(points: Array, rotation: Array, ray_step: float, window_m: float) -> Array:
    """The published vote with array operations alone: for every shift of the neighbourhood, who lies on the pixel's planes."""
    world = points @ rotation.T.astype(np.float32)
    half = np.clip(np.round(0.5 * window_m / (np.linalg.norm(np.nan_to_num(points, nan=9.0), axis=2) * ray_step)), 1, _MAX_HALF_PX)
    votes = np.zeros(points.shape, dtype=np.float32)
    for i in range(-_MAX_HALF_PX, _MAX_HALF_PX + 1):
        for j in range(-_MAX_HALF_PX, _MAX_HALF_PX + 1):
            inside = max(abs(i), abs(j)) <= half
            votes += (np.abs(np.roll(world, (i, j), axis=(0, 1)) - world) < _GATE_M) & inside[..., None]
    best = votes.argmax(axis=2)
    support = np.take_along_axis(votes, best[..., None], axis=2)[..., 0] > _SUPPORT * (2 * half + 1) ** 2
    return np.where(support & np.isfinite(points[..., 2]), best, -1)


def open3d_normals(frame: Frame) -> object:
    """Open3D's normals of the frame's points, from 12 neighbours."""
    o3d = load_open3d()
    cloud = o3d.geometry.PointCloud(o3d.utility.Vector3dVector(frame.points[np.isfinite(frame.points[..., 2])].astype(np.float64)))
    cloud.estimate_normals(o3d.geometry.KDTreeSearchParamKNN(12))
    return cloud


def open3d_patches(frame: Frame) -> object:
    """Normals, then planar patches with Open3D's own settings."""
    cloud = open3d_normals(frame)
    return cloud.detect_planar_patches()  # type: ignore[attr-defined]


def measure(scan: IngestedScan, source: Source, prior: CompassPrior, config: SegmentsConfig) -> list[tuple[str, float]]:
    """Rows of step and milliseconds per frame."""
    sensor = scan.recording.sensor
    stride = grid_stride(sensor, config)
    rows = scan.keyframe[np.linspace(0, len(scan.keyframe) - 1, _FRAMES).astype(int)]
    start = time.thread_time()
    frames = [f for f in source.frames(rows, stride) if isinstance(f, Frame)]
    reading = (time.thread_time() - start) / len(frames) * 1e3
    rotation = np.asarray(prior.level_from_sensor[0])
    vote = SegmentsConfig(method="vote")
    step = sensor.ray_step_rad * stride

    def index(frame: Frame) -> int:
        return int(np.searchsorted(scan.keyframe, frame.index))

    def normals(frame: Frame) -> object:
        return surface_normals(frame.points, pixel_weights(frame.points, frame.confidence), sensor, prior.noise, config.window_m, 0.044)

    def in_numpy(frame: Frame) -> object:
        return numpy_labels(frame.points, rotation, step, config.window_m)

    return [
        ("read and back-project", reading),
        ("normals alone", milliseconds(normals, frames)),
        ("whole frame, normals", milliseconds(lambda f: segment_frame(f, index(f), prior, sensor, config), frames)),
        ("whole frame, published vote", milliseconds(lambda f: segment_frame(f, index(f), prior, sensor, vote), frames)),
        ("peer: NumPy vote, labels alone", milliseconds(in_numpy, frames[:_PATCH_FRAMES])),
        ("peer: Open3D normals", milliseconds(open3d_normals, frames)),
        ("peer: Open3D normals and planar patches", milliseconds(open3d_patches, frames[:_PATCH_FRAMES])),
    ]


def main() -> None:
    """Print the table for the scan named on the command line."""
    config = Config()
    source = open_scan(Path(sys.argv[1]))
    scan = ingest(source, config.ingest)
    start = time.thread_time()
    prior = survey(scan, source, CompassConfig())
    spent = (time.thread_time() - start) / len(scan.keyframe) * 1e3
    grid = next(iter(source.frames(scan.keyframe[:1], grid_stride(scan.recording.sensor, config.segments))))
    lines = [f"grid {grid.points.shape[1]} x {grid.points.shape[0]}", f"| survey, per keyframe | {spent:.2f} |"]  # type: ignore[union-attr]
    lines += [f"| {name} | {ms:.2f} |" for name, ms in measure(scan, source, prior, config.segments)]
    sys.stdout.write("\n".join(lines) + "\n")


if __name__ == "__main__":
    main()
