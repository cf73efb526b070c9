"""Milliseconds per frame of every step of the front end, beside two peers on the same frames in the same run.

Peers: Open3D (normals, then planar patches) and a plain NumPy form of our own labelling. Run with
`python -m tests.bench.front_end SCAN` on any recording; times are CPU time of one thread.
"""

import argparse
import json
import resource
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from floorplan.chunked_segments import CHUNK_KEYFRAMES
from floorplan.compass import CompassPrior, survey
from floorplan.config import Config, SegmentsConfig
from floorplan.config_file import load_config
from floorplan.grid.normals import pixel_weights, surface_normals
from floorplan.ingest import ingest
from floorplan.model.checks import Array
from floorplan.model.scan import Frame, IngestedScan, SensorKind
from floorplan.model.segment import SegmentedScan
from floorplan.readers import open_scan
from floorplan.readers.base import Source
from floorplan.readers.kept_frames import KeptFrames
from floorplan.segments import grid_stride, join, segment_chunk, segment_frame
from floorplan.segments.labels import label_by_normals
from floorplan.simulate.raycast import load_open3d
from floorplan.work.values import load_value
from tests.bench.clutter import Cluttered
from tests.bench.front_end_truth import FrontEndTruth, against_truth

_FRAMES = 40
_MAX_HALF_PX, _GATE_M, _SUPPORT = 7, 0.03, 0.6  # of the NumPy vote
_LOOK_S = 0.01  # between two looks at the work folder
_CORES = 2  # the bars are for two
_SPEED_COLUMNS = ("settings", "keyframes of frames", "ms CPU per recorded frame", "x real time on 2 cores", "first chunk s")
_ACCURACY_COLUMNS = ("yaw deg", "tilt deg", "wrong quarter turns", "offset mm", "chi-square", "purity", "tracks", "pixels on planes")
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

    def labels(frame: Frame) -> object:
        found = surface_normals(frame.points, pixel_weights(frame.points, frame.confidence), sensor, prior.noise, config.window_m, 0.044)
        return label_by_normals(frame.points, found, rotation, np.deg2rad(config.tolerance_deg))

    def in_numpy(frame: Frame) -> object:
        return numpy_labels(frame.points, rotation, step, config.window_m)

    return [
        ("read and back-project", reading),
        ("normals alone", milliseconds(normals, frames)),
        ("normals and labels", milliseconds(labels, frames)),
        ("whole frame, normals", milliseconds(lambda f: segment_frame(f, index(f), prior, sensor, config), frames)),
        ("whole frame, published vote", milliseconds(lambda f: segment_frame(f, index(f), prior, sensor, vote), frames)),
        ("peer: NumPy vote, labels alone", milliseconds(in_numpy, frames[:_PATCH_FRAMES])),
        ("peer: Open3D normals", milliseconds(open3d_normals, frames)),
        ("peer: Open3D normals and planar patches", milliseconds(open3d_patches, frames[:_PATCH_FRAMES])),
    ]


@dataclass(frozen=True)
class StageRun:
    """The frames stage over a whole recording: processor seconds, seconds to the first keyframe, and what came out."""

    segmented: SegmentedScan
    cpu_s: float
    first_frame_s: float


def run_stage(scan: IngestedScan, source: Source, config: Config) -> StageRun:
    """Survey, chunks and join on one thread, as `build` runs them."""
    start, wall = time.process_time(), time.monotonic()
    stride = grid_stride(scan.recording.sensor, config.segments)
    if scan.recording.sensor.kind is SensorKind.CAMERA:
        source = KeptFrames(source, stride)
    prior = survey(scan, source, config.compass)
    parts = np.split(scan.keyframe, range(CHUNK_KEYFRAMES, len(scan.keyframe), CHUNK_KEYFRAMES))
    chunks, first = [], 0.0
    for rows in parts:
        chunks.append(segment_chunk(scan, prior, source.frames(rows.tolist(), stride), config.segments))
        first = first or time.monotonic() - wall
    return StageRun(join(scan, prior, chunks), time.process_time() - start, first)


def stage_lines(folder: Path, variants: Sequence[str], truth: bool, clutter: float = 0.0) -> list[str]:
    """One row per variant (settings `section.key=value`, joined by commas): speed of the whole stage, its accuracy if asked.

    `clutter`: the share of the pixels that patches at random angles hide.
    """
    columns = [*_SPEED_COLUMNS, *(_ACCURACY_COLUMNS if truth else ())]
    lines = ["| " + " | ".join(columns) + " |", "| --- " * len(columns) + "|"]
    for variant in variants:
        config = load_config(None, [s for s in variant.split(",") if s])
        source = open_scan(folder)
        scan = ingest(source, config.ingest)
        if clutter:
            source = Cluttered(source, scan.recording, clutter)
        if variant == variants[0]:
            run_stage(scan, source, config)  # whatever is compiled or loaded on first use
        run = run_stage(scan, source, config)
        frames, stamp = len(scan.recording.stamp_ns), scan.recording.stamp_ns
        speed = _CORES * (stamp[-1] - stamp[0]) * 1e-9 / run.cpu_s
        row = f"| {variant or 'default'} | {len(scan.keyframe)} of {frames} |"
        row += f" {run.cpu_s / frames * 1e3:.2f} | {speed:.1f} | {run.first_frame_s:.2f} |"
        lines.append(row + (_accuracy(against_truth(folder, scan, run.segmented)) if truth else ""))
    peak_mb = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024
    return [*lines, f"peak memory of this process {peak_mb:.0f} MB"]


def _accuracy(true: FrontEndTruth) -> str:
    angles = f" {true.yaw_deg:.3f} | {true.tilt_deg:.3f} | {true.quarter_turns} |"
    return angles + f" {true.offset_m * 1e3:.1f} | {true.chi_square:.2f} | {true.purity:.4f} | {true.tracks} | {true.coverage_px:.0f} |"


def step_lines(folder: Path) -> list[str]:
    """The table of steps and peers."""
    config = Config()
    source = open_scan(folder)
    scan = ingest(source, config.ingest)
    survey(scan, source, config.compass)
    start = time.process_time()  # the survey looks on a thread of its own
    prior = survey(scan, source, config.compass)
    spent = (time.process_time() - start) / len(scan.keyframe) * 1e3
    grid = next(iter(source.frames(scan.keyframe[:1], grid_stride(scan.recording.sensor, config.segments))))
    lines = [f"grid {grid.points.shape[1]} x {grid.points.shape[0]}", f"| survey, per keyframe | {spent:.2f} |"]  # type: ignore[union-attr]
    return lines + [f"| {name} | {ms:.2f} |" for name, ms in measure(scan, source, prior, config.segments)]


def clock_lines(folder: Path, jobs: int, runs: int) -> list[str]:
    """The stage on the clock, in builds of their own as a user starts them: the stage, and from the start to its first frames."""
    lines = ["| run | stage s | x real time | start to first chunk s |", "| --- | --- | --- | --- |"]
    for run in range(runs + 1):
        with tempfile.TemporaryDirectory() as work:
            begin = time.time()
            command = [sys.executable, "-m", "floorplan", "build", str(folder), "--work", f"{work}/w"]
            command += ["--until", "segments", "--jobs", str(jobs)]
            with subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL) as build:
                first_s = _first_chunk_s(Path(work) / "w", build, begin)
            stage = json.loads((Path(work) / "w" / "2-segments" / "stage.json").read_text("utf-8"))
            stamp = load_value(Path(work) / "w" / "1-ingest", IngestedScan).recording.stamp_ns
        if run:  # the one before was to warm the caches
            speed = (stamp[-1] - stamp[0]) * 1e-9 / stage["seconds"]
            lines.append(f"| {run}, {jobs} jobs | {stage['seconds']:.2f} | {speed:.1f} | {first_s:.2f} |")
    return lines


def _first_chunk_s(work: Path, build: "subprocess.Popen[bytes]", begin: float) -> float:
    """Seconds after `begin` at which the first chunk of segments was finished on disk; NaN where it came and went unseen."""
    while build.poll() is None:
        finished = [path.stat().st_mtime for path in work.glob("2-segments.partial/chunk-*")]
        if finished:
            build.wait()
            return min(finished) - begin
        time.sleep(_LOOK_S)
    return float("nan")


def main() -> None:
    """Print the tables for the scan named on the command line."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("scan", type=Path)
    parser.add_argument("--truth", action="store_true", help="accuracy against the scan's truth.json")
    parser.add_argument("--stage-only", action="store_true", help="leave out the steps and the peers")
    parser.add_argument("--clutter", type=float, default=0.0, help="share of the pixels hidden by patches at random angles")
    parser.add_argument("--variant", action="append", help="settings section.key=value, joined by commas; again for another row")
    parser.add_argument("--clock", type=int, metavar="RUNS", help="the stage on the clock instead, in so many builds of their own")
    parser.add_argument("--jobs", type=int, default=_CORES, help="threads of those builds")
    asked = parser.parse_args()
    if asked.clock:
        sys.stdout.write("\n".join(clock_lines(asked.scan, asked.jobs, asked.clock)) + "\n")
        return
    lines = [] if asked.stage_only else step_lines(asked.scan)
    lines += stage_lines(asked.scan, asked.variant or [""], asked.truth, asked.clutter)
    sys.stdout.write("\n".join(lines) + "\n")


if __name__ == "__main__":
    main()
