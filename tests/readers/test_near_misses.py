"""What an unrecognised folder or file nearly is."""

from pathlib import Path

import pytest

from floorplan.errors import InputError
from floorplan.readers import open_scan


@pytest.mark.parametrize(
    ("made", "words"),
    [
        ((), "It is empty."),
        (("odometry.csv",), "looks like stray, but depth/ is missing"),
        (("camera_matrix.csv", "depth/"), "looks like stray, but odometry.csv is missing"),
        (("rgb.txt", "depth/"), "looks like tum, but depth.txt is missing"),
        (("lowres_depth/",), "looks like arkitscenes, but lowres_wide.traj is missing"),
        (("scan.ply",), "looks like clouds, but trajectory.tum or poses.txt is missing"),
        (("holiday.jpg",), "recognised. Looked for"),
    ],
)
def test_a_folder_that_lacks_a_part_is_named(tmp_path: Path, made: tuple[str, ...], words: str) -> None:
    for name in made:
        (tmp_path / name).mkdir() if name.endswith("/") else (tmp_path / name).write_text("x")
    with pytest.raises(InputError, match="not recognised") as caught:
        open_scan(tmp_path)
    assert words in str(caught.value)


@pytest.mark.parametrize(
    ("content", "words"), [(b"", "file is empty"), ("gr\u00fcn".encode(), "text file"), (b"\x00\x01\xff", "recognised. Looked for")]
)
def test_a_file_says_what_it_is(tmp_path: Path, content: bytes, words: str) -> None:
    (tmp_path / "file").write_bytes(content)
    with pytest.raises(InputError, match=words):
        open_scan(tmp_path / "file")
