"""A recording with clutter: flat upright patches at random angles before what each frame saw."""

from collections.abc import Iterable, Iterator
from dataclasses import dataclass, replace

import numpy as np

from floorplan.model.checks import Array
from floorplan.model.scan import Frame, Recording
from floorplan.readers.base import BadFrame, Source

_SIDE_SHARE = 1 / 8  # of the image's width: an armchair 2 m away
_BEFORE = (0.5, 0.9)  # of the distance of what lies behind
_LEAST_COS = 0.2  # seen at a flatter angle, a patch is a line
_MOST_TRIES = 2000  # of a frame that has hardly any depth
_SEED = 71


@dataclass(frozen=True)
class Cluttered:
    """`source` with patches over `share` of the pixels that have depth, the same at every reading of a frame."""

    source: Source
    recording: Recording
    share: float

    def frames(self, indices: Iterable[int], stride: int = 1) -> Iterator[Frame | BadFrame]:
        """The frames, covered."""
        for frame in self.source.frames(indices, stride):
            yield replace(frame, points=self._covered(frame)) if isinstance(frame, Frame) else frame

    def _covered(self, frame: Frame) -> Array:
        random = np.random.default_rng((_SEED, frame.index))
        points, down = np.array(frame.points), self.recording.down_sensor[frame.index]
        first = np.cross(down, np.eye(3)[np.abs(down).argmin()])
        level = np.stack((first, np.cross(down, first))) / np.linalg.norm(first)
        seen = np.isfinite(points[..., 2])
        covered = np.zeros(seen.shape, dtype=bool)
        for _ in range(_MOST_TRIES):
            if covered.sum() >= self.share * seen.sum():
                break
            angle = random.uniform(0, 2 * np.pi)
            normal = np.cos(angle) * level[0] + np.sin(angle) * level[1]
            self._put(points, seen, covered, normal, random)
        return points

    def _put(self, points: Array, seen: Array, covered: Array, normal: Array, random: np.random.Generator) -> None:
        """One patch; nothing where it would be seen flat or behind what is there."""
        side = max(round(seen.shape[1] * _SIDE_SHARE), 2)
        i, j = int(random.integers(0, max(seen.shape[0] - side, 1))), int(random.integers(0, max(seen.shape[1] - side, 1)))
        centre = points[i + side // 2, j + side // 2] * random.uniform(*_BEFORE)
        here = (slice(i, i + side), slice(j, j + side))
        range_m = np.linalg.norm(points[here], axis=2)
        ray = points[here] / range_m[..., None]
        with np.errstate(divide="ignore", invalid="ignore"):
            patch_m = (centre @ normal) / (ray @ normal)
            nearer = seen[here] & (np.abs(ray @ normal) > _LEAST_COS) & (patch_m > self.recording.sensor.min_range_m) & (patch_m < range_m)
        noisy = patch_m + random.normal(size=patch_m.shape) * self.recording.sensor.noise.sigma_m(np.where(nearer, patch_m, 1.0))
        points[here] = np.where(nearer[..., None], ray * noisy[..., None], points[here])
        covered[here] |= nearer
