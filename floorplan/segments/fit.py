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
def mode_offset(coordinate: Array, weight: Array, sigma: float) -> float:
    """The densest coordinate: weighted histogram of 1 cm, window of about one (mean) standard deviation `sigma`."""
    low, high = coordinate.min(), coordinate.max()
    bins = int((high - low) / BIN_M) + 1
    histogram = np.zeros(bins)
    for k in range(len(coordinate)):
        histogram[int((coordinate[k] - low) / BIN_M)] += weight[k]
    half = int(sigma / BIN_M + 0.5)
    best, best_sum = 0, -1.0
    for b in range(bins):
        total = histogram[max(b - half, 0) : b + half + 1].sum()
        if total > best_sum:
            best, best_sum = b, total
    return float(low + (best + 0.5) * BIN_M)


@compiled
def ransac_offset(coordinate: Array, weight: Array, gate: Array) -> float:
    """Of a fixed number of pixels, the one on whose plane most others lie (a plane of known normal needs one pixel)."""
    count = len(coordinate)
    best, most = coordinate[0], -1.0
    state = np.uint64(count + 1)
    for _ in range(min(_RANSAC_TRIALS, count)):
        state = (state * np.uint64(6364136223846793005)) + np.uint64(1442695040888963407)
        candidate = coordinate[int((state >> np.uint64(33)) % np.uint64(count))]
        inliers = 0.0
        for k in range(count):
            if abs(coordinate[k] - candidate) < gate[k]:
                inliers += weight[k]
        if inliers > most:
            best, most = candidate, inliers
    return float(best)


@compiled
def fit_components(
    points: Array, weight: Array, noise_m: Array, label: Array, start: Array, order: Array, rotation: Array, ransac: bool
) -> tuple[Array, Array]:
    """One row of `Column` per component, the offset along its axis (label // 2) relative to the sensor; and each pixel's component
    (H, W) int32 where it is an inlier, else -1. Components off the axes keep a row of zeros."""
    inlier_of = np.full(weight.size, -1, np.int32)
    fits = np.zeros((len(label), COLUMNS))
    flat_points, flat_weight, flat_noise = points.reshape(-1, 3), weight.ravel(), noise_m.ravel()
    largest = 0
    for c in range(len(label)):
        largest = max(largest, start[c + 1] - start[c])
    room, place = np.empty((3, largest)), np.empty((4, largest), np.float32)
    for c in range(len(label)):
        if label[c] >= 2 * len(rotation):
            continue
        pixels = order[start[c] : start[c + 1]]
        count = len(pixels)
        coordinate, w, gate = room[0, :count], room[1, :count], room[2, :count]
        axis = label[c] // 2
        mean_sigma = _coordinates(flat_points, flat_weight, flat_noise, pixels, rotation[axis], coordinate, w, gate)
        offset = ransac_offset(coordinate, w, gate) if ransac else mode_offset(coordinate, w, mean_sigma)
        offset = _refined(coordinate, w, gate, offset)
        inliers = pixels.copy()
        kept = _kept(flat_points, flat_noise, inliers, coordinate, w, gate, offset, place)
        for k in range(kept):
            inlier_of[inliers[k]] = c
        _moments(place[:, :kept], w[:kept], offset, count, fits[c])
        if fits[c, 1] > 0:
            _take_out_noise(place[:, :kept], w[:kept], rotation, axis, fits[c])
            _block_statistics(place[:, :kept], inliers[:kept], coordinate, w, points.shape[1], rotation, axis, fits[c])
    return fits, inlier_of.reshape(weight.shape)


@compiled
def _coordinates(
    points: Array, weight: Array, noise: Array, pixels: Array, axis: Array, coordinate: Array, w: Array, gate: Array
) -> float:
    """Of one component's pixels the coordinate along `axis`, the weight and how far off an inlier may be; the mean standard deviation."""
    total = 0.0
    for k in range(len(pixels)):
        p = pixels[k]
        x, y, z = points[p, 0], points[p, 1], points[p, 2]
        coordinate[k] = axis[0] * x + axis[1] * y + axis[2] * z
        rho = math.sqrt(x * x + y * y + z * z)
        across = noise[p] * max(abs(coordinate[k]) / rho, LEAST_COS)
        sigma = math.sqrt(across * across + FLOOR_M * FLOOR_M)
        w[k] = weight[p] / (sigma * sigma)
        gate[k] = INLIER_SIGMAS * sigma
        total += sigma
    return total / len(pixels)


@compiled
def _refined(coordinate: Array, w: Array, gate: Array, offset: float) -> float:
    """The weighted mean of the inliers, and again of the inliers about it."""
    for _ in range(_REFINEMENTS):
        total, mean, before = 0.0, 0.0, offset
        for k in range(len(coordinate)):
            if abs(coordinate[k] - offset) < gate[k]:
                total += w[k]
                mean += w[k] * coordinate[k]
        if total > 0:
            offset = mean / total
        if offset == before:
            break
    return offset


@compiled
def _kept(
    points: Array, noise: Array, pixels: Array, coordinate: Array, w: Array, gate: Array, offset: float, place: Array
) -> int:
    """The inliers moved to the front of `pixels`, `coordinate` and `w`, their x, y, z and noise into `place (4, K)`; how many there are."""
    kept = 0
    for k in range(len(pixels)):
        if abs(coordinate[k] - offset) < gate[k]:
            p = pixels[k]
            pixels[kept], coordinate[kept], w[kept] = p, coordinate[k], w[k]
            place[0, kept], place[1, kept], place[2, kept], place[3, kept] = points[p, 0], points[p, 1], points[p, 2], noise[p]
            kept += 1
    return kept


@compiled
def _moments(place: Array, w: Array, offset: float, pixels: int, row: Array) -> None:
    """Count, weight, centroid and scatter of the inliers among `pixels` into `row`."""
    total, mx, my, mz = 0.0, 0.0, 0.0, 0.0
    xx, xy, xz, yy, yz, zz = 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
    for k in range(len(w)):
        x, y, z = place[0, k], place[1, k], place[2, k]
        total += w[k]
        wx, wy, wz = w[k] * x, w[k] * y, w[k] * z
        mx += wx
        my += wy
        mz += wz
        xx += wx * x
        xy += wx * y
        xz += wx * z
        yy += wy * y
        yz += wy * z
        zz += wz * z
    if total <= 0:
        return
    mx, my, mz = mx / total, my / total, mz / total
    row[0], row[1], row[2], row[3], row[4] = len(w), total, mx, my, mz
    row[5], row[6], row[7] = xx / total - mx * mx, xy / total - mx * my, xz / total - mx * mz
    row[8], row[9], row[10] = yy / total - my * my, yz / total - my * mz, zz / total - mz * mz
    row[11] = offset
    row[13] = len(w) / pixels


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
def _take_out_noise(place: Array, w: Array, r: Array, axis: int, row: Array) -> None:
    """Noise moves a point along its ray: across the surface and along it at once, which leans a surface seen at an angle towards the
    sensor at its far end. The scatter in `row` without it; of the expected noise no more than the inliers show across."""
    xx, xy, xz, yy, yz, zz = 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
    for k in range(len(w)):
        x, y, z = place[0, k], place[1, k], place[2, k]
        v = w[k] * place[3, k] ** 2 / (x * x + y * y + z * z)
        vx, vy, vz = v * x, v * y, v * z
        xx += vx * x
        xy += vx * y
        xz += vx * z
        yy += vy * y
        yz += vy * z
        zz += vz * z
    part = np.array((xx, xy, xz, yy, yz, zz)) / row[1]
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
    place: Array, pixels: Array, coordinate: Array, w: Array, width: int, r: Array, axis: int, row: Array
) -> None:
    """Variance of the offset that counts a block of pixels as one reading, and the ripple: what blocks differ by beyond pixel noise.

    The component's own inclination, which a better rotation takes out, is taken out first.
    """
    gradient, centre = _inclination(row, r, axis)
    columns = width // BLOCK_PX + 1
    first_row = pixels[0] // width // BLOCK_PX
    count = (pixels[-1] // width // BLOCK_PX - first_row + 1) * columns
    weights, sums, pixels_in = np.zeros(count), np.zeros(count), np.zeros(count)
    square, i = 0.0, pixels[0] // width
    for k in range(len(pixels)):
        while pixels[k] >= (i + 1) * width:  # pixels come in raster order: no division
            i += 1
        error = coordinate[k] - row[11]
        for a in range(3):
            error -= gradient[a] * (place[a, k] - centre[a])
        b = (i // BLOCK_PX - first_row) * columns + (pixels[k] - i * width) // BLOCK_PX
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
