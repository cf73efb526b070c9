"""A chunk of keyframes to layout segments; chunks know nothing of each other."""

import math
from collections.abc import Iterable, Sequence
from dataclasses import replace

import numpy as np

from floorplan.compass.prior import CompassPrior
from floorplan.config import SegmentsConfig
from floorplan.geometry import rotation_about_z
from floorplan.model.checks import Array
from floorplan.model.scan import Frame, IngestedScan, Problem, Sensor, SensorKind
from floorplan.model.segment import FreePatches, Segments
from floorplan.readers.base import BadFrame
from floorplan.segments.fit import Column
from floorplan.segments.frame import segment_frame
from floorplan.segments.values import SegmentedChunk, SegmentedFrame
from floorplan.segments.values_of_frames import evidence_of_frames, fits_of_frames, patches_of_frames, segments_of_frames


def grid_stride(sensor: Sensor, config: SegmentsConfig) -> int:
    """The stride to read frames with: no grid wider than `max_columns`; sweeps keep all beams, and LiDARs all of their few rings."""
    return max(config.pixel_stride, math.ceil(sensor.width / config.max_columns)) if sensor.kind is SensorKind.CAMERA else 1


def _points_per_frame(scan: IngestedScan, config: SegmentsConfig) -> int:
    """Evidence points wanted of each frame (of a sweep all beams): fewer where a long recording's would not fit into memory."""
    most = max(config.max_evidence_points // max(len(scan.keyframe), 1), 1)
    return most if scan.recording.sensor.height == 1 else min(config.evidence_points, most)


def segment_chunk(
    scan: IngestedScan, prior: CompassPrior, frames: Iterable[Frame | BadFrame], config: SegmentsConfig
) -> SegmentedChunk:
    """Layout segments of some keyframes, read with `grid_stride`. Safe to call from several threads at once."""
    config = replace(config, evidence_points=_points_per_frame(scan, config))
    done: list[SegmentedFrame] = []
    index: list[int] = []
    problems: list[Problem] = []
    for frame in frames:
        if isinstance(frame, BadFrame):
            problems.append(frame.problem)
            continue
        k = int(np.searchsorted(scan.keyframe, frame.index))
        done.append(segment_frame(frame, k, prior, scan.recording.sensor, config))
        index.append(k)
    return _joined(done, np.array(index, dtype=np.int64), tuple(problems))


def _joined(frames: Sequence[SegmentedFrame], index: Array, problems: tuple[Problem, ...]) -> SegmentedChunk:
    fits = fits_of_frames(frames)
    return SegmentedChunk(
        index,
        np.array([f.rotation.world_from_sensor for f in frames]).reshape(-1, 3, 3),
        np.array([f.rotation.yaw_sigma_rad for f in frames]),
        np.array([f.rotation.measured for f in frames], dtype=bool),
        segments_of_frames(frames),
        fits[:, Column.RIPPLE],
        fits[:, Column.BLOCKS],
        patches_of_frames(frames),
        evidence_of_frames(frames),
        problems,
    )


def join_segments(parts: Sequence[Segments]) -> Segments:
    """All rows, one after the other."""
    if not parts:
        empty = np.zeros(0)
        return Segments(empty, empty, empty, empty, empty, empty, empty, np.zeros((0, 3, 2)), np.zeros((0, 3)), np.zeros((0, 3, 3)))
    return Segments(*(np.concatenate([getattr(p, name) for p in parts]) for name in Segments.__dataclass_fields__))


def join_patches(parts: Sequence[FreePatches]) -> FreePatches:
    """All rows, one after the other."""
    if not parts:
        empty, pair = np.zeros(0), np.zeros((0, 2))
        return FreePatches(empty, empty, pair, pair, pair, empty, empty)
    return FreePatches(*(np.concatenate([getattr(p, name) for p in parts]) for name in FreePatches.__dataclass_fields__))


def prior_rotation(prior: CompassPrior) -> Array:
    """World-from-sensor rotations (F, 3, 3) the prior gives."""
    return np.asarray(rotation_about_z(prior.yaw_rad) @ prior.level_from_sensor)
