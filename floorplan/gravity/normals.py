"""Surface normals of a depth image from the gradient of inverse depth, which is affine in pixel coordinates on a plane."""

from dataclasses import dataclass

import numpy as np

from floorplan.model.checks import Array

BLUR_CELLS = 3  # box over which inverse depth is averaged: some 3 degrees of a camera's view
STEP_CELLS = 2  # half the base line of the central difference: the boxes just do not touch
MIN_FILLED = 0.8  # share of a box with depth; less is an edge or a hole
MAX_STEP = 0.06  # relative change of inverse depth that the local plane does not explain: a depth edge inside the stencil


@dataclass(frozen=True)
class OrientedPoints:
    """Points with the direction their surface faces, P rows, sensor axes: `point_m (P, 3)`, `normal (P, 3)` unit, towards the sensor."""

    point_m: Array
    normal: Array

    def __len__(self) -> int:
        return len(self.point_m)

    def where(self, mask: Array) -> "OrientedPoints":
        """The rows of `mask (P,)`."""
        return OrientedPoints(self.point_m[mask], self.normal[mask])


def oriented_points(points: Array) -> OrientedPoints:
    """Points of a camera's grid (H, W, 3), NaN where no depth, that lie on smooth surfaces, with their normals (float32).

    On a plane n.X = d with ray (x', y', 1): 1/z = (n_x x' + n_y y' + n_z) / d, so the gradient gives n up to scale.
    """
    grid = np.asarray(points, dtype=np.float64)
    with np.errstate(invalid="ignore", divide="ignore"):
        inverse = 1.0 / grid[..., 2]
        ray = grid[..., :2] * inverse[..., None]
    filled = np.isfinite(inverse)
    share = _box(filled.astype(float))
    mean = _box(np.where(filled, inverse, 0.0)) / np.maximum(share, 1e-9)
    ray_x, ray_y = _regular_rays(ray)
    slope_x, ok_x = _slope(mean, share, ray_x, axis=1)
    slope_y, ok_y = _slope(mean, share, ray_y, axis=0)
    along_z = mean - slope_x * ray_x[None, :] - slope_y * ray_y[:, None]
    normal = -np.stack([slope_x, slope_y, along_z], axis=-1)  # a surface in front faces back at the sensor
    length = np.linalg.norm(normal, axis=-1)
    good = filled & (share > MIN_FILLED) & ok_x & ok_y & (length > 0)
    return OrientedPoints(points[good], (normal[good] / length[good][:, None]).astype(np.float32))


def _regular_rays(ray: Array) -> tuple[Array, Array]:
    """x' of each column (W,) and y' of each row (H,): linear in the index."""
    height, width = ray.shape[:2]
    rows, columns = np.nonzero(np.isfinite(ray[..., 0]))
    return _line(columns, ray[rows, columns, 0], width), _line(rows, ray[rows, columns, 1], height)


def _line(index: Array, value: Array, count: int) -> Array:
    """The line through the values at the smallest and the greatest index, at 0 .. count - 1; zeros when there is no line."""
    if not len(index) or index.min() == index.max():
        return np.zeros(count)
    low, high = int(np.argmin(index)), int(np.argmax(index))
    slope = (value[high] - value[low]) / (index[high] - index[low])
    return np.asarray(value[low] + slope * (np.arange(count) - index[low]))


def _slope(mean: Array, share: Array, ray: Array, axis: int) -> tuple[Array, Array]:
    """Central difference of `mean (H, W)` per unit of `ray`, and where both sides agree with the middle."""
    ahead, behind = np.roll(mean, -STEP_CELLS, axis), np.roll(mean, STEP_CELLS, axis)
    filled = (np.roll(share, -STEP_CELLS, axis) > MIN_FILLED) & (np.roll(share, STEP_CELLS, axis) > MIN_FILLED)
    index = np.arange(mean.shape[axis])
    inside = (index >= STEP_CELLS) & (index < len(index) - STEP_CELLS)
    filled &= inside[None, :] if axis == 1 else inside[:, None]
    step = float(ray[1] - ray[0]) * 2 * STEP_CELLS if len(ray) > 1 else 0.0
    bend = np.abs(ahead + behind - 2 * mean)
    if step == 0.0:
        return np.zeros_like(mean), np.zeros(mean.shape, dtype=bool)
    return (ahead - behind) / step, filled & (bend < MAX_STEP * mean)


def _box(image: Array) -> Array:
    """Mean over a box of BLUR_CELLS x BLUR_CELLS, zero outside the image."""
    height, width = image.shape
    padded = np.pad(image, BLUR_CELLS // 2)
    tall = np.stack([padded[k : k + height] for k in range(BLUR_CELLS)]).sum(axis=0)
    return np.asarray(np.stack([tall[:, k : k + width] for k in range(BLUR_CELLS)]).sum(axis=0) / BLUR_CELLS**2)
