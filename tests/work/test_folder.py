"""The work folder keeps what matches, makes again what does not, and says why."""

import errno
import json
import multiprocessing
import os
import signal
from dataclasses import dataclass
from pathlib import Path

import pytest

from floorplan.config import Config
from floorplan.config_file import load_config
from floorplan.errors import WorkFolderError
from floorplan.reporting import SilentReporter
from floorplan.work import chunks as chunks_module
from floorplan.work.fingerprint import scan_fingerprint
from floorplan.work.folder import Owner, UntilReached, WorkFolder, claim
from floorplan.work.lock import locked
from floorplan.work.stages import INGEST, LEAST_SQUARES, MERGE, PLAN, RESOLVE, SEGMENTS, STAGES, Stage
from floorplan.work.status import StageState, stages_status

OWNER = Owner("/scan", "tum", "f00d")


@dataclass(frozen=True)
class Value:
    number: float


class Listener(SilentReporter):
    def __init__(self) -> None:
        self.details: list[str] = []

    def detail(self, text: str) -> None:
        self.details.append(text)


def run(path: Path, config: Config, made: list[str], redo_from: Stage | None = None, until: Stage | None = None) -> list[str]:
    listener = Listener()
    path.mkdir(exist_ok=True)
    work = WorkFolder(path, OWNER, config, redo_from, until, listener)

    def make(stage: Stage) -> Value:
        made.append(stage.name)
        return Value(len(stage.folder) / 3)

    for stage in STAGES:
        assert work.stage(stage, Value, lambda stage=stage: make(stage)) == Value(len(stage.folder) / 3)
    return listener.details


def test_everything_is_made_once_and_then_kept(tmp_path: Path) -> None:
    made: list[str] = []
    run(tmp_path, Config(), made)
    run(tmp_path, Config(), made)
    assert made == ["ingest", "segments", "least-squares", "merge", "resolve", "plan"]
    assert {s.state for s in stages_status(tmp_path, Config(), OWNER)} == {StageState.KEPT}


@pytest.mark.parametrize(
    ("setting", "first_made"),
    [
        ("ingest.keyframe_distance_m=0.2", 0),
        ("compass.method=entropy", 1),
        ("segments.pixel_stride=3", 1),
        ("tracking.gate_m=0.06", 2),
        ("merge.radius_m=2", 3),
        ("plan.max_bridged_gap_m=0.2", 5),
        ("drawing.units=mm", 6),
        ("project.name=X", 6),
        ("ingest.returns_to_start=true", 6),
    ],
)
def test_a_changed_setting_makes_its_stage_and_what_follows_again_and_says_so(tmp_path: Path, setting: str, first_made: int) -> None:
    run(tmp_path, Config(), [])
    changed = load_config(None, [setting])
    states = [s.state for s in stages_status(tmp_path, changed, OWNER)]
    assert states[:first_made] == [StageState.KEPT] * first_made
    made: list[str] = []
    details = run(tmp_path, changed, made)
    dependants = [s.name for s in STAGES[first_made:]]
    assert made == dependants
    if made:
        assert setting.split("=")[0] in details[0]


def test_from_makes_again_what_would_be_kept_and_until_stops(tmp_path: Path) -> None:
    run(tmp_path, Config(), [])
    made: list[str] = []
    with pytest.raises(UntilReached):
        run(tmp_path, Config(), made, redo_from=MERGE, until=RESOLVE)
    assert made == ["merge", "resolve"]
    assert (tmp_path / PLAN.folder).is_dir()


def test_a_stage_that_fails_leaves_the_old_result_and_no_rubbish(tmp_path: Path) -> None:
    run(tmp_path, Config(), [])
    work = WorkFolder(tmp_path, OWNER, Config(), redo_from=INGEST)

    def fail() -> Value:
        raise RuntimeError("broken")

    with pytest.raises(RuntimeError):
        work.stage(INGEST, Value, fail)
    assert {p.name for p in tmp_path.iterdir()} == {s.folder for s in STAGES}
    assert stages_status(tmp_path, Config(), OWNER)[0].state is StageState.KEPT


def test_a_changed_scan_or_stage_version_makes_everything_stale(tmp_path: Path) -> None:
    run(tmp_path, Config(), [])
    states = stages_status(tmp_path, Config(), Owner("/scan", "tum", "beef"))
    assert {s.state for s in states} == {StageState.STALE}
    assert states[0].reasons == ("the scan's files changed",)
    record = json.loads((tmp_path / SEGMENTS.folder / "stage.json").read_text())
    record["recipe"]["version"] = 0
    (tmp_path / SEGMENTS.folder / "stage.json").write_text(json.dumps(record))
    assert "version 0" in stages_status(tmp_path, Config(), OWNER)[1].reasons[0]


def test_a_work_folder_of_another_scan_is_refused_and_of_a_moved_one_taken(tmp_path: Path) -> None:
    work = tmp_path / "work"
    claim(work, OWNER)
    claim(work, Owner("/moved", "tum", "f00d"))
    claim(work, Owner("/moved", "tum", "beef"))  # the same place, other files: made again, not refused
    with pytest.raises(WorkFolderError, match="another scan"):
        claim(work, Owner("/other", "tum", "abba"))
    (tmp_path / "letters").mkdir()
    (tmp_path / "letters" / "dear.txt").write_text("sir")
    with pytest.raises(WorkFolderError, match="not a work folder"):
        claim(tmp_path / "letters", OWNER)


def test_chunks_are_made_once_and_thrown_away_when_a_setting_changes(tmp_path: Path) -> None:
    made: list[int] = []

    def chunk(config: Config, number: int) -> Value:
        store = WorkFolder(tmp_path, OWNER, config, keys={INGEST.folder: "k"}).chunks(SEGMENTS)
        return store.get(f"chunk-{number}", Value, lambda: (made.append(number), Value(number))[1])

    other = load_config(None, ["segments.pixel_stride=3"])
    assert [chunk(Config(), n) for n in (0, 1, 0)] == [Value(0), Value(1), Value(0)]
    assert made == [0, 1]
    chunk(other, 0)
    assert made == [0, 1, 0]
    chunk(other, 1)
    assert made == [0, 1, 0, 1]


def test_a_full_disk_is_told_and_loses_nothing(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    store = WorkFolder(tmp_path, OWNER, Config(), keys={INGEST.folder: "k"}).chunks(SEGMENTS)
    store.get("chunk-0", Value, lambda: Value(0))

    def full(folder: Path, value: object) -> None:
        (folder / "half").write_text("written")
        raise OSError(errno.ENOSPC, "No space left on device")

    monkeypatch.setattr(chunks_module, "save_value", full)
    with pytest.raises(WorkFolderError, match="disk is full"):
        store.get("chunk-1", Value, lambda: Value(1))
    assert store.has("chunk-0")
    assert not store.has("chunk-1")
    assert not list(store.folder.glob(".*"))


def _hold(folder: Path, ready: "multiprocessing.synchronize.Event") -> None:
    with locked(folder):
        ready.set()
        signal.pause()


def test_a_second_build_is_kept_out_and_told_by_whom_and_a_dead_one_leaves_no_lock(tmp_path: Path) -> None:
    context = multiprocessing.get_context("spawn")
    ready = context.Event()
    holder = context.Process(target=_hold, args=(tmp_path, ready))
    holder.start()
    assert ready.wait(60)
    with pytest.raises(WorkFolderError, match=f"process {holder.pid} on "), locked(tmp_path):
        pass
    assert holder.pid is not None
    os.kill(holder.pid, signal.SIGKILL)
    holder.join()
    with locked(tmp_path) as left_behind:
        assert left_behind is not None
        assert left_behind.pid == holder.pid
    with locked(tmp_path) as left_behind:
        assert left_behind is None


def test_the_fingerprint_follows_the_content_and_not_the_place(tmp_path: Path) -> None:
    prints = []
    for name, depth in (("a", b"123"), ("b", b"123"), ("c", b"124")):
        scan = tmp_path / name
        (scan / "depth").mkdir(parents=True)
        (scan / "depth" / "0.png").write_bytes(depth)
        (scan / "truth.json").write_text(name)
        (scan / "work").mkdir()
        (scan / "work" / "x").write_text(name)
        prints.append(scan_fingerprint(scan, scan / "work"))
    assert prints[0] == prints[1] != prints[2]


def test_the_stages_read_only_what_comes_before_them() -> None:
    for number, stage in enumerate(STAGES):
        assert set(stage.inputs) <= {s.folder for s in STAGES[:number]}
    assert LEAST_SQUARES.name == "least-squares"
