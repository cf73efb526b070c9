"""Drawings by a second process: the same files, and never fewer of them."""

from pathlib import Path

import pytest

from floorplan import writers
from floorplan.config import DrawingConfig, ProjectConfig
from floorplan.drawing_process import DrawingProcess
from floorplan.drawings import Drawing, drawing_beside
from tests.sample_plan import sample_plan


@pytest.fixture(scope="module")
def job() -> writers.Job:
    return writers.Job(sample_plan(), DrawingConfig(), ProjectConfig(), writers.SheetFacts("sample"))


def test_a_second_process_writes_the_same_bytes(job: writers.Job, tmp_path: Path) -> None:
    with drawing_beside((Drawing("dxf", tmp_path / "second.dxf"), Drawing("svg", tmp_path / "plan.svg")), jobs=2) as second:
        assert second.formats == ("dxf",)  # one library's formats: the others are drawn meanwhile
        second.begin()
        assert second.send(job, [("dxf", tmp_path / "second.dxf")])
        assert second.succeeded()
    writers.write_job("dxf", job, tmp_path / "alone.dxf")
    assert (tmp_path / "second.dxf").read_bytes() == (tmp_path / "alone.dxf").read_bytes()


def test_the_slower_library_goes_to_the_second_process_and_one_job_needs_none() -> None:
    assert DrawingProcess(("dxf", "pdf", "svg"), 2).formats == ("pdf",)
    assert DrawingProcess(("svg", "json"), 2).formats == ()
    assert DrawingProcess(("dxf", "pdf"), 1).formats == ()


def test_a_second_process_that_failed_or_was_killed_says_so(job: writers.Job, tmp_path: Path) -> None:
    with drawing_beside((Drawing("dxf", tmp_path / "plan.dxf"),), jobs=2) as second:
        assert not second.send(job, [("dxf", tmp_path / "plan.dxf")])  # never begun
        second.begin()
        assert second.send(job, [("dxf", tmp_path / "no folder" / "no file" / "..")])
        assert not second.succeeded()
    with drawing_beside((Drawing("dxf", tmp_path / "plan.dxf"),), jobs=2) as killed:
        killed.begin()
        killed.end()
        assert not killed.send(job, [("dxf", tmp_path / "plan.dxf")])
    assert not (tmp_path / "plan.dxf").exists()
