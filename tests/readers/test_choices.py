"""A folder of recordings is told for what it is, with each of them named."""

import json
from pathlib import Path

import pytest
from typer.testing import CliRunner

from floorplan.cli import app
from floorplan.errors import InputError
from floorplan.readers import choices_in, open_scan, reader_for
from floorplan.simulate import simulate


@pytest.fixture(scope="module")
def site(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("site")
    for name, format in (("hall", "tum"), ("kitchen", "scanner3d"), ("robot", "carmen")):
        simulate(folder / name, "flat", 1, rate_hz=0.3, image_scale=0.2, format=format)
    (folder / "notes").mkdir()
    (folder / "hall.floorplan").mkdir()
    return folder


def test_the_recordings_below_a_folder_are_listed_with_their_formats(site: Path) -> None:
    found = [(choice.path.name, choice.format) for choice in choices_in(site)]
    assert found == [("hall", "tum"), ("kitchen", "scanner3d"), ("robot", "carmen")]
    assert [choice.path.name for choice in choices_in(site.parent)] != []
    with pytest.raises(InputError, match=r"(?s)3 recordings, not one:.*kitchen \(scanner3d\).*Give one of them"):
        open_scan(site)


def test_one_recording_is_no_choice(site: Path) -> None:
    for name in ("hall", "kitchen", "robot"):
        assert choices_in(site / name) == ()
    assert reader_for(site / "robot").name == "carmen"


def test_several_logs_in_one_folder_are_a_choice(site: Path, tmp_path: Path) -> None:
    log = next((site / "robot").glob("*.clf"))
    for name in ("a.clf", "b.clf"):
        (tmp_path / name).write_bytes(log.read_bytes())
    assert [choice.path.name for choice in choices_in(tmp_path)] == ["a.clf", "b.clf"]
    assert choices_in(tmp_path / "a.clf") == ()


def test_info_on_such_a_folder_lists_them_and_says_how_to_go_on(site: Path) -> None:
    told = CliRunner().invoke(app, ["info", str(site)])
    assert told.exit_code == 0
    assert "3 recordings" in told.stdout
    assert f"floorplan info {site / 'hall'}" in told.stdout
    assert "several scans of one floor" in told.stdout
    tree = json.loads(CliRunner().invoke(app, ["info", str(site), "--json"]).stdout)
    assert [row["format"] for row in tree["recordings"]] == ["tum", "scanner3d", "carmen"]
