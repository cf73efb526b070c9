"""Frames looked at coarsely and then finely are read once, and are the same."""

from collections.abc import Iterable, Iterator
from dataclasses import dataclass, field

import numpy as np
import pytest

from floorplan.model.scan import Frame, Problem, Recording
from floorplan.readers import kept_frames
from floorplan.readers.base import BadFrame
from floorplan.readers.kept_frames import KeptFrames
from tests.box_room import camera_scan

BROKEN = 3


@dataclass
class Counted:
    """A scan whose frame 3 cannot be read, that counts what is read of it."""

    recording: Recording = field(default_factory=lambda: camera_scan().recording)
    read: list[int] = field(default_factory=list)

    def frames(self, indices: Iterable[int], stride: int = 1) -> Iterator[Frame | BadFrame]:
        for index in indices:
            self.read.append(index)
            grid = np.random.default_rng(index).normal(size=(24, 36, 3)).astype(np.float32)[::stride, ::stride]
            trust = np.full(grid.shape[:2], index % 3, np.uint8)
            yield BadFrame(index, Problem("png-unreadable", "")) if index == BROKEN else Frame(index, index, grid, trust)


def same(first: Frame | BadFrame, second: Frame | BadFrame) -> bool:
    if isinstance(first, BadFrame) or isinstance(second, BadFrame):
        return first == second
    return bool((first.points == second.points).all() and (first.confidence == second.confidence).all() and first.index == second.index)


def test_what_was_looked_at_coarsely_is_not_read_again() -> None:
    scan = Counted()
    kept = KeptFrames(scan, 2)
    for stride, rows in ((4, [1, BROKEN, 5, 9]), (2, [0, 1, 2, BROKEN, 5, 9]), (2, [9]), (3, [9])):
        assert all(same(a, b) for a, b in zip(kept.frames(rows, stride), Counted().frames(rows, stride), strict=True))
    assert scan.read == [1, BROKEN, 5, 9, 0, 2, BROKEN, 9, 9]


def test_where_there_is_no_more_room_frames_are_read_again(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(kept_frames, "_ROOM_BYTES", 2 * 12 * 18 * 3 * 4)
    scan = Counted()
    kept = KeptFrames(scan, 2)
    assert len(list(kept.frames([0, 1, 2, 4], 6))) == 4
    assert len(list(kept.frames([0, 1, 2, 4], 2))) == 4
    assert scan.read == [0, 1, 2, 4, 2, 4]
