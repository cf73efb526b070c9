"""The rows of a PNG, back from the differences they are stored as (PNG specification, 9)."""

import numpy as np

from floorplan.compiled import compiled
from floorplan.model.checks import Array

SUB, UP, AVERAGE, PAETH = 1, 2, 3, 4  # what a pixel is stored as the difference to: left, above, their mean, the likeliest of three


@compiled
def _paeth(left: np.int32, above: np.int32, corner: np.int32) -> np.int32:
    """The one of three neighbours nearest to left + above - corner."""
    to_left, to_above, to_corner = abs(above - corner), abs(left - corner), abs(left + above - 2 * corner)
    likelier = above if to_above <= to_corner else corner
    return left if (to_left <= to_above) & (to_left <= to_corner) else likelier  # no branch that a processor would guess wrong


@compiled
def unfiltered_16(raw: Array) -> Array:
    """Pixels (H, W) uint16, big-endian in the file, of rows that begin with the number of their filter."""
    height, width = raw.shape[0], (raw.shape[1] - 1) // 2
    image = np.empty((height, width), np.uint16)
    above = np.zeros(width, np.uint16)
    for i in range(height):
        row, kind = raw[i], raw[i, 0]
        if kind == SUB:
            _row_of_differences(row, image[i])
        elif kind == UP:
            for j in range(width):
                up = np.int32(above[j])
                high, low = (up >> 8) + row[2 * j + 1], (up & 255) + row[2 * j + 2]
                image[i, j] = (high & 255) << 8 | (low & 255)
        elif kind == PAETH:
            _row_of_likeliest(row, above, image[i])
        elif kind == AVERAGE:
            _row_of_means(row, above, image[i])
        else:
            for j in range(width):
                image[i, j] = np.int32(row[2 * j + 1]) << 8 | row[2 * j + 2]
        above = image[i]
    return image


@compiled
def _row_of_differences(row: Array, pixels: Array) -> None:
    """A row of differences to the pixel on the left."""
    high, low = np.int32(0), np.int32(0)
    for j in range(len(pixels)):
        high, low = (high + row[2 * j + 1]) & 255, (low + row[2 * j + 2]) & 255
        pixels[j] = high << 8 | low


@compiled
def _row_of_means(row: Array, above: Array, pixels: Array) -> None:
    """A row of differences to the mean of the pixels on the left and `above`."""
    high, low = np.int32(0), np.int32(0)
    for j in range(len(pixels)):
        up = np.int32(above[j])
        high, low = (row[2 * j + 1] + ((high + (up >> 8)) >> 1)) & 255, (row[2 * j + 2] + ((low + (up & 255)) >> 1)) & 255
        pixels[j] = high << 8 | low


@compiled
def _row_of_likeliest(row: Array, above: Array, pixels: Array) -> None:
    """A row of differences to the likeliest of three neighbours."""
    high, low, corner = np.int32(0), np.int32(0), np.int32(0)
    for j in range(len(pixels)):
        up = np.int32(above[j])
        high = (row[2 * j + 1] + _paeth(high, up >> 8, corner >> 8)) & 255
        low = (row[2 * j + 2] + _paeth(low, up & 255, corner & 255)) & 255
        corner = up
        pixels[j] = high << 8 | low


@compiled
def unfiltered_8(raw: Array) -> Array:
    """Pixels (H, W) uint8 of rows that begin with the number of their filter."""
    height, width = raw.shape[0], raw.shape[1] - 1
    image = np.empty((height, width), np.uint8)
    above = np.zeros(width, np.int32)
    for i in range(height):
        row, kind = raw[i], raw[i, 0]
        left, corner = np.int32(0), np.int32(0)
        for j in range(width):
            up, add = above[j], np.int32(0)
            if kind == SUB:
                add = left
            elif kind == UP:
                add = up
            elif kind == AVERAGE:
                add = (left + up) >> 1
            elif kind == PAETH:
                add = _paeth(left, up, corner)
            corner = up
            left = (row[j + 1] + add) & np.int32(255)
            above[j] = left
            image[i, j] = left
    return image
