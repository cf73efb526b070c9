"""`--trim`: the ends of a recording left out, and nothing else changed."""

import numpy as np
import pytest

from floorplan.errors import UsageError
from floorplan.model.scan import Frame
from floorplan.trim import Trim, parse_trim, trimmed
from tests.box_room import camera_scan


@pytest.mark.parametrize(
    ("text", "trim"),
    [
        ("12s:340s", Trim(12, 340)),
        ("12s:", Trim(12, None)),
        (":5.5min", Trim(0, 330)),
        ("0.5:2", Trim(0.5, 2)),
        (" 1 s : 2 S ", Trim(1, 2)),
    ],
)
def test_both_ends_are_read_and_either_may_be_open(text: str, trim: Trim) -> None:
    assert parse_trim(text) == trim


@pytest.mark.parametrize("text", ["12s", ":", "", "x:3", "12h:", "5:3", "3:3", "-1:3", "1:2:3"])
def test_what_is_no_stretch_of_time_is_refused_with_the_way_to_write_it(text: str) -> None:
    with pytest.raises(UsageError, match=r"12s:340s"):
        parse_trim(text)


def test_frames_between_the_ends_are_those_of_the_whole_recording_under_new_numbers() -> None:
    whole = camera_scan(frames=12)  # ten a second
    part = trimmed(whole, "0.3s:0.8s")
    rows = slice(3, 9)
    assert (part.recording.stamp_ns == whole.recording.stamp_ns[rows]).all()
    assert (part.recording.position_m == whole.recording.position_m[rows]).all()
    (frame,), (same,) = list(part.frames([2])), list(whole.frames([5]))
    assert isinstance(frame, Frame)
    assert (frame.index, frame.stamp_ns) == (2, same.stamp_ns)
    assert np.array_equal(frame.points, same.points, equal_nan=True)
    assert [(p.code, p.count) for p in part.recording.problems] == [("trimmed", 6)]


def test_a_trim_that_keeps_everything_says_nothing_and_one_that_keeps_nothing_is_an_error() -> None:
    whole = camera_scan(frames=12)
    assert trimmed(whole, "") is whole
    assert trimmed(whole, "0s:").recording.problems == ()
    with pytest.raises(UsageError, match=r"1\.1 s long"):
        trimmed(whole, "5s:")
