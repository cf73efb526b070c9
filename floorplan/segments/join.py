"""Chunks to one segmented scan: rotations refined by the segments and smoothed over the recording, distances computed anew."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from floorplan.compass.prior import CompassPrior, heading_walk
from floorplan.compass.smoothing import SHARED_ERRORS, smooth_angle
from floorplan.geometry import rotation_about_z, wrap_to
from floorplan.model.checks import Array
from floorplan.model.scan import IngestedScan, Problem, SensorKind
from floorplan.model.segment import FreePatches, ManhattanFrames, SegmentedScan, Segments
from floorplan.odometry_steps import keyframe_steps
from floorplan.segments.chunk import join_patches, join_segments, prior_rotation
from floorplan.segments.chunk_evidence import ReadPoints, joined_evidence, points_at_hand
from floorplan.segments.error_sizes import ErrorSizes, SegmentErrors, learnt_sizes
from floorplan.segments.ripple import Ripple, ripple_of
from floorplan.segments.rotation import corrections, small_rotation
from floorplan.segments.surfaces import surface_of_segment
from floorplan.segments.values import SegmentedChunk

_UNKNOWN_SIZES = ErrorSizes(noise=1.0, turn=1.0, hidden_m=0.0003)  # where the recording cannot tell: 0.3 mm are left of quantisation
_KNOWN_TO = 0.7  # pixels tell the white part of a frame's error this well at least
_TILT_SIGMA_RAD = 0.005  # of frames whose roll and pitch nothing confirms: 0.3 degrees of gravity


@dataclass(frozen=True)
class _Rotations:
    """Final rotations (F, 3, 3) with standard deviations (F, 3) about the world's x, y, z; `shared_rad (F, 3)` is the part that
    neighbouring frames share, and is not in `sigma_rad`."""

    world_from_sensor: Array
    sigma_rad: Array
    shared_rad: Array


def join(
    scan: IngestedScan, prior: CompassPrior, chunks: Sequence[SegmentedChunk], read_points: ReadPoints = points_at_hand
) -> SegmentedScan:
    """One segmented scan over all keyframes; the order of `chunks` does not matter. `read_points` gives each chunk's evidence."""
    ordered = sorted((c for c in chunks if len(c.frame)), key=lambda c: int(c.frame[0]))
    rough, yaw_sigma, measured = prior_rotation(prior), np.array(prior.yaw_sigma_rad), np.zeros(len(scan.keyframe), dtype=bool)
    for chunk in ordered:
        rough[chunk.frame], yaw_sigma[chunk.frame] = chunk.world_from_sensor, chunk.yaw_sigma_rad
        measured[chunk.frame] = chunk.measured
    segments = join_segments([c.segments for c in ordered])
    ripple = ripple_of(ordered)
    sweeps = scan.recording.sensor.kind is SensorKind.LASER
    rotations = _smoothed(segments, rough, prior, ripple, sweeps) if not prior.final else _as_labelled(rough, yaw_sigma)
    yaw_sigma = np.hypot(rotations.sigma_rad, rotations.shared_rad)[:, 2]
    frames = ManhattanFrames(rotations.world_from_sensor, yaw_sigma, measured)
    patches = _turned_patches(join_patches([c.free_patches for c in ordered]), rough, rotations.world_from_sensor)
    evidence = joined_evidence(ordered, len(rough), read_points)
    segments = _with_sigmas(_turned_segments(segments, rough, rotations.world_from_sensor), scan, rotations, ripple)
    problems = counted_problems([problem for chunk in chunks for problem in chunk.problems])
    return SegmentedScan(frames, segments, patches, evidence, problems)


def counted_problems(met: Sequence[Problem]) -> tuple[Problem, ...]:
    """One problem per code, with the first place and the count of all."""
    first: dict[str, Problem] = {}
    for problem in met:
        known = first.get(problem.code)
        first[problem.code] = problem if known is None else replace(known, count=known.count + problem.count)
    return tuple(first.values())


def _as_labelled(rough: Array, yaw_sigma: Array) -> _Rotations:
    tilt = np.full(len(rough), _TILT_SIGMA_RAD)
    return _Rotations(rough, np.stack((tilt, tilt, yaw_sigma), axis=1), np.zeros((len(rough), 3)))


def _smoothed(segments: Segments, rough: Array, prior: CompassPrior, ripple: Ripple, sweeps: bool) -> _Rotations:
    """Rotations after the segments' corrections, smoothed with past and future against the odometry.

    One line through each wall: neighbouring `sweeps` hit the same radiators and skirtings, and err alike.
    """
    found = corrections(segments, rough, ripple)
    turned = rough @ np.swapaxes(prior.level_from_sensor, 1, 2)
    yaw = np.arctan2(turned[:, 1, 0], turned[:, 0, 0])
    yaw = prior.yaw_rad + wrap_to(yaw - prior.yaw_rad, 2 * np.pi)
    walk = heading_walk(prior.turn_rad, prior.step_m)
    reading_sigma = found.sigma_rad[:, 2]
    least, slips, white = SHARED_ERRORS if sweeps else 0.0, not sweeps, _KNOWN_TO * found.white
    heading = smooth_angle(yaw + found.delta_rad[:, 2], reading_sigma, walk, least, slips, most_scale=1.0, white_scale=white)
    tilt = [
        smooth_angle(found.delta_rad[:, a], found.sigma_rad[:, a], walk, slips=slips, most_scale=1.0, white_scale=white) for a in (0, 1)
    ]
    delta = np.stack((tilt[0].angle_rad, tilt[1].angle_rad, np.zeros(len(rough))), axis=1)
    rotation = small_rotation(delta) @ rotation_about_z(heading.angle_rad) @ prior.level_from_sensor
    tilt_sigma = [np.minimum(t.sigma_rad, _TILT_SIGMA_RAD) for t in tilt]
    read = reading_sigma[np.isfinite(reading_sigma)]
    shared_rad = heading.shared * float(np.median(read)) if len(read) else 0.0
    sigma = np.stack((*tilt_sigma, np.hypot(heading.sigma_rad, shared_rad)), axis=1)
    return _Rotations(rotation, sigma, found.shared_rad)


def _turned_segments(segments: Segments, rough: Array, final: Array) -> Segments:
    """Distances and extents under the final rotations, from the segments' moments."""
    centroid = np.einsum("sij,sj->si", final[segments.frame], segments.centroid_sensor_m)
    moved = centroid - np.einsum("sij,sj->si", rough[segments.frame], segments.centroid_sensor_m)
    distance = centroid[np.arange(len(segments)), segments.axis.astype(np.int64)]
    return replace(segments, distance_m=distance, extent_m=segments.extent_m + moved[:, :, None])


def _with_sigmas(segments: Segments, scan: IngestedScan, rotations: _Rotations, ripple: Ripple) -> Segments:
    """Standard deviations of the distances from pixels, rotations and ripple, each as large as the recording shows it to be.

    What lasts does not show between views: as much ripple as the surfaces show, and the rotations' shared errors, are added to that.
    """
    final = rotations.world_from_sensor
    centroid = np.einsum("sij,sj->si", final[segments.frame], segments.centroid_sensor_m)
    arm = np.cross(centroid, np.eye(3)[segments.axis.astype(np.int64)])
    errors = SegmentErrors(segments.sigma_m, arm * rotations.sigma_rad[segments.frame])
    steps = keyframe_steps(scan, final)
    position = np.concatenate((np.zeros((1, 3)), np.cumsum(steps, axis=0)))
    sizes = learnt_sizes(segments, surface_of_segment(segments, steps), errors, position, final) or _UNKNOWN_SIZES
    varying = (sizes.noise * errors.noise_m) ** 2 + ((sizes.turn * errors.lever_m) ** 2).sum(axis=1) + sizes.hidden_m**2
    lasting = ripple.sensor_m**2 + ripple.own_m**2 + ((arm * rotations.shared_rad[segments.frame]) ** 2).sum(axis=1)
    return replace(segments, sigma_m=np.sqrt(varying + lasting))


def _turned_patches(patches: FreePatches, rough: Array, final: Array) -> FreePatches:
    turn = (final @ np.swapaxes(rough, 1, 2))[patches.frame]
    flat = turn[:, :2, :2]
    return replace(
        patches,
        normal_yaw_rad=patches.normal_yaw_rad + np.arctan2(turn[:, 1, 0], turn[:, 0, 0]),
        start_m=np.einsum("qij,qj->qi", flat, patches.start_m),
        end_m=np.einsum("qij,qj->qi", flat, patches.end_m),
    )
