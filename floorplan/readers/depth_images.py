"""Frames from 16-bit depth PNGs: what Stray Scanner and TUM folders have in common."""

from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from floorplan.model.checks import Array
from floorplan.model.scan import Frame, Intrinsics, Problem, Recording
from floorplan.readers.base import BadFrame

BEST_CONFIDENCE = 2


@dataclass(frozen=True)
class DepthImages:
    """A `Source` of pinhole depth images, one file per row of `recording`.

    `focal_px (N, 2)`, `centre_px (N, 2)`: fx, fy and cx, cy of each depth image; pixel centres at whole numbers.
    `confidence_paths` is None where the format has no confidence images, `colour_paths` unless brightness is asked for: images of
    the same view as the depth.
    """

    recording: Recording
    depth_paths: tuple[Path, ...]
    metres_per_unit: float
    focal_px: Array
    centre_px: Array
    confidence_paths: tuple[Path, ...] | None = None
    colour_paths: tuple[Path, ...] | None = None

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
        import cv2

        image = cv2.imread(str(path), cv2.IMREAD_UNCHANGED)
        if image is None:
            return Problem("png-unreadable", "image cannot be read", str(path), advice="copy the recording again")
        sensor = self.recording.sensor
        if image.shape != (sensor.height, sensor.width):
            found = " x ".join(str(n) for n in image.shape[1::-1])
            return Problem("png-wrong-size", f"image is {found}, the others {sensor.width} x {sensor.height}", str(path))
        return np.asarray(image)

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
        return np.ascontiguousarray(np.minimum(image[::stride, ::stride], BEST_CONFIDENCE), dtype=np.uint8)


@dataclass(frozen=True)
class PngHead:
    """What the first and last bytes of a PNG say, without decoding it."""

    width: int
    height: int
    bits: int
    whole: bool  # it ends as a PNG must: not cut off


PNG_SIGNATURE = b"\x89PNG\r\n\x1a\n"
PNG_END = b"IEND\xaeB`\x82"
GREY = 0  # PNG colour type
PNG_HEAD_BYTES = 26  # signature, chunk length, "IHDR", width, height, bit depth, colour type


def png_head(path: Path) -> PngHead | None:
    """Size and depth of a greyscale PNG from its first bytes; None when the file is no greyscale PNG or cannot be read."""
    try:
        with path.open("rb") as file:
            head = file.read(PNG_HEAD_BYTES)
            file.seek(-min(len(PNG_END), len(head)), 2)
            tail = file.read()
    except OSError:
        return None  # "cannot be read" is exactly what None says here
    if len(head) < PNG_HEAD_BYTES or not head.startswith(PNG_SIGNATURE) or head[25] != GREY:
        return None
    return PngHead(int.from_bytes(head[16:20], "big"), int.from_bytes(head[20:24], "big"), head[24], tail == PNG_END)


def scaled_intrinsics(colour: Intrinsics, width: int, height: int) -> Intrinsics:
    """Intrinsics of the same view on another number of pixels.

    Pixel centres are at whole numbers, so the image's edge is at -0.5: coordinates shift by half a pixel, scale, shift back.
    """
    sx, sy = width / colour.width, height / colour.height
    return Intrinsics(width, height, colour.fx * sx, colour.fy * sy, (colour.cx + 0.5) * sx - 0.5, (colour.cy + 0.5) * sy - 0.5)
