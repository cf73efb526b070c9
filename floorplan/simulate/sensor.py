"""A depth camera over a ray-cast building: noise, drop-outs, flying pixels, range limit, glass, biased depth."""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from floorplan.model.checks import Array
from floorplan.model.scan import RangeAccuracy
from floorplan.simulate import hard
from floorplan.simulate.presets import SensorSpec
from floorplan.simulate.raycast import NO_SURFACE, Hits, RayCaster
from floorplan.simulate.surfaces import Surface
from floorplan.simulate.walk import Walk

GRAZING_COS = (0.06, 0.20)  # below the first no echo comes back, above the second every one does
FAR_SHARE = 0.85  # of the maximal range: beyond it echoes get rarer
DARK_RANGE_SHARE = 0.35  # a dark surface is lost beyond this share of the range
RANDOM_DROPOUT = 0.004
EDGE_M = 0.12  # a jump of depth between neighbours that mixes two surfaces
FLYING_SHARE = 0.5  # of the pixels at such a jump come back from between
GLASS_ECHO = 0.06  # of the rays come back from a clean pane ...
GLASS_ECHO_FACING = 0.5  # ... and this share where it is met within GLASS_FACING_COS of head-on
GLASS_FACING_COS = 0.995
PATTERN_LEFT = 0.5  # of the fixed pattern, in the mean over a surface's pixels
BIASED = RangeAccuracy(hard.DEPTH_SCALE_ERROR, float(np.hypot(hard.RIPPLE_M / np.sqrt(2), PATTERN_LEFT * hard.FIXED_PATTERN_M)))


@dataclass(frozen=True)
class Pinhole:
    """Intrinsics in pixels, pixel centres at whole numbers."""

    width: int
    height: int
    fx: float
    fy: float
    cx: float
    cy: float

    @property
    def rays(self) -> Array:
        """Directions (H * W, 3) with z = 1 in camera axes (x right, y down, z forward), row by row."""
        v, u = np.mgrid[: self.height, : self.width]
        rays = np.stack(((u - self.cx) / self.fx, (v - self.cy) / self.fy, np.ones(u.shape)), axis=-1)
        return np.asarray(rays.reshape(-1, 3), dtype=np.float32)


def pinhole_of(spec: SensorSpec, scale: float = 1.0) -> Pinhole:
    """Intrinsics that give the sensor's fields of view, at `scale` of its pixels."""
    width, height = round(spec.width * scale), round(spec.height * scale)
    fx = width / 2 / np.tan(np.radians(spec.fov_x_deg) / 2)
    fy = height / 2 / np.tan(np.radians(spec.fov_y_deg) / 2)
    return Pinhole(width, height, float(fx), float(fy), (width - 1) / 2, (height - 1) / 2)


@dataclass(frozen=True)
class Shot:
    """One frame: `depth_m (H, W)` as measured along z (0: nothing), `true_m (H, W)` without errors (inf: nothing),
    `surface (H, W)` what each pixel that came back truly lies on, NO_SURFACE where none or mixed."""

    depth_m: Array
    true_m: Array
    surface: Array


class DepthCamera:
    """Takes shots; every frame draws from its own random stream, so frames can be taken in any order."""

    def __init__(self, spec: SensorSpec, pinhole: Pinhole, caster: RayCaster, seed: int, *, biased: bool = False) -> None:
        self.spec, self.pinhole, self.caster, self.seed = spec, pinhole, caster, seed
        self.rays = pinhole.rays
        self._ray_length = np.linalg.norm(self.rays, axis=1)
        self._normals = np.stack([_normal(surface) for surface in caster.surfaces]).astype(np.float32)
        self._dark = np.array([surface.dark for surface in caster.surfaces])
        self._bias = _fixed_bias(pinhole, seed) if biased else None
        self.accuracy = BIASED if biased else RangeAccuracy(scale_sigma=0.0, bias_sigma_m=0.0)

    def shots(self, walk: Walk) -> Iterator[Shot]:
        """One shot per pose of the walk."""
        for index in range(len(walk)):
            yield self.shoot(walk.position_m[index], walk.world_from_camera[index], index)

    def shoot(self, position_m: Array, world_from_camera: Array, index: int) -> Shot:
        """The shot of frame `index` from a true pose."""
        rng = np.random.default_rng([self.seed, 77, index])
        directions = self.rays @ np.asarray(world_from_camera, dtype=np.float32).T
        hits = self._through_glass(position_m, directions, rng)
        z = hits.distance  # rays have z = 1, so a ray length is the depth along z
        found = hits.surface != NO_SURFACE
        measured = self._measure(z, hits.surface, directions, rng)
        shape = (self.pinhole.height, self.pinhole.width)
        measured, mixed = _with_flying_pixels(measured.reshape(shape), z.reshape(shape), rng)
        true = np.where(found, z, np.inf).reshape(shape)
        surface = np.where((measured > 0) & ~mixed, hits.surface.reshape(shape), NO_SURFACE)
        return Shot(measured, true, surface)

    def _through_glass(self, position_m: Array, directions: Array, rng: np.random.Generator) -> Hits:
        """Most rays go through a pane, a few come back from it, more where it is met head-on."""
        first = self.caster.first(position_m, directions)
        at_pane = np.flatnonzero((first.surface != NO_SURFACE) & self.caster.is_glass[first.surface])
        if not len(at_pane):
            return first
        head_on = self._cosine(first.surface[at_pane], directions[at_pane], self._ray_length[at_pane]) > GLASS_FACING_COS
        through = at_pane[rng.random(len(at_pane)) >= np.where(head_on, GLASS_ECHO_FACING, GLASS_ECHO)]
        behind = self.caster.solid(position_m, directions[through])
        distance, surface = first.distance.copy(), first.surface.copy()
        distance[through], surface[through] = behind.distance, behind.surface
        return Hits(distance, surface)

    def _cosine(self, surface: Array, directions: Array, length: Array) -> Array:
        """Cosine between the ray and the surface normal, (R,)."""
        return np.asarray(np.abs(np.einsum("ij,ij->i", self._normals[surface], directions)) / length)

    def _measure(self, z: Array, surface: Array, directions: Array, rng: np.random.Generator) -> Array:
        """Depth (R,) with bias, noise and drop-outs; 0 where nothing comes back."""
        spec = self.spec
        z = np.where(np.isfinite(z), z, 0.0).astype(np.float32)
        reach = z * self._ray_length
        facing = self._cosine(surface, directions, self._ray_length)
        low, high = GRAZING_COS
        chance = np.clip((facing - low) / (high - low), 0.0, 1.0)
        limit = np.where(self._dark[surface], DARK_RANGE_SHARE, 1.0) * spec.max_range_m
        chance *= np.clip((limit - reach) / ((1 - FAR_SHARE) * limit), 0.0, 1.0) * (1 - RANDOM_DROPOUT)
        back = (surface != NO_SURFACE) & (reach > spec.min_range_m) & (rng.random(len(z), dtype=np.float32) < chance)
        sigma = spec.noise_constant_m + spec.noise_quadratic_per_m * z**2
        noisy = z + sigma * rng.standard_normal(len(z), dtype=np.float32)
        if self._bias is not None:
            ripple = hard.RIPPLE_M * np.sin(2 * np.pi * z / hard.RIPPLE_PERIOD_M)
            noisy = noisy + hard.DEPTH_SCALE_ERROR * z + ripple + self._bias
        return np.where(back, np.maximum(noisy, 0.0), 0.0)


def _with_flying_pixels(measured: Array, true: Array, rng: np.random.Generator) -> tuple[Array, Array]:
    """At depth edges some pixels lie between the two surfaces; also gives back which (H, W)."""
    jump = np.zeros(true.shape)
    finite = np.where(np.isfinite(true), true, 0.0)
    across = np.diff(finite, axis=1)
    jump[:, :-1] = np.where((finite[:, 1:] > 0) & (finite[:, :-1] > 0), across, 0.0)
    edge = np.argwhere((np.abs(jump) > EDGE_M) & (measured > 0))
    flying = edge[rng.random(len(edge)) < FLYING_SHARE]
    rows, columns = flying[:, 0], flying[:, 1]
    mixed = np.zeros(true.shape, dtype=bool)
    mixed[rows, columns] = True
    out = measured.copy()
    out[rows, columns] += jump[rows, columns] * rng.random(len(flying))
    return out, mixed


def _normal(surface: Surface) -> Array:
    normal = np.cross(surface.corner[1] - surface.corner[0], surface.corner[3] - surface.corner[0])
    return np.asarray(normal / np.linalg.norm(normal))


def _fixed_bias(pinhole: Pinhole, seed: int) -> Array:
    """A smooth pattern over the image (H * W,), the same in every frame, of standard deviation FIXED_PATTERN_M."""
    from scipy.ndimage import gaussian_filter

    rng = np.random.default_rng([seed, 78])
    pattern = gaussian_filter(rng.standard_normal((pinhole.height, pinhole.width)), pinhole.width / 12, mode="reflect")
    return np.asarray((hard.FIXED_PATTERN_M * pattern / pattern.std()).reshape(-1), dtype=np.float32)
