"""The rows of single frames to the values of a chunk, all frames at once."""

from collections.abc import Sequence

import numpy as np

from floorplan.model.checks import Array
from floorplan.model.segment import NO_SEGMENT, EvidencePoints, FreePatches, Segments
from floorplan.segments.fit import COLUMNS, Column
from floorplan.segments.free_patches import COLUMNS as PATCH_COLUMNS
from floorplan.segments.free_patches import patches_of
from floorplan.segments.values import SegmentedFrame

_SCATTER_MATRIX = Column.SCATTER + np.array((0, 1, 2, 1, 3, 4, 2, 4, 5))  # xx xy xz yy yz zz to a whole matrix
_MODEL_BLOCKS = 4.0  # the noise model counts like so many blocks in a segment's variance


def fits_of_frames(frames: Sequence[SegmentedFrame]) -> Array:
    """All frames' fits (S, 16)."""
    return np.concatenate([np.zeros((0, COLUMNS)), *(f.planes.fit for f in frames)])


def segments_of_frames(frames: Sequence[SegmentedFrame]) -> Segments:
    """All frames' segments."""
    fits = fits_of_frames(frames)
    label = np.concatenate([np.zeros(0, np.int64), *(f.planes.label for f in frames)])
    counts = [len(f.planes.label) for f in frames]
    points = np.repeat([f.pixels_per_point for f in frames], counts)
    return Segments(
        np.repeat(np.array([f.frame for f in frames], dtype=np.int32), counts),
        label // 2,
        np.where(label % 2 == 1, 1, -1),
        fits[:, Column.OFFSET],
        np.sqrt(_offset_variance(fits)),
        np.round(fits[:, Column.COUNT] * points).astype(np.int32),
        np.concatenate([np.zeros(0), *(f.planes.area_m2 for f in frames)]),
        np.concatenate([np.zeros((0, 3, 2)), *(f.planes.extent_m for f in frames)]),
        fits[:, Column.CENTROID : Column.CENTROID + 3],
        fits[:, _SCATTER_MATRIX].reshape(len(fits), 3, 3),
    )


def patches_of_frames(frames: Sequence[SegmentedFrame]) -> FreePatches:
    """All frames' off-axis patches."""
    counts = [len(f.patches) for f in frames]
    rows = np.concatenate([np.zeros((0, PATCH_COLUMNS)), *(f.patches for f in frames)])
    frame, points = np.array([f.frame for f in frames], dtype=np.int32), np.array([f.pixels_per_point for f in frames])
    return patches_of(rows, np.repeat(frame, counts), np.repeat(points, counts))


def evidence_of_frames(frames: Sequence[SegmentedFrame]) -> EvidencePoints:
    """All frames' thinned points; segments count from the first frame's first."""
    points = [f.evidence for f in frames]
    counts = np.array([len(p.segment) for p in points], dtype=np.int64)
    before = np.cumsum([0, *(len(f.planes.label) for f in frames)])[:-1]
    segment = np.concatenate([np.zeros(0, np.int32), *(p.segment for p in points)])
    return EvidencePoints(
        np.concatenate(([0], np.cumsum(counts))),
        np.concatenate([np.zeros((0, 3), np.float32), *(p.point_m for p in points)]),
        np.where(segment == NO_SEGMENT, NO_SEGMENT, segment + np.repeat(before, counts)),
        np.repeat(np.array([p.pixels for p in points], dtype=np.float32), counts),
    )


def _offset_variance(fits: Array) -> Array:
    """Variance of the offsets: from the blocks as far as there are any, else what the noise model says."""
    blocks, model = fits[:, Column.BLOCKS], 1 / np.maximum(fits[:, Column.WEIGHT], 1e-12)
    return np.asarray((blocks * fits[:, Column.VARIANCE] + _MODEL_BLOCKS * model) / (blocks + _MODEL_BLOCKS))
