"""Frames from 16-bit depth PNGs: what Stray Scanner and TUM folders have in common."""

from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from floorplan.model.checks import Array
from floorplan.model.scan import Frame, Intrinsics, Problem, Recording
from floorplan.readers.base import BadFrame
from floorplan.readers.png import read_png

BEST_CONFIDENCE = 2


@dataclass(frozen=True)
class DepthImages:
    """A `Source` of pinhole depth images, one file per row of `recording`.

    `focal_px (N, 2)`, `centre_px (N, 2)`: fx, fy and cx, cy of each depth image; pixel centres at whole numbers.
    `confidence_paths` is None where the format has no confidence images, whose values are 0, 1, 2 times `confidence_step`;
    `colour_paths` unless brightness is asked for: images of the same view as the depth.
    """

    recording: Recording
    depth_paths: tuple[Path, ...]
    metres_per_unit: float
    focal_px: Array
    centre_px: Array
    confidence_paths: tuple[Path, ...] | None = None
    colour_paths: tuple[Path, ...] | None = None
    confidence_step: int = 1

    def frames(self, indices: Iterable[int], stride: int = 1) -> Iterator[Frame | BadFrame]:
        """See `Source.frames`."""
        for index in indices:
            yield self._frame(int(index), stride)

    def _frame(self, index: int, stride: int) -> Frame | BadFrame:
        depth = self._decoded(self.depth_paths[index])
        if isinstance(depth, Problem):
            return BadFrame(index, depth)
        points = self._points(index, depth, stride)
        confidence = self._confidence(index, stride)
        if isinstance(confidence, Problem):
            return BadFrame(index, confidence)
        return Frame(index, int(self.recording.stamp_ns[index]), points, confidence, self._grey(index, stride))

    def _grey(self, index: int, stride: int) -> "Array | None":
        """Brightness (H, W) on the depth's pixels; black where the image cannot be read: the odometry then has depth alone."""
        import cv2

        if self.colour_paths is None:
            return None
        sensor = self.recording.sensor
        image = cv2.imread(str(self.colour_paths[index]), cv2.IMREAD_GRAYSCALE)
        if image is None:
            return np.zeros((sensor.height, sensor.width), dtype=np.uint8)[::stride, ::stride].copy()
        scaled = cv2.resize(image, (sensor.width, sensor.height), interpolation=cv2.INTER_AREA)
        return np.ascontiguousarray(scaled[::stride, ::stride])

    def _decoded(self, path: Path) -> "Array | Problem":
        """The raw image, or what is wrong with it."""
        image = read_png(path)
        if image is None:
            return Problem("png-unreadable", "image cannot be read", str(path), advice="copy the recording again")
        sensor = self.recording.sensor
        if image.shape != (sensor.height, sensor.width):
            found = " x ".join(str(n) for n in image.shape[1::-1])
            return Problem("png-wrong-size", f"image is {found}, the others {sensor.width} x {sensor.height}", str(path))
        return image

    def _points(self, index: int, raw: Array, stride: int) -> Array:
        """Points (H, W, 3) float32 of the strided image: z = depth, x = z (u - cx) / fx, y = z (v - cy) / fy."""
        from floorplan.readers.back_project import back_project

        sensor = self.recording.sensor
        (fx, fy), (cx, cy) = self.focal_px[index], self.centre_px[index]
        ray_x = ((np.arange(0, sensor.width, stride) - cx) / fx).astype(np.float32)
        ray_y = ((np.arange(0, sensor.height, stride) - cy) / fy).astype(np.float32)
        return back_project(raw, stride, self.metres_per_unit, sensor.max_range_m, ray_x, ray_y)

    def _confidence(self, index: int, stride: int) -> "Array | Problem | None":
        if self.confidence_paths is None:
            return None
        image = self._decoded(self.confidence_paths[index])
        if isinstance(image, Problem):
            return image
        level = (image[::stride, ::stride].astype(np.uint16) + self.confidence_step // 2) // self.confidence_step
        return np.ascontiguousarray(np.minimum(level, BEST_CONFIDENCE), dtype=np.uint8)


def scaled_intrinsics(colour: Intrinsics, width: int, height: int) -> Intrinsics:
    """Intrinsics of the same view on another number of pixels.

    Pixel centres are at whole numbers, so the image's edge is at -0.5: coordinates shift by half a pixel, scale, shift back.
    """
    sx, sy = width / colour.width, height / colour.height
    return Intrinsics(width, height, colour.fx * sx, colour.fy * sy, (colour.cx + 0.5) * sx - 0.5, (colour.cy + 0.5) * sy - 0.5)
