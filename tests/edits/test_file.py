"""edits.toml: what it holds, and what each mistake is told as."""

from pathlib import Path

import pytest

from floorplan.edits.file import Edits, RoomName, TrackPair, read_edits
from floorplan.errors import ConfigError
from floorplan.templates_dir import templates_dir


def test_the_template_holds_one_edit_of_each_kind() -> None:
    edits = read_edits(templates_dir() / "edits.toml")
    assert edits.never_merge == (TrackPair(12, 45),)
    assert edits.always_merge == (TrackPair(3, 17),)
    assert (edits.furniture, edits.delete) == (("W9",), ("W14",))
    assert edits.room == (RoomName("R2", "Kitchen"),)
    assert edits.opening[0].kind == "door"


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("[[paint]]\nid = 'R1'", "no edit 'paint'"),
        ("[room]\nid = 'R1'\nname = 'x'", "[[room]]"),
        ("[[room]]\nid = 'R1'", "id and name"),
        ("[[room]]\nid = 'R1'\nname = 'x'\ncolour = 'red'", "colour"),
        ("[[never_merge]]\ntracks = [1]", "two different track numbers"),
        ("[[never_merge]]\ntracks = [1, 1]", "two different track numbers"),
        ("[[never_merge]]\ntracks = [1, true]", "two different track numbers"),
        ("[[always_merge]]\ntracks = 'P1'", "two different track numbers"),
        ("[[opening]]\nid = 'O1'\nkind = 'gate'", "door, passage, window"),
        ("[[delete]]\nid = 7", "in quotes"),
        ("[[delete", "not valid TOML"),
    ],
)
def test_each_mistake_is_told_with_the_way_out(tmp_path: Path, text: str, words: str) -> None:
    path = tmp_path / "edits.toml"
    path.write_text(text, "utf-8")
    with pytest.raises(ConfigError) as caught:
        read_edits(path)
    assert words in str(caught.value)
    assert str(path) in str(caught.value)


def test_a_missing_file_is_told_and_an_empty_one_is_no_edit(tmp_path: Path) -> None:
    with pytest.raises(ConfigError, match="cannot be read"):
        read_edits(tmp_path / "none.toml")
    (tmp_path / "empty.toml").write_text("", "utf-8")
    assert read_edits(tmp_path / "empty.toml") == Edits()
