"""A forbidden merge from the edits file to the decisions that `floorplan merges` shows, by either method."""

import json
from pathlib import Path
from typing import Any

import pytest
from typer.testing import CliRunner

from floorplan.cli import app
from floorplan.simulate import simulate


@pytest.fixture(scope="module")
def scan(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("scan") / "flat"
    simulate(folder, "flat", 1, rate_hz=4.0, image_scale=0.3)
    return folder


def run(*arguments: str) -> str:
    result = CliRunner().invoke(app, list(arguments))
    assert result.exit_code == 0, result.output
    return result.stdout


@pytest.mark.parametrize("method", ["evidence", "paper"])
def test_a_pair_forbidden_in_the_edits_file_is_on_two_planes(scan: Path, tmp_path: Path, method: str) -> None:
    work, edits = str(scan.with_suffix(".work")), tmp_path / "edits.toml"
    build = ("build", str(scan), "--work", work, "--until", "merge", "--set", f"merge.method={method}")
    run(*build)
    merged: list[dict[str, Any]] = json.loads(run("merges", work, "--json"))
    row = next(row for row in merged if row["accepted"])
    pair = (row["first"]["track"], row["second"]["track"])
    edits.write_text(f"[[never_merge]]\ntracks = [{pair[1]}, {pair[0]}]\n", "utf-8")
    run(*build, "--edits", str(edits))
    told = {(row["first"]["track"], row["second"]["track"]): row for row in json.loads(run("merges", work, "--json"))}
    assert told[pair]["verdict"] == "forbidden by an edit"
    assert told[pair]["plane"][0] != told[pair]["plane"][1]
    assert sum(row["accepted"] for row in told.values()) > 0
    changes = json.loads(run("merges", work, "--changes", "--json"))
    assert set(changes) == {"moves", "choices"}
    run(*build)
    assert json.loads(run("merges", work, "--json")) == merged
