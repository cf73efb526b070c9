"""The evidence points of all chunks in one row, read a chunk at a time: of a long recording they are most of what is kept."""

from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import TypeAlias

import numpy as np

from floorplan.model.segment import NO_SEGMENT, EvidencePoints
from floorplan.segments.values import SegmentedChunk

ReadPoints: TypeAlias = Callable[[SegmentedChunk], EvidencePoints]


def without_points(chunk: SegmentedChunk) -> SegmentedChunk:
    """The chunk with the counts of its evidence points alone: the points stay where the chunk is kept."""
    none = np.zeros(0)
    return replace(chunk, evidence=EvidencePoints(chunk.evidence.start, np.zeros((0, 3)), none, none))


def points_at_hand(chunk: SegmentedChunk) -> EvidencePoints:
    """The evidence of a chunk that was kept whole."""
    return chunk.evidence


def joined_evidence(chunks: Sequence[SegmentedChunk], keyframes: int, read: ReadPoints) -> EvidencePoints:
    """The points of all chunks, in order; segment numbers move on by the segments before, and every keyframe has its run of points."""
    counts = np.zeros(keyframes, np.int64)
    for chunk in chunks:
        counts[chunk.frame] = np.diff(chunk.evidence.start)
    start = np.concatenate(([0], np.cumsum(counts)))
    point, segment, weight = (np.empty((start[-1], 3), np.float32), np.empty(start[-1], np.int32), np.empty(start[-1], np.float32))
    first = before = 0
    for chunk in chunks:
        part = read(chunk)
        rows = slice(first, first + len(part.segment))
        point[rows], weight[rows] = part.point_sensor_m, part.weight
        segment[rows] = np.where(part.segment == NO_SEGMENT, NO_SEGMENT, part.segment + before)
        first, before = rows.stop, before + len(chunk.segments)
    return EvidencePoints(start, point, segment, weight)
