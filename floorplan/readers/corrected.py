"""A scan whose depth is known to be off, corrected as it is read: `read.range_scale`, `read.range_offset_mm`."""

from collections.abc import Iterable, Iterator
from dataclasses import dataclass, replace

import numpy as np

from floorplan.config import ReadConfig
from floorplan.errors import ConfigError
from floorplan.model.checks import Array
from floorplan.model.scan import Frame, Recording, SensorKind
from floorplan.readers.base import BadFrame, Source

_LEAST_SCALE, _MOST_SCALE = 0.5, 2.0  # beyond, the depth unit is wrong, which is another setting


def corrected(source: Source, config: ReadConfig) -> Source:
    """The scan with `(reading - offset) / scale` for every reading; as it is where nothing is to be corrected."""
    if config.range_scale == 1.0 and config.range_offset_mm == 0.0:
        return source
    if not _LEAST_SCALE <= config.range_scale <= _MOST_SCALE:
        unit = "a wrong depth unit is set by read.depth_scale"
        raise ConfigError(f"read.range_scale must lie between {_LEAST_SCALE} and {_MOST_SCALE}, and is {config.range_scale}; {unit}")
    return _Corrected(source, config.range_scale, config.range_offset_mm * 1e-3)


@dataclass(frozen=True)
class _Corrected:
    """A `Source` with other depth: cameras measure along their axis, lasers along the beam."""

    source: Source
    scale: float
    offset_m: float

    @property
    def recording(self) -> Recording:
        """As the source has it."""
        return self.source.recording

    def frames(self, indices: Iterable[int], stride: int = 1) -> Iterator[Frame | BadFrame]:
        """See `Source.frames`."""
        for frame in self.source.frames(indices, stride):
            yield frame if isinstance(frame, BadFrame) else replace(frame, points=self._points(frame.points))

    def _points(self, points: Array) -> Array:
        camera = self.recording.sensor.kind is SensorKind.CAMERA
        reading = points[..., 2] if camera else np.linalg.norm(points, axis=-1)
        with np.errstate(divide="ignore", invalid="ignore"):
            factor = (reading - self.offset_m) / (self.scale * reading)
        return np.asarray(points * np.where(factor > 0, factor, np.nan)[..., None], dtype=np.float32)
