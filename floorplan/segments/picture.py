"""What one frame was taken for, as a picture: the labelled depth image in the paper's colours beside the depth.

x red, y green, z blue, no label black, no depth white; surfaces off the axes yellow, segments outlined.
"""

import numpy as np

from floorplan.model.checks import Array
from floorplan.segments.labels import OFF_AXIS
from floorplan.segments.values import SegmentedFrame

_AXIS_COLOURS = np.array(((255, 0, 0), (0, 255, 0), (0, 0, 255)), dtype=np.uint8)
_OFF_AXIS_COLOUR = np.array((255, 220, 0), dtype=np.uint8)
_OUTLINE_COLOUR = np.array((255, 255, 255), dtype=np.uint8)


def frame_picture(points: Array, segmented: SegmentedFrame) -> Array:
    """RGB image (H, 2 W, 3) uint8: depth in grey on the left, labels with segment outlines on the right."""
    seen = np.isfinite(points[..., 2])
    distance = np.linalg.norm(np.where(seen[..., None], points, 0), axis=2)
    grey = np.where(seen, 40 + 200 * (1 - distance / max(float(distance.max()), 1e-6)), 255).astype(np.uint8)
    return np.concatenate((np.repeat(grey[..., None], 3, axis=2), label_picture(segmented, seen)), axis=1)


def label_picture(segmented: SegmentedFrame, seen: Array) -> Array:
    """RGB image (H, W, 3) uint8 of the labels, with the segments' outlines."""
    labels = segmented.labels
    image = np.zeros((*labels.shape, 3), dtype=np.uint8)
    for axis in range(3):
        image[(labels // 2 == axis) & (labels >= 0)] = _AXIS_COLOURS[axis]
    image[labels == OFF_AXIS] = _OFF_AXIS_COLOUR
    image[~seen] = 255
    number = np.pad(segmented.segment_of_pixel, 1, constant_values=-1)
    inside = number[1:-1, 1:-1]
    edge = (inside != number[:-2, 1:-1]) | (inside != number[2:, 1:-1]) | (inside != number[1:-1, :-2]) | (inside != number[1:-1, 2:])
    image[edge & (inside >= 0)] = _OUTLINE_COLOUR
    return image
