"""A scan whose frames are looked at twice and decoded once, as far as there is room to keep them."""

from collections.abc import Iterable, Iterator
from dataclasses import dataclass, field
from threading import Lock

import numpy as np

from floorplan.model.checks import Array
from floorplan.model.scan import Frame, Recording
from floorplan.readers.base import BadFrame, Source

_ROOM_BYTES = 96 << 20  # the survey's frames of 1200 keyframes; a build takes more than that later, for other things


@dataclass
class _Kept:
    """Frames read finer than they were asked for, until they are asked for so finely."""

    frame: dict[int, Frame] = field(default_factory=dict)
    size_bytes: int = 0
    lock: Lock = field(default_factory=Lock)

    def add(self, frame: Frame) -> None:
        """Keep `frame` where there is room."""
        size = frame.points.nbytes
        with self.lock:
            if frame.index not in self.frame and self.size_bytes + size <= _ROOM_BYTES:
                self.frame[frame.index] = frame
                self.size_bytes += size

    def take(self, index: int) -> Frame | None:
        """The kept frame, which is then kept no more."""
        with self.lock:
            frame = self.frame.pop(index, None)
            self.size_bytes -= frame.points.nbytes if frame else 0
        return frame


@dataclass(frozen=True)
class KeptFrames:
    """A `Source` that reads frames with `stride`, gives what is asked for of them, and keeps those that were looked at more coarsely."""

    source: Source
    stride: int
    kept: _Kept = field(default_factory=_Kept)

    @property
    def recording(self) -> Recording:
        """See `Source.recording`."""
        return self.source.recording

    def frames(self, indices: Iterable[int], stride: int = 1) -> Iterator[Frame | BadFrame]:
        """See `Source.frames`. Frames finer than `self.stride`, or not at whole steps of it, are read anew."""
        if stride % self.stride:
            yield from self.source.frames(indices, stride)
            return
        step = stride // self.stride
        rows = [int(index) for index in indices]
        kept = {row: found for row in rows if step == 1 and (found := self.kept.take(row))}
        read = iter(self.source.frames([row for row in rows if row not in kept], self.stride))  # one pass: bags are read in order
        for row in rows:
            frame: Frame | BadFrame = kept.pop(row, None) or next(read)
            if step > 1 and isinstance(frame, Frame):
                self.kept.add(frame)
                frame = _every(frame, step)
            yield frame


def _every(frame: Frame, step: int) -> Frame:
    """The frame's every `step`-th pixel."""

    def thinned(grid: Array | None) -> Array | None:
        return None if grid is None else np.ascontiguousarray(grid[::step, ::step])

    points = np.ascontiguousarray(frame.points[::step, ::step])
    return Frame(frame.index, frame.stamp_ns, points, thinned(frame.confidence), thinned(frame.grey))
