"""Recordings broken on purpose: each breakage is named, counted or refused, with the exit code that belongs to it."""

import re
from collections.abc import Callable
from pathlib import Path

import pytest
from typer.testing import CliRunner

from floorplan.cli import app
from floorplan.errors import InputError
from tests.readers.folders import Walk, write_stray, write_tum

RUNNER = CliRunner()
FRAMES = 12
Breakage = Callable[[Path], object]


def built(scan: Path, *arguments: str) -> tuple[int, str]:
    """Exit code and message of a build; what is no `FloorplanError` is raised."""
    result = RUNNER.invoke(app, ["build", str(scan), *arguments])
    if result.exception is None:
        return 0, result.output
    if not isinstance(result.exception, InputError):
        raise result.exception
    return result.exception.exit_code, str(result.exception)


def rewritten(name: str, change: Callable[[str], str]) -> Breakage:
    """Breaks a text file."""
    return lambda scan: (scan / name).write_text(change((scan / name).read_text()))


def each_row(change: Callable[[list[str]], str], every: int = 1) -> Callable[[str], str]:
    """Changes the words of every so many rows of a table, the header left as it is."""

    def apply(text: str) -> str:
        header, *rows = text.splitlines()
        return "\n".join([header, *(row if n % every else change(row.split()) for n, row in enumerate(rows))]) + "\n"

    return apply


def without_a_number(row: list[str]) -> str:
    return f"{row[0]} nan nan nan 0 0 0 1"


def cut_off(*numbers: int) -> Breakage:
    """Depth images that were not written to the end."""

    def apply(scan: Path) -> None:
        for number in numbers:
            path = scan / "depth" / f"{number}.png"
            path.write_bytes(path.read_bytes()[:200])

    return apply


def rotten(*numbers: int) -> Breakage:
    """Depth images that begin and end well and cannot be decoded."""

    def apply(scan: Path) -> None:
        for number in numbers:
            path = scan / "depth" / f"{number}.png"
            content = bytearray(path.read_bytes())
            middle = len(content) // 2
            content[middle : middle + 40] = b"\xff" * 40
            path.write_bytes(bytes(content))

    return apply


def emptied(folder: str) -> Breakage:
    return lambda scan: [path.unlink() for path in (scan / folder).iterdir()]


def removed(name: str) -> Breakage:
    return lambda scan: (scan / name).unlink()


REFUSED: dict[str, tuple[Breakage, str]] = {
    "no depth image": (emptied("depth"), "no frames"),
    "an empty list of frames": (rewritten("depth.txt", lambda text: "# stamp file\n"), "no frames"),
    "too many cut-off images": (cut_off(3, 4), r"too-many-unreadable: 2 of 12 .*3\.png.*max_unreadable_share"),
    "intrinsics missing": (removed("intrinsics.json"), r"intrinsics missing.*read\.fx"),
    "rooms of 4 km": (rewritten("intrinsics.json", lambda text: text.replace("5000.0", "5.0")), r"depth-unit.*1158 m.*with 5000"),
    "rooms of 4 mm": (rewritten("intrinsics.json", lambda text: text.replace("5000.0", "5000000.0")), r"depth-unit.*with 5000"),
    "poses missing": (removed("groundtruth.txt"), r"poses missing.*odometry\.txt"),
    "an empty trajectory": (rewritten("groundtruth.txt", lambda text: "#\n"), "no pose could be read"),
    "no pose a number": (rewritten("groundtruth.txt", each_row(without_a_number)), "no pose could be read"),
    "poses of another day": (rewritten("groundtruth.txt", each_row(lambda row: " ".join(["9" + row[0], *row[1:]]))), "same clock"),
}


@pytest.mark.parametrize("name", REFUSED)
def test_what_cannot_be_used_is_refused_with_3_and_says_what_to_do(tmp_path: Path, name: str) -> None:
    breakage, words = REFUSED[name]
    breakage(write_tum(tmp_path / "scan", Walk(FRAMES)))
    code, message = built(tmp_path / "scan", "--until", "ingest", "--set", "read.world_up=+z")
    assert code == 3
    assert re.search(words, message), message


COUNTED: dict[str, tuple[Breakage, str]] = {
    "one cut-off image": (cut_off(3), r"png-unreadable: .*1x.*3\.png"),
    "poses not numbers": (rewritten("groundtruth.txt", each_row(without_a_number, 4)), r"pose-missing: .*\(3x, first: groundtruth.txt"),
    "stamps going back": (rewritten("depth.txt", lambda text: "\n".join(["#", *text.splitlines()[:0:-1]])), r"stamp-unsorted: .*\(11x"),
    "a stamp twice": (rewritten("depth.txt", lambda text: text + text.splitlines()[-1] + "\n"), r"stamp-doubled: .*\(1x, first: depth.txt"),
}


@pytest.mark.parametrize("name", COUNTED)
def test_what_can_be_left_out_is_left_out_counted_and_named(tmp_path: Path, name: str) -> None:
    breakage, words = COUNTED[name]
    breakage(write_tum(tmp_path / "scan", Walk(FRAMES)))
    code, output = built(tmp_path / "scan", "--until", "ingest", "--set", "read.world_up=+z")
    assert code == 0
    assert re.search(words, output), output


def test_gravity_missing_is_refused_with_the_setting_that_gives_it(tmp_path: Path) -> None:
    code, message = built(write_tum(tmp_path / "scan", Walk(FRAMES)), "--until", "ingest")
    assert code == 3
    assert re.search(r"gravity-missing: .*read\.world_up", message)


def test_an_image_rotten_inside_is_counted_and_many_stop_the_build(tmp_path: Path) -> None:
    arguments = ("--until", "segments", "--set", "read.world_up=+z")
    one, many = (write_tum(tmp_path / name, Walk(40)) for name in ("one", "many"))
    rotten(2)(one)
    rotten(*range(2, 30, 2))(many)
    code, output = built(one, *arguments)
    assert code == 0
    assert re.search(r"1 frames unreadable\nnote: png-unreadable: .*1x.*2\.png", output)
    code, message = built(many, *arguments)
    assert code == 3
    assert re.search(r"too-many-unreadable: \d+ of 17 frames looked at", message)


def test_a_recording_without_a_wall_ends_with_3_and_says_what_was_seen(tmp_path: Path) -> None:
    code, message = built(write_tum(tmp_path / "scan", Walk(40)), "--set", "read.world_up=+z")
    assert code == 3
    assert message.startswith("no wall found: 0 flat surfaces in 17 frames")


@pytest.mark.parametrize(
    ("breakage", "words"),
    [
        (removed("camera_matrix.csv"), "intrinsics missing"),
        (emptied("depth"), "no frames"),
        (rewritten("odometry.csv", lambda text: text.splitlines()[0] + "\n"), "no frames"),
    ],
    ids=["camera_matrix.csv", "depth", "odometry.csv"],
)
def test_a_phone_export_with_a_part_missing_is_refused(tmp_path: Path, breakage: Breakage, words: str) -> None:
    breakage(write_stray(tmp_path / "scan", Walk(FRAMES)))
    code, message = built(tmp_path / "scan", "--until", "ingest")
    assert code == 3
    assert words in message
