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
from floorplan.model.segment import Segments
from floorplan.segments.evidence import thin
from floorplan.segments.fit import Column, fit_components
from floorplan.segments.free_patches import off_axis_patches
from floorplan.segments.labels import Labels, label_by_normals
from floorplan.segments.support import extents_and_areas, grow
from floorplan.segments.values import FrameRotation, SegmentedFrame
from floorplan.segments.vote import label_by_vote

_YAW_HALF_WIDTH_RAD = math.radians(3.0)
_WEAK_SHARE = 0.15  # of the upright surface: fewer agree by chance
_LEAST_COMPONENT_PX = 40
_LEAST_SWEEP_BEAMS = 5
_YAW_PIXEL_STEP = 2  # the frame's own yaw is only a first guess here: a quarter of its pixels will do
_SCATTER_MATRIX = Column.SCATTER + np.array((0, 1, 2, 1, 3, 4, 2, 4, 5))  # xx xy xz yy yz zz to a whole matrix
_MAX_TILT = math.tan(math.radians(4.0))  # a segment further off its axis belongs to another surface
_TILT_SIGMAS = 2.0
_LEAST_INLIER_SHARE = 0.5
_MODEL_BLOCKS = 4.0  # the noise model counts like so many blocks in a segment's variance
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
    labels = _labels(points, normals, look, rotation.world_from_sensor, config)
    least = _LEAST_SWEEP_BEAMS if look.sweep else _LEAST_COMPONENT_PX
    components = connected_components(labels.label, labels.world_m, labels.gate_m, least)
    fits, kept, inlier_of = _planes(points, normals, components, rotation.world_from_sensor, config)
    axis, index_of_pixel = components.label[kept] // 2, _renumbered(inlier_of, kept, len(components.label))
    r = rotation.world_from_sensor
    grown = grow(points, normals.normal, weight, normals.noise_m, r, index_of_pixel, axis, fits[:, Column.OFFSET], _GROWTH_ROUNDS)
    extent, area = extents_and_areas(points, r, grown, len(axis), look.ray_step_rad, look.camera)
    keep = _large_enough(extent, area, axis, look, config)
    segments = _segments(index, components.label[kept][keep], fits[keep], extent[keep], area[keep], look)
    grown = _renumbered(grown, keep, len(keep))
    patches = off_axis_patches(components, points, normals.noise_m, r, index, look.pixels_per_point)
    evidence = thin(points, weight, grown, index, config.evidence_points, look.pixels_per_point)
    ripple, blocks = fits[keep, Column.RIPPLE], fits[keep, Column.BLOCKS]
    return SegmentedFrame(rotation, segments, ripple, blocks, patches, evidence, labels.label, grown)


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
    points: Array, normals: SurfaceNormals, components: Components, rotation: Array, config: SegmentsConfig
) -> tuple[Array, Array, Array]:
    """Fits of the axis-aligned components that are planes, which components those are, and the component of each inlying pixel."""
    axis = np.minimum(components.label // 2, 2).astype(np.int64)
    ransac = config.method == "vote"
    fits, inlier_of = fit_components(
        points, normals.weight, normals.noise_m, axis, components.start, components.order, rotation, ransac
    )
    plane = (components.label < 6) & (fits[:, Column.SHARE] >= _LEAST_INLIER_SHARE) & (fits[:, Column.COUNT] >= _LEAST_SWEEP_BEAMS)
    facing = np.where(components.label % 2 == 1, 1, -1)
    plane &= facing * fits[:, Column.OFFSET] < 0  # a surface is seen from the side it faces
    plane &= _tilt_is_small(fits, axis, rotation)
    return fits[plane], plane, inlier_of


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


def _renumbered(index: Array, kept: Array, count: int) -> Array:
    """`index` with the numbers of the kept components made consecutive and those of the others NO_COMPONENT (-1)."""
    number = np.full(count + 1, -1, np.int32)
    number[:-1][kept] = np.arange(np.count_nonzero(kept), dtype=np.int32)
    return np.asarray(number[index])


def _segments(index: int, label: Array, fits: Array, extent: Array, area: Array, look: Look) -> Segments:
    count = len(fits)
    axis = label // 2
    return Segments(
        np.full(count, index),
        axis,
        np.where(label % 2 == 1, 1, -1),
        fits[:, Column.OFFSET],
        np.sqrt(_offset_variance(fits)),
        np.round(fits[:, Column.COUNT] * look.pixels_per_point).astype(np.int32),
        area[np.arange(count), axis],
        extent,
        fits[:, Column.CENTROID : Column.CENTROID + 3],
        fits[:, _SCATTER_MATRIX].reshape(count, 3, 3),
    )


def _offset_variance(fits: Array) -> Array:
    """Variance of the offsets: from the blocks as far as there are any, else what the noise model says."""
    blocks, model = fits[:, Column.BLOCKS], 1 / np.maximum(fits[:, Column.WEIGHT], 1e-12)
    return np.asarray((blocks * fits[:, Column.VARIANCE] + _MODEL_BLOCKS * model) / (blocks + _MODEL_BLOCKS))


def _large_enough(extent_m: Array, area_m2: Array, axis: Array, look: Look, config: SegmentsConfig) -> Array:
    row = np.arange(len(axis))
    side = extent_m[:, :, 1] - extent_m[:, :, 0]
    side[row, axis] = 0.0
    longest = side.max(axis=1, initial=0.0)
    if look.sweep:
        return np.asarray(longest >= config.min_sweep_extent_m)
    return np.asarray((longest >= config.min_extent_m) & (area_m2[row, axis] >= config.min_area_m2))
