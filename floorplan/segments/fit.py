"""The offset of a plane whose normal is known, from the pixels of one component.

Default: weighted mode of the pixels' coordinates, then trimmed refinement. `ransac_offset` is the published way.
"""

import math

import numpy as np

from floorplan.compiled import compiled
from floorplan.model.checks import Array

BIN_M = 0.01  # of the mode's histogram: finer than any depth camera's noise
INLIER_SIGMAS = 2.5
FLOOR_M = 0.004  # plaster, quantisation: no surface is flatter to a depth camera
LEAST_COS = 0.25  # grazing rays: pixel footprint and range noise act along the wall, not across; never trust it fully
_REFINEMENTS = 4
_RANSAC_TRIALS = 64
BLOCK_PX = 8  # pixels closer than this share their error
COLUMNS = 16  # of a fit: see `Column`


class Column:
    """A fit's row: inlier count, weight sum, centroid x y z, scatter xx xy xz yy yz zz (sensor axes, less the noise along the
    rays), offset, variance, share of inliers, ripple^2, blocks."""

    COUNT, WEIGHT, CENTROID, SCATTER, OFFSET, VARIANCE, SHARE, RIPPLE, BLOCKS = 0, 1, 2, 5, 11, 12, 13, 14, 15


@compiled
def mode_offset(coordinate: Array, weight: Array, sigma: Array) -> float:
    """The densest coordinate: weighted histogram of 1 cm, window of about one standard deviation."""
    low, high = coordinate.min(), coordinate.max()
    bins = int((high - low) / BIN_M) + 1
    histogram = np.zeros(bins)
    for k in range(len(coordinate)):
        histogram[int((coordinate[k] - low) / BIN_M)] += weight[k]
    half = int(sigma.mean() / BIN_M + 0.5)
    best, best_sum = 0, -1.0
    for b in range(bins):
        total = histogram[max(b - half, 0) : b + half + 1].sum()
        if total > best_sum:
            best, best_sum = b, total
    return float(low + (best + 0.5) * BIN_M)


@compiled
def ransac_offset(coordinate: Array, weight: Array, sigma: Array) -> float:
    """Of a fixed number of pixels, the one on whose plane most others lie (a plane of known normal needs one pixel)."""
    count = len(coordinate)
    best, most = coordinate[0], -1.0
    state = np.uint64(count + 1)
    for _ in range(min(_RANSAC_TRIALS, count)):
        state = (state * np.uint64(6364136223846793005)) + np.uint64(1442695040888963407)
        candidate = coordinate[int((state >> np.uint64(33)) % np.uint64(count))]
        inliers = 0.0
        for k in range(count):
            if abs(coordinate[k] - candidate) < INLIER_SIGMAS * sigma[k]:
                inliers += weight[k]
        if inliers > most:
            best, most = candidate, inliers
    return float(best)


@compiled
def fit_components(
    points: Array, weight: Array, noise_m: Array, axis_of: Array, start: Array, order: Array, rotation: Array, ransac: bool
) -> tuple[Array, Array]:
    """One row of `Column` per component, the offset along its axis relative to the sensor; and each pixel's component
    (H, W) int32 where it is an inlier, else -1."""
    inlier_of = np.full(weight.size, -1, np.int32)
    fits = np.zeros((len(axis_of), COLUMNS))
    flat_points, flat_weight, flat_noise = points.reshape(-1, 3), weight.ravel(), noise_m.ravel()
    width = points.shape[1]
    for c in range(len(axis_of)):
        pixels = order[start[c] : start[c + 1]]
        axis = rotation[axis_of[c]]
        count = len(pixels)
        coordinate, w, sigma = np.empty(count), np.empty(count), np.empty(count)
        for k in range(count):
            x, y, z = flat_points[pixels[k], 0], flat_points[pixels[k], 1], flat_points[pixels[k], 2]
            coordinate[k] = axis[0] * x + axis[1] * y + axis[2] * z
            rho = math.sqrt(x * x + y * y + z * z)
            across = flat_noise[pixels[k]] * max(abs(coordinate[k]) / rho, LEAST_COS)
            sigma[k] = math.sqrt(across * across + FLOOR_M * FLOOR_M)
            w[k] = flat_weight[pixels[k]] / (sigma[k] * sigma[k])
        offset = ransac_offset(coordinate, w, sigma) if ransac else mode_offset(coordinate, w, sigma)
        for _ in range(_REFINEMENTS):
            total, mean = 0.0, 0.0
            for k in range(count):
                if abs(coordinate[k] - offset) < INLIER_SIGMAS * sigma[k]:
                    total += w[k]
                    mean += w[k] * coordinate[k]
            if total > 0:
                offset = mean / total
        for k in range(count):
            if abs(coordinate[k] - offset) < INLIER_SIGMAS * sigma[k]:
                inlier_of[pixels[k]] = c
        _moments(flat_points, pixels, coordinate, w, sigma, offset, fits[c])
        if fits[c, 1] > 0:
            _take_out_noise(flat_points, flat_noise, pixels, coordinate, w, sigma, rotation, axis_of[c], fits[c])
            _block_statistics(flat_points, pixels, coordinate, w, sigma, width, rotation, axis_of[c], fits[c])
    return fits, inlier_of.reshape(weight.shape)


@compiled
def _moments(points: Array, pixels: Array, coordinate: Array, w: Array, sigma: Array, offset: float, row: Array) -> None:
    """Count, weight, centroid and scatter of the inliers into `row`."""
    mean, square = np.zeros(3), np.zeros(6)
    total, inliers = 0.0, 0
    for k in range(len(pixels)):
        if abs(coordinate[k] - offset) >= INLIER_SIGMAS * sigma[k]:
            continue
        x, y, z = points[pixels[k], 0], points[pixels[k], 1], points[pixels[k], 2]
        total += w[k]
        inliers += 1
        mean[0] += w[k] * x
        mean[1] += w[k] * y
        mean[2] += w[k] * z
        square[0] += w[k] * x * x
        square[1] += w[k] * x * y
        square[2] += w[k] * x * z
        square[3] += w[k] * y * y
        square[4] += w[k] * y * z
        square[5] += w[k] * z * z
    if total <= 0:
        return
    row[0], row[1] = inliers, total
    mean /= total
    square /= total
    row[2:5] = mean
    row[5], row[6], row[7] = square[0] - mean[0] * mean[0], square[1] - mean[0] * mean[1], square[2] - mean[0] * mean[2]
    row[8], row[9], row[10] = square[3] - mean[1] * mean[1], square[4] - mean[1] * mean[2], square[5] - mean[2] * mean[2]
    row[11] = offset
    row[13] = inliers / len(pixels)


@compiled
def _inclination(row: Array, r: Array, axis: int) -> tuple[Array, Array]:
    """How the component leans: `gradient (3,)` and `centre` in sensor axes, so that the coordinate is offset + gradient . (p - centre)."""
    c = np.array(((row[5], row[6], row[7]), (row[6], row[8], row[9]), (row[7], row[9], row[10])))
    first, second = r[(axis + 1) % 3], r[(axis + 2) % 3]
    normal = r[axis]
    u, v = c @ first, c @ second
    uu, uv, vv = first @ u, first @ v, second @ v
    nu, nv = normal @ u, normal @ v
    ridge = 1e-4 * (uu + vv) + 1e-9  # a sweep, or a strip, leans along its length only
    det = (uu + ridge) * (vv + ridge) - uv * uv
    a, b = ((vv + ridge) * nu - uv * nv) / det, ((uu + ridge) * nv - uv * nu) / det
    return a * first + b * second, row[2:5]


@compiled
def _take_out_noise(
    points: Array, noise: Array, pixels: Array, coordinate: Array, w: Array, sigma: Array, r: Array, axis: int, row: Array
) -> None:
    """Noise moves a point along its ray: across the surface and along it at once, which leans a surface seen at an angle towards the
    sensor at its far end. The scatter in `row` without it; of the expected noise no more than the inliers show across."""
    part = np.zeros(6)
    for k in range(len(pixels)):
        if abs(coordinate[k] - row[11]) >= INLIER_SIGMAS * sigma[k]:
            continue
        x, y, z = points[pixels[k], 0], points[pixels[k], 1], points[pixels[k], 2]
        v = w[k] * noise[pixels[k]] ** 2 / (x * x + y * y + z * z)
        part[0] += v * x * x
        part[1] += v * x * y
        part[2] += v * x * z
        part[3] += v * y * y
        part[4] += v * y * z
        part[5] += v * z * z
    part /= row[1]
    gradient, _ = _inclination(row, r, axis)
    lean = r[axis] - gradient
    seen, expected = _square(row[5:11], lean), _square(part, r[axis])
    if expected > 0:
        row[5:11] -= min(max(seen / expected, 0.0), 1.0) * part


@compiled
def _square(six: Array, n: Array) -> float:
    """`n^T C n` of the symmetric matrix C, given as xx xy xz yy yz zz."""
    return float(
        six[0] * n[0] * n[0]
        + six[3] * n[1] * n[1]
        + six[5] * n[2] * n[2]
        + 2 * (six[1] * n[0] * n[1] + six[2] * n[0] * n[2] + six[4] * n[1] * n[2])
    )


@compiled
def _block_statistics(
    points: Array, pixels: Array, coordinate: Array, w: Array, sigma: Array, width: int, r: Array, axis: int, row: Array
) -> None:
    """Variance of the offset that counts a block of pixels as one reading, and the ripple: what blocks differ by beyond pixel noise.

    The component's own inclination, which a better rotation takes out, is taken out first.
    """
    gradient, centre = _inclination(row, r, axis)
    columns = width // BLOCK_PX + 1
    first_row = pixels[0] // width // BLOCK_PX
    count = (pixels[-1] // width // BLOCK_PX - first_row + 1) * columns
    weights, sums, pixels_in = np.zeros(count), np.zeros(count), np.zeros(count)
    square = 0.0
    for k in range(len(pixels)):
        if abs(coordinate[k] - row[11]) >= INLIER_SIGMAS * sigma[k]:
            continue
        error = coordinate[k] - row[11]
        for a in range(3):
            error -= gradient[a] * (points[pixels[k], a] - centre[a])
        b = (pixels[k] // width // BLOCK_PX - first_row) * columns + (pixels[k] % width) // BLOCK_PX
        weights[b] += w[k]
        sums[b] += w[k] * error
        pixels_in[b] += 1
        square += w[k] * error * error
    blocks, between, white = 0, 0.0, 0.0
    for b in range(count):
        if weights[b] > 0:
            blocks += 1
            between += sums[b] * sums[b] / weights[b]
            white += square / row[1] * weights[b] / pixels_in[b]
    row[12] = (sums * sums).sum() / (row[1] * row[1])
    row[14] = (between - white) / row[1]
    row[15] = blocks
