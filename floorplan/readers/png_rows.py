"""The rows of a PNG, back from the differences they are stored as (PNG specification, 9)."""

import numpy as np

from floorplan.compiled import compiled
from floorplan.model.checks import Array

SUB, UP, AVERAGE, PAETH = 1, 2, 3, 4  # what a pixel is stored as the difference to: left, above, their mean, the likeliest of three


@compiled
def _paeth(left: int, above: int, corner: int) -> int:
    """The one of three neighbours nearest to left + above - corner."""
    to_left, to_above, to_corner = abs(above - corner), abs(left - corner), abs(left + above - 2 * corner)
    if to_left <= to_above and to_left <= to_corner:
        return left
    return above if to_above <= to_corner else corner


@compiled
def unfiltered_16(raw: Array) -> Array:
    """Pixels (H, W) uint16, big-endian in the file, of rows that begin with the number of their filter."""
    height, width = raw.shape[0], (raw.shape[1] - 1) // 2
    image = np.empty((height, width), np.uint16)
    above = np.zeros(2 * width, np.int32)
    for i in range(height):
        row, kind = raw[i], raw[i, 0]
        high, low, corner_high, corner_low = 0, 0, 0, 0
        for j in range(width):
            up_high, up_low = above[2 * j], above[2 * j + 1]
            add_high, add_low = 0, 0
            if kind == SUB:
                add_high, add_low = high, low
            elif kind == UP:
                add_high, add_low = up_high, up_low
            elif kind == AVERAGE:
                add_high, add_low = (high + up_high) >> 1, (low + up_low) >> 1
            elif kind == PAETH:
                add_high, add_low = _paeth(high, up_high, corner_high), _paeth(low, up_low, corner_low)
            corner_high, corner_low = up_high, up_low
            high, low = (row[2 * j + 1] + add_high) & 255, (row[2 * j + 2] + add_low) & 255
            above[2 * j], above[2 * j + 1] = high, low
            image[i, j] = high << 8 | low
    return image


@compiled
def unfiltered_8(raw: Array) -> Array:
    """Pixels (H, W) uint8 of rows that begin with the number of their filter."""
    height, width = raw.shape[0], raw.shape[1] - 1
    image = np.empty((height, width), np.uint8)
    above = np.zeros(width, np.int32)
    for i in range(height):
        row, kind = raw[i], raw[i, 0]
        left, corner = 0, 0
        for j in range(width):
            up, add = above[j], 0
            if kind == SUB:
                add = left
            elif kind == UP:
                add = up
            elif kind == AVERAGE:
                add = (left + up) >> 1
            elif kind == PAETH:
                add = _paeth(left, up, corner)
            corner = up
            left = (row[j + 1] + add) & 255
            above[j] = left
            image[i, j] = left
    return image
