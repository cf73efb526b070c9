"""Segmented scans in an axis-aligned world turned by quarter turns, and several of them in one row."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from floorplan.model.checks import Array
from floorplan.model.segment import NO_SEGMENT, EvidencePoints, FreePatches, ManhattanFrames, SegmentedScan, Segments
from floorplan.several.survey import quarter_turn


def turned(segmented: SegmentedScan, quarters: int) -> SegmentedScan:
    """The same in a world turned counter-clockwise; evidence points stay in the sensor's axes."""
    turn = quarter_turn(quarters)
    frames, segments, patches = segmented.frames, segmented.segments, segmented.free_patches
    new_axis, sign = np.abs(turn).argmax(axis=0), turn.sum(axis=0)
    flip = sign[segments.axis]
    return replace(
        segmented,
        frames=replace(frames, world_from_sensor=turn @ frames.world_from_sensor),
        segments=replace(
            segments,
            axis=new_axis[segments.axis],
            facing=segments.facing * flip,
            distance_m=segments.distance_m * flip,
            extent_m=_turned_boxes(segments.extent_m, new_axis, sign),
        ),
        free_patches=replace(
            patches,
            normal_yaw_rad=patches.normal_yaw_rad + quarters * np.pi / 2,
            start_m=patches.start_m @ turn[:2, :2].T,
            end_m=patches.end_m @ turn[:2, :2].T,
        ),
    )


def _turned_boxes(extent_m: Array, new_axis: Array, sign: Array) -> Array:
    boxes = np.empty_like(extent_m)
    boxes[:, new_axis] = np.sort(extent_m * sign[:, None], axis=2)
    return boxes


def in_one_row(scans: Sequence[SegmentedScan], names: Sequence[str]) -> SegmentedScan:
    """All frames of all scans, one scan after the other; problems say which scan they are of."""
    frame = np.cumsum([0, *(len(scan.frames.measured) for scan in scans)])
    segment = np.cumsum([0, *(len(scan.segments) for scan in scans)])
    parts = [_numbered(scan, int(frame[k]), int(segment[k])) for k, scan in enumerate(scans)]
    starts = np.cumsum([0, *(part.evidence.start[-1] for part in parts)])
    evidence = EvidencePoints(
        start=np.concatenate([[0], *(part.evidence.start[1:] + starts[k] for k, part in enumerate(parts))]),
        **_joined([part.evidence for part in parts], ("point_sensor_m", "segment", "weight")),
    )
    named = zip(names, scans, strict=True)
    return SegmentedScan(
        frames=ManhattanFrames(**_joined([part.frames for part in parts], ("world_from_sensor", "yaw_sigma_rad", "measured"))),
        segments=Segments(**_joined([part.segments for part in parts], tuple(Segments.__dataclass_fields__))),
        free_patches=FreePatches(**_joined([part.free_patches for part in parts], tuple(FreePatches.__dataclass_fields__))),
        evidence=evidence,
        problems=tuple(replace(p, where=f"{name}: {p.where}") for name, scan in named for p in scan.problems),
    )


def _numbered(scan: SegmentedScan, frame: int, segment: int) -> SegmentedScan:
    """Frame and segment numbers as they are behind those of the scans before."""
    on_segment = scan.evidence.segment != NO_SEGMENT
    return replace(
        scan,
        segments=replace(scan.segments, frame=scan.segments.frame + frame),
        free_patches=replace(scan.free_patches, frame=scan.free_patches.frame + frame),
        evidence=replace(scan.evidence, segment=scan.evidence.segment + segment * on_segment),
    )


def _joined(parts: Sequence[object], fields: tuple[str, ...]) -> dict[str, Array]:
    return {name: np.concatenate([getattr(part, name) for part in parts]) for name in fields}
