"""A picture of the scene without a screen, a graphics card or a driver: points splatted far to near with NumPy.

Open3D's own off-screen renderer needs EGL or Vulkan, which servers and containers lack.
"""

from dataclasses import dataclass, replace

import numpy as np

from floorplan.model.checks import Array
from floorplan.view.scene import Scene3D, sampled

WIDTH, HEIGHT = 1600, 1100
OVERSAMPLING = 2  # drawn this much larger, then averaged
ELEVATION_DEG, AZIMUTH_DEG = 52.0, -60.0  # steep enough to look into rooms over their walls
DISTANCE_IN_SPANS = 2.5  # of the eye, in diameters of the scene: a little perspective, no fish eye
MARGIN = 0.94  # of the picture that the scene fills
POINT_PIXELS = 2  # side of a point, before averaging
LINE_PIXELS = 3
LINE_LIFT = 0.002  # of the distance: lines lie over the points of their own surface
BACKGROUND = 255


@dataclass(frozen=True)
class Camera:
    """Where the eye is: `rotation (3, 3)` rows right, up, towards the eye; `target_m (3,)`; `distance_m`; pixels per unit of tangent.

    `parallel`: every ray runs along the view, so that walls stand upright as in a plan.
    """

    rotation: Array
    target_m: Array
    distance_m: float
    zoom: float = 1.0
    centre: tuple[float, float] = (0.0, 0.0)
    parallel: bool = False

    def project(self, points_m: Array) -> tuple[Array, Array]:
        """Pixels (N, 2), y up from the picture's middle, and distance from the eye (N,) along the view."""
        seen = (points_m - self.target_m) @ self.rotation.T
        depth = self.distance_m - seen[:, 2]
        across = self.distance_m if self.parallel else depth[:, None]
        return seen[:, :2] / across * self.zoom - self.centre, depth


def scene_picture(scene: Scene3D, from_above: bool = False) -> Array:
    """RGB image (HEIGHT, WIDTH, 3) uint8, seen from a corner or from straight above, there without perspective."""
    size = np.array([WIDTH, HEIGHT]) * OVERSAMPLING
    camera = _framed(scene, size, 90.0 if from_above else ELEVATION_DEG, -90.0 if from_above else AZIMUTH_DEG, from_above)
    step_m = camera.distance_m / camera.zoom  # about a pixel
    splats = [_splats(camera, scene.points_m, scene.colours, POINT_PIXELS)]
    for line in scene.lines:
        points = sampled(line.points_m, step_m * (LINE_PIXELS if line.dotted else 1), line.dotted)
        splats.append(_splats(camera, points, np.tile(np.array(line.colour, np.uint8), (len(points), 1)), LINE_PIXELS, LINE_LIFT))
    return _averaged(_painted(splats, size))


@dataclass(frozen=True)
class _Splats:
    pixel: Array  # (N, 2) column, row of the lower left corner
    depth: Array
    colour: Array
    side: int


def _framed(scene: Scene3D, size: Array, elevation_deg: float, azimuth_deg: float, parallel: bool) -> Camera:
    """A camera that looks at the whole scene."""
    low, high = scene.framed_m.min(axis=0), scene.framed_m.max(axis=0)
    span = max(float(np.linalg.norm(high - low)), 1.0)
    elevation, azimuth = np.radians(elevation_deg), np.radians(azimuth_deg)
    towards = np.array([np.cos(elevation) * np.cos(azimuth), np.cos(elevation) * np.sin(azimuth), np.sin(elevation)])
    right = np.array([-np.sin(azimuth), np.cos(azimuth), 0.0])
    camera = Camera(np.stack((right, np.cross(towards, right), towards)), (low + high) / 2, DISTANCE_IN_SPANS * span, parallel=parallel)
    pixel, _ = camera.project(scene.framed_m)
    left_low, right_high = pixel.min(axis=0), pixel.max(axis=0)
    zoom = MARGIN * float(np.min(size / np.maximum(right_high - left_low, 1e-6)))
    middle = zoom * (left_low + right_high) / 2
    return replace(camera, zoom=zoom, centre=(float(middle[0]), float(middle[1])))


def _splats(camera: Camera, points_m: Array, colours: Array, side: int, lift: float = 0.0) -> _Splats:
    pixel, depth = camera.project(points_m)
    return _Splats(np.floor(pixel).astype(int), depth * (1 - lift), colours, side)


def _painted(splats: list[_Splats], size: Array) -> Array:
    """Far things first, so that near ones cover them."""
    width, height = int(size[0]), int(size[1])
    image = np.full((height, width, 3), BACKGROUND, np.uint8)
    side = np.concatenate([np.full(len(s.pixel), s.side) for s in splats])
    pixel, depth = np.concatenate([s.pixel for s in splats]), np.concatenate([s.depth for s in splats])
    colour = np.concatenate([s.colour for s in splats])
    order = np.argsort(-depth, kind="stable")
    order = order[depth[order] > 0]
    column, row = pixel[order, 0] + width // 2, height // 2 - pixel[order, 1]
    largest = int(side.max(initial=1))
    shifts = [(right, down) for right in range(largest) for down in range(largest)]
    columns = np.stack([column + right for right, _ in shifts], axis=1)
    rows = np.stack([row + down for _, down in shifts], axis=1)
    covered = np.stack([side[order] > max(shift) for shift in shifts], axis=1)
    covered &= (columns >= 0) & (columns < width) & (rows >= 0) & (rows < height)
    image[rows[covered], columns[covered]] = np.repeat(colour[order], covered.sum(axis=1), axis=0)
    return image


def _averaged(image: Array) -> Array:
    height, width = image.shape[0] // OVERSAMPLING, image.shape[1] // OVERSAMPLING
    blocks = image.reshape(height, OVERSAMPLING, width, OVERSAMPLING, 3)
    return np.asarray(blocks.mean(axis=(1, 3)).round().astype(np.uint8))
