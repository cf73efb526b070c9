"""`--trim 12s:340s`: a recording without its ends, while the sensor was picked up and put down."""

import re
from collections.abc import Iterable, Iterator
from dataclasses import dataclass, replace

import numpy as np

from floorplan.errors import UsageError
from floorplan.model.scan import Frame, Problem, Recording
from floorplan.readers.base import BadFrame, Source

SECONDS = {"": 1.0, "s": 1.0, "min": 60.0}
NUMBER = re.compile(r"(\d+\.?\d*|\.\d+)\s*(s|min|)")
HOW = "write START:END in seconds from the recording's start, such as 12s:340s, 12s: or :5.5min"
MIN_FRAMES = 2


@dataclass(frozen=True)
class Trim:
    """What is kept: from `start_s` to `end_s` after the first stamp; `end_s` None: to the end."""

    start_s: float
    end_s: float | None


def parse_trim(text: str) -> Trim:
    """The two ends; either may be open. Raises UsageError for anything else."""
    start, colon, end = text.strip().lower().partition(":")
    if not colon or not (start.strip() or end.strip()):
        raise UsageError(f"--trim {text}: {HOW}")
    trim = Trim(_seconds(start, text) if start.strip() else 0.0, _seconds(end, text) if end.strip() else None)
    if trim.end_s is not None and trim.end_s <= trim.start_s:
        raise UsageError(f"--trim {text}: it ends at {trim.end_s:g} s, before it starts at {trim.start_s:g} s; {HOW}")
    return trim


def trimmed(source: Source, text: str) -> Source:
    """The scan between the two ends; as it is where `text` is empty. Raises UsageError where nothing would be left."""
    if not text:
        return source
    trim, recording = parse_trim(text), source.recording
    seconds = (recording.stamp_ns - recording.stamp_ns[0]) * 1e-9
    kept = np.flatnonzero((seconds >= trim.start_s) & (seconds <= (np.inf if trim.end_s is None else trim.end_s)))
    if len(kept) < MIN_FRAMES:
        raise UsageError(f"--trim {text} keeps {len(kept)} of {len(recording)} frames; the recording is {seconds[-1]:.1f} s long")
    first, last = int(kept[0]), int(kept[-1]) + 1
    left_out = len(recording) - (last - first)
    where = f"kept: {seconds[first]:.1f} s to {seconds[last - 1]:.1f} s of {seconds[-1]:.1f} s"
    problem = Problem("trimmed", "frames left out at the recording's ends", where, left_out, f"as --trim {text} asked for")
    return _Trimmed(source, _part(recording, slice(first, last), (problem,) if left_out else ()), first)


def _part(recording: Recording, rows: slice, problems: tuple[Problem, ...]) -> Recording:
    """Some rows of a recording; whether the whole of it returned to its start says nothing about a part."""
    return replace(
        recording,
        stamp_ns=recording.stamp_ns[rows],
        position_m=recording.position_m[rows],
        odom_from_sensor=recording.odom_from_sensor[rows],
        down_sensor=recording.down_sensor[rows],
        problems=recording.problems + problems,
        returns_to_start=None if problems else recording.returns_to_start,
    )


@dataclass(frozen=True)
class _Trimmed:
    """A `Source` whose row 0 is row `first` of another one."""

    source: Source
    recording: Recording
    first: int

    def frames(self, indices: Iterable[int], stride: int = 1) -> Iterator[Frame | BadFrame]:
        """See `Source.frames`."""
        for frame in self.source.frames([int(index) + self.first for index in indices], stride):
            yield replace(frame, index=frame.index - self.first)


def _seconds(word: str, text: str) -> float:
    found = NUMBER.fullmatch(word.strip())
    if found is None:
        raise UsageError(f"--trim {text}: '{word.strip()}' is no time; {HOW}")
    return float(found[1]) * SECONDS[found[2]]
