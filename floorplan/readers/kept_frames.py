"""A scan whose frames are looked at twice and decoded once, as far as there is room to keep them."""

from collections.abc import Iterable, Iterator
from dataclasses import dataclass, field, replace
from threading import Lock

import numpy as np

from floorplan.model.checks import Array
from floorplan.model.scan import Frame, Recording
from floorplan.readers.base import BadFrame, Source

_ROOM_BYTES = 96 << 20  # the survey's frames of 1200 keyframes; a build takes more than that later, for other things


@dataclass
class _Kept:
    """Frames read finer than they were asked for, until they are asked for so finely.

    Their points lie in one block of memory, which goes back to the system as a whole; single ones would leave gaps that stay.
    """

    frame: dict[int, Frame] = field(default_factory=dict)
    block: Array | None = None
    used: int = 0
    lock: Lock = field(default_factory=Lock)

    def add(self, frame: Frame) -> None:
        """Keep `frame` where there is room."""
        with self.lock:
            if self.block is None and not self.used:
                self.block = np.empty((_ROOM_BYTES // frame.points.nbytes, *frame.points.shape), np.float32)
            if self.block is None or self.used == len(self.block) or frame.points.shape != self.block.shape[1:]:
                return
            room = self.block[self.used]
            self.used += 1
        np.copyto(room, frame.points)
        self.frame[frame.index] = replace(frame, points=room)

    def take(self, index: int) -> Frame | None:
        """The kept frame, which is then kept no more; the last one taken gives up the memory."""
        with self.lock:
            frame = self.frame.pop(index, None)
            if not self.frame:
                self.block = None
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
