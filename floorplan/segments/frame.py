"""One frame to layout segments: the steps of the method's first stage, in order."""

import math
from dataclasses import dataclass

import numpy as np

from floorplan.compass.directions import QUARTER_RAD, refine_yaw, upright_surfaces
from floorplan.compass.prior import CompassPrior
from floorplan.compiled import compiled, on_disk
from floorplan.config import SegmentsConfig
from floorplan.geometry import rotation_about_z, wrap_to
from floorplan.grid.components import Components, connected_components
from floorplan.grid.normals import SurfaceNormals, pixel_weights, surface_normals
from floorplan.model.checks import Array
from floorplan.model.scan import Frame, Sensor, SensorKind
from floorplan.segments.evidence import thin
from floorplan.segments.fit import Column, fit_components
from floorplan.segments.free_patches import off_axis_patches
from floorplan.segments.labels import OFF_AXIS, Labels, label_by_normals
from floorplan.segments.support import extents_and_areas, grow, renumbered
from floorplan.segments.values import FrameRotation, PlaneRows, SegmentedFrame
from floorplan.segments.vote import label_by_vote

_YAW_HALF_WIDTH_RAD = math.radians(3.0)
_WEAK_SHARE = 0.15  # of the upright surface: fewer agree by chance
_LEAST_COMPONENT_PX = 40
_LEAST_SWEEP_BEAMS = 5
_YAW_PIXEL_STEP = 2  # the frame's own yaw is only a first guess here: a quarter of its pixels will do
_MAX_TILT = math.tan(math.radians(4.0))  # a segment further off its axis belongs to another surface
_TILT_SIGMAS = 2.0
_LEAST_INLIER_SHARE = 0.5
_GROWTH_ROUNDS = 6  # pixels: the half window a normal cannot reach


def compiled_before() -> bool:
    """Whether the machine code of this stage is on disk: without it the first frame waits for the compiler."""
    return on_disk(grow)


@dataclass(frozen=True)
class Look:
    """What a frame is looked at with: sensor, angle between pixels, pixels of the full image per pixel."""

    sensor: Sensor
    ray_step_rad: float
    pixels_per_point: float

    @property
    def camera(self) -> bool:
        return self.sensor.kind is SensorKind.CAMERA

    @property
    def sweep(self) -> bool:
        return self.sensor.height == 1


def segment_frame(frame: Frame, index: int, prior: CompassPrior, sensor: Sensor, config: SegmentsConfig) -> SegmentedFrame:
    """Layout segments of keyframe `index`, seen in `frame`."""
    points = np.ascontiguousarray(frame.points)
    look = _look(points, sensor)
    weight = pixel_weights(points, frame.confidence)
    normals = surface_normals(points, weight, sensor, prior.noise, config.window_m, math.radians(config.normal_sigma_deg))
    rotation = _frame_rotation(normals, prior, index)
    r = rotation.world_from_sensor
    labels = _labels(points, normals, look, r, config)
    components = connected_components(
        labels.label, labels.coordinate_m, labels.gate_m, _LEAST_SWEEP_BEAMS if look.sweep else _LEAST_COMPONENT_PX
    )
    planes, segment_of_pixel = _planes(points, normals, components, look, r, config)
    patches = off_axis_patches(components, points, normals, r)
    evidence = thin(points, weight, segment_of_pixel, index, config.evidence_points, look.pixels_per_point)
    return SegmentedFrame(index, look.pixels_per_point, rotation, planes, patches, evidence, labels.label, segment_of_pixel)


def _look(points: Array, sensor: Sensor) -> Look:
    ratio = sensor.width / points.shape[1]
    return Look(sensor, sensor.ray_step_rad * ratio, ratio * (ratio if sensor.height > 1 else 1.0))


def _frame_rotation(normals: SurfaceNormals, prior: CompassPrior, index: int) -> FrameRotation:
    """Prior yaw, drawn to what the frame's own surfaces say as far as each can be trusted."""
    level, yaw, sigma = prior.level_from_sensor[index], float(prior.yaw_rad[index]), float(prior.yaw_sigma_rad[index])
    if prior.final:
        return FrameRotation(rotation_about_z(np.asarray(yaw)) @ level, sigma, bool(prior.measured[index]))
    directions = upright_surfaces(normals, level, 1 if len(normals.weight) == 1 else _YAW_PIXEL_STEP).directions()
    estimate = refine_yaw(directions, -yaw, max(_YAW_HALF_WIDTH_RAD, 3 * sigma))
    if estimate is None or estimate.share < _WEAK_SHARE:
        return FrameRotation(rotation_about_z(np.asarray(yaw)) @ level, sigma, False)
    off = float(wrap_to(np.asarray(-estimate.yaw_rad - yaw), QUARTER_RAD))
    gain = sigma**2 / (sigma**2 + (estimate.sigma_rad / estimate.share) ** 2)
    return FrameRotation(rotation_about_z(np.asarray(yaw + gain * off)) @ level, sigma * math.sqrt(1 - gain), True)


def _labels(points: Array, normals: SurfaceNormals, look: Look, rotation: Array, config: SegmentsConfig) -> Labels:
    if config.method == "vote":
        return label_by_vote(points, normals.weight, normals.noise_m, rotation, look.ray_step_rad, config.window_m)
    return label_by_normals(points, normals, rotation, math.radians(config.tolerance_deg))


def _planes(
    points: Array, normals: SurfaceNormals, components: Components, look: Look, r: Array, config: SegmentsConfig
) -> tuple[PlaneRows, Array]:
    """The axis-aligned components that are planes and large enough, up to their edges; and which of them each pixel is on (H, W), or -1."""
    label, weight, noise_m = components.label, normals.weight, normals.noise_m
    fits, inlier_of = fit_components(points, weight, noise_m, label, components.start, components.order, r, config.method == "vote")
    plane = _is_plane(fits, label, r)
    label, fits, index = label[plane], fits[plane], renumbered(inlier_of, _consecutive(plane))
    grown = grow(points, normals.normal, weight, noise_m, r, index, label // 2, fits[:, Column.OFFSET].copy(), _GROWTH_ROUNDS)
    extent, area = extents_and_areas(points, r, grown, label // 2, look.ray_step_rad, look.camera)
    keep = _large_enough(extent, area, label // 2, *_least_sizes(look, config))
    return PlaneRows(label[keep], fits[keep], extent[keep], area[keep]), renumbered(grown, _consecutive(keep))


@compiled
def _consecutive(kept: Array) -> Array:
    """New numbers (C,) of those kept, -1 for the others."""
    number, count = np.full(len(kept), -1, np.int32), 0
    for c in range(len(kept)):
        if kept[c]:
            number[c] = count
            count += 1
    return number


@compiled
def _is_plane(fits: Array, label: Array, rotation: Array) -> Array:
    """Whether each component (C,) is a plane of its label: seen from the side it faces, flat, and inclined no more than noise allows."""
    plane = _tilt_is_small(fits, np.minimum(label // 2, 2), rotation)
    for c in range(len(fits)):
        count, offset, share = fits[c, 0], fits[c, 11], fits[c, 13]  # `Column.COUNT`, `.OFFSET`, `.SHARE`
        plane[c] &= label[c] < OFF_AXIS and share >= _LEAST_INLIER_SHARE and count >= _LEAST_SWEEP_BEAMS
        plane[c] &= offset < 0 if label[c] % 2 == 1 else offset > 0
    return plane


@compiled
def _tilt_is_small(fits: Array, axis: Array, rotation: Array) -> Array:
    """Whether each fit's own inclination to its axis is within tolerance and its own noise."""
    small = np.ones(len(fits), dtype=np.bool_)
    for c in range(len(fits)):
        a, variance = axis[c], max(fits[c, 12], 0.0)  # `Column.VARIANCE`
        for b in range(3):
            along = _covariance(fits[c], rotation[b], rotation[b])
            if b == a or along <= 1e-6:
                continue
            slope = _covariance(fits[c], rotation[a], rotation[b]) / along
            small[c] &= abs(slope) < _MAX_TILT + _TILT_SIGMAS * math.sqrt(variance / along)
    return small


@compiled
def _covariance(row: Array, first: Array, second: Array) -> float:
    """Covariance of a fit's inliers between two directions, from its row's scatter xx xy xz yy yz zz."""
    xx, xy, xz, yy, yz, zz = row[5], row[6], row[7], row[8], row[9], row[10]
    u = xx * second[0] + xy * second[1] + xz * second[2]
    v = xy * second[0] + yy * second[1] + yz * second[2]
    w = xz * second[0] + yz * second[1] + zz * second[2]
    return float(first[0] * u + first[1] * v + first[2] * w)


def _least_sizes(look: Look, config: SegmentsConfig) -> tuple[float, float]:
    """Longer side (m) and area (m^2) that a segment has at least."""
    return (config.min_sweep_extent_m, 0.0) if look.sweep else (config.min_extent_m, config.min_area_m2)


@compiled
def _large_enough(extent_m: Array, area_m2: Array, axis: Array, least_m: float, least_m2: float) -> Array:
    """Whether each segment (S,) is as long and as large as that."""
    enough = np.zeros(len(axis), np.bool_)
    for s in range(len(axis)):
        longest = 0.0
        for a in range(3):
            if a != axis[s]:
                longest = max(longest, extent_m[s, a, 1] - extent_m[s, a, 0])
        enough[s] = longest >= least_m and area_m2[s] >= least_m2
    return enough
