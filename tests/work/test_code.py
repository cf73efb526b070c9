"""A stage's fingerprint follows the sources it is made by, and no others."""

import shutil
from pathlib import Path

import pytest

from floorplan.work import code
from floorplan.work.stages import INGEST, LEAST_SQUARES, MERGE, PLAN, RESOLVE, SEGMENTS, STAGES, Stage


def names(stage: Stage) -> set[str]:
    return {path.relative_to(code.PACKAGE).as_posix() for path in code.stage_sources(stage)}


@pytest.mark.parametrize(
    ("stage", "made_by", "not_by"),
    [
        (INGEST, "readers/stray.py", "merge/evidence.py"),
        (SEGMENTS, "compass/entropy.py", "plan/walls.py"),
        (LEAST_SQUARES, "tracking.py", "segments/fit.py"),
        (MERGE, "merge/paper_cvxpy.py", "plan/walls.py"),
        (RESOLVE, "weighted_resolve.py", "merge/evidence.py"),
        (PLAN, "plan/walls.py", "merge/evidence.py"),
    ],
)
def test_the_sources_of_a_stage_are_what_it_imports(stage: Stage, made_by: str, not_by: str) -> None:
    assert made_by in names(stage)
    assert not_by not in names(stage)


def test_no_stage_depends_on_the_command_line_the_drawings_or_the_simulator() -> None:
    for stage in STAGES:
        assert not {name for name in names(stage) if name.split("/")[0] in ("cli", "writers", "simulate", "work", "config.py")}


def test_an_edit_changes_the_stages_made_by_that_file_alone(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    package = tmp_path / "floorplan"
    shutil.copytree(code.PACKAGE, package, ignore=shutil.ignore_patterns("__pycache__"))
    monkeypatch.setattr(code, "PACKAGE", package)
    before = {stage: code.code_fingerprint(stage) for stage in STAGES}
    with (package / "plan" / "walls.py").open("a") as file:
        file.write("# edited\n")
    code._source.cache_clear()
    assert {stage for stage in STAGES if code.code_fingerprint(stage) != before[stage]} == {PLAN}
    code._source.cache_clear()
