"""A whole build of a small simulated scan: what it leaves, what it keeps, and what a kill costs."""

import json
import multiprocessing
import os
import shutil
import signal
import time
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from floorplan.build import Job, build
from floorplan.config import Config, DrawingConfig
from floorplan.config_file import load_config
from floorplan.corrections import with_edits, with_laser
from floorplan.drawings import Drawing
from floorplan.errors import ConfigError, WorkFolderError
from floorplan.export import export, export_graph, read_merges, read_results
from floorplan.graph_file import load_graph
from floorplan.reporting import SilentReporter
from floorplan.simulate import simulate
from floorplan.solve_graph import solve_graph
from floorplan.work.folder import read_owner
from floorplan.work.stages import LEAST_SQUARES, MERGE, PLAN, RESOLVE, SEGMENTS, STAGES
from floorplan.work.status import stages_status

ROOT_FILES = {
    "plan.json",
    "summary.json",
    "trajectory.tum",
    "trajectory-odometry.tum",
    "trajectory-compass.tum",
    "trajectory-least-squares.tum",
    "config.toml",
    "ids.json",
    "work.json",
}


@pytest.fixture(scope="module")
def scan(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A flat walked at 4 frames a second with small images."""
    folder = tmp_path_factory.mktemp("scan") / "flat"
    simulate(folder, "flat", 1, rate_hz=4.0, image_scale=0.3)
    return folder


@pytest.fixture(scope="module")
def work(scan: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Its finished work folder."""
    folder = tmp_path_factory.mktemp("work") / "flat"
    assert build(Job(scan, folder)) is not None
    return folder


def made_bytes(work: Path) -> dict[str, bytes]:
    """Everything that must not depend on when, how often and in how many steps it was made."""
    values = [path for stage in STAGES for path in sorted((work / stage.folder).glob("value.*"))]
    return {path.relative_to(work).as_posix(): path.read_bytes() for path in [*values, *sorted(work.glob("*.tum")), work / "plan.json"]}


def test_the_root_holds_what_is_promised_and_nothing_half_made(work: Path) -> None:
    names = {path.name for path in work.iterdir()}
    assert names - {".lock"} == ROOT_FILES | {stage.folder for stage in STAGES}


def test_the_trajectory_has_every_frame_and_is_near_the_truth(scan: Path, work: Path) -> None:
    truth = json.loads((scan / "truth.json").read_text())["trajectory"]
    true_xy = np.array(truth["pose"])[:, :2]
    errors = {}
    for name in ("trajectory", "trajectory-least-squares", "trajectory-odometry"):
        table = np.loadtxt(work / f"{name}.tum")
        assert len(table) == len(true_xy)
        errors[name] = rigid_error_m(table[:, 1:3], true_xy)
    first = (work / "trajectory.tum").read_text().splitlines()[1].split()[0]
    assert int(first.replace(".", "")) == truth["stamp_ns"][0]
    assert 0.0005 < errors["trajectory"] < 0.1  # the published merge joins planes up to 30 cm apart
    assert 0.0005 < errors["trajectory-least-squares"] < errors["trajectory-odometry"]


def rigid_error_m(points: np.ndarray, truth: np.ndarray) -> float:
    """RMS distance after the best rotation and shift in the plane."""
    a, b = points - points.mean(0), truth - truth.mean(0)
    u, _, vt = np.linalg.svd(a.T @ b)
    turn = u @ np.diag([1.0, np.sign(np.linalg.det(u @ vt))]) @ vt
    return float(np.sqrt(((a @ turn - b) ** 2).sum(1).mean()))


def test_the_summary_has_the_rows_of_the_papers_table(work: Path) -> None:
    table = json.loads((work / "summary.json").read_text())
    assert table["frames"] >= table["keyframes"] > 100
    assert table["initial_planes"] > table["final_planes"] > 10
    assert table["hypotheses_considered"] >= table["hypotheses_accepted"] > 0
    assert 0 < table["drift"]["final_m"] < table["drift"]["odometry_m"] < 2
    assert set(table["seconds"]) == {stage.folder for stage in STAGES}


def test_a_second_build_makes_nothing_and_leaves_the_same_bytes(scan: Path, work: Path) -> None:
    before = made_bytes(work)
    records = {stage.folder: (work / stage.folder / "stage.json").read_bytes() for stage in STAGES}
    build(Job(scan, work))
    assert made_bytes(work) == before
    assert {stage.folder: (work / stage.folder / "stage.json").read_bytes() for stage in STAGES} == records


def test_root_files_are_left_alone_while_they_are_right_and_remade_when_one_is_missing(scan: Path, work: Path) -> None:
    before, times = made_bytes(work), {name: (work / name).stat().st_mtime_ns for name in ROOT_FILES - {"work.json", "config.toml"}}
    build(Job(scan, work))
    assert {name: (work / name).stat().st_mtime_ns for name in times} == times
    (work / "trajectory-compass.tum").unlink()
    build(Job(scan, work))
    assert made_bytes(work) == before
    (work / "plan.json").write_text("of another build")
    build(Job(scan, work, load_config(None, ["ingest.returns_to_start=false"])))
    assert made_bytes(work) == before
    assert json.loads((work / "summary.json").read_text())["drift"] is None
    build(Job(scan, work))
    assert json.loads((work / "summary.json").read_text())["drift"] is not None


def test_the_published_merge_alone_gives_the_published_least_squares_row(scan: Path, work: Path, tmp_path: Path) -> None:
    rows = []
    for settings in (["merge.method=paper"], ["merge.method=paper", "least_squares.method=plain"]):
        folder = tmp_path / str(len(settings))
        shutil.copytree(work, folder)
        assert build(Job(scan, folder, load_config(None, settings))) is not None
        rows.append((folder / "trajectory-least-squares.tum").read_bytes())
        assert all(row.distance_m == pytest.approx(row.first.offset_m - row.second.offset_m, abs=1e-9) for row in read_merges(folder))
    assert rows[0] == rows[1]
    assert rows[0] != (work / "trajectory-least-squares.tum").read_bytes()


def test_more_jobs_and_stops_on_the_way_give_the_same_bytes(scan: Path, work: Path, tmp_path: Path) -> None:
    job = Job(scan, tmp_path / "work", jobs=2)
    assert build(replace(job, until=SEGMENTS)) is None
    assert not (job.work / "3-least-squares").exists()
    assert build(replace(job, until=RESOLVE)) is None
    assert not (job.work / "plan.json").exists()
    build(job)
    assert made_bytes(job.work) == made_bytes(work)


def _build_in_child(scan: Path, work: Path) -> None:
    build(Job(scan, work))


def test_a_build_killed_inside_the_slow_stage_goes_on_and_gives_the_same_bytes(scan: Path, work: Path, tmp_path: Path) -> None:
    killed = tmp_path / "work"
    child = multiprocessing.get_context("spawn").Process(target=_build_in_child, args=(scan, killed))
    child.start()
    chunk = killed / "2-segments.partial" / "chunk-00002"
    while not chunk.exists() and child.is_alive():
        time.sleep(0.002)
    assert child.pid is not None
    os.kill(child.pid, signal.SIGKILL)
    child.join()
    assert not (killed / "3-least-squares").exists()
    kept = chunk.stat().st_mtime_ns if chunk.exists() else None
    build(Job(scan, killed))
    assert kept is not None
    assert made_bytes(killed) == made_bytes(work)
    assert not (killed / "2-segments.partial").exists()


def test_another_scan_is_refused_a_used_work_folder(scan: Path, work: Path, tmp_path: Path) -> None:
    other = tmp_path / "other"
    shutil.copytree(scan, other)
    build(Job(other, work))  # the same files elsewhere: the same scan
    lines = (other / "odometry.txt").read_text().splitlines()
    (other / "odometry.txt").write_text("\n".join(lines[:-1]) + "\n")
    build(Job(scan, work))
    with pytest.raises(WorkFolderError, match="another scan"):
        build(Job(other, work))


def test_drawings_are_made_again_when_the_plan_the_sheet_or_the_file_changed_and_only_then(scan: Path, work: Path, tmp_path: Path) -> None:
    folder, path = tmp_path / "work", tmp_path / "plan.svg"
    shutil.copytree(work, folder)
    job = Job(scan, folder, drawings=(Drawing("svg", path),))
    build(job)
    first, made = path.read_bytes(), path.stat().st_mtime_ns
    build(job)
    assert path.stat().st_mtime_ns == made  # left alone
    path.write_bytes(b"spoilt")
    build(job)
    assert path.read_bytes() == first
    build(replace(job, config=load_config(None, ["drawing.sheet=A2"])))
    assert path.read_bytes() != first
    build(job)
    assert path.read_bytes() == first
    path.unlink()
    build(job)
    assert path.read_bytes() == first


def test_a_drawing_setting_makes_no_stage_again(scan: Path, work: Path) -> None:
    record = (work / "1-ingest" / "stage.json").stat().st_mtime_ns, (work / "6-plan" / "stage.json").stat().st_mtime_ns
    build(Job(scan, work, load_config(None, ["drawing.units=mm", "project.name=Flat"])))
    assert ((work / "1-ingest" / "stage.json").stat().st_mtime_ns, (work / "6-plan" / "stage.json").stat().st_mtime_ns) == record
    build(Job(scan, work, Config()))


def test_the_layout_graph_is_exported_before_and_after_solving_and_has_the_builds_planes(scan: Path, work: Path, tmp_path: Path) -> None:
    early = tmp_path / "work"
    early.mkdir()
    for kept in ("work.json", "config.toml"):
        shutil.copy(work / kept, early)
    for stage in STAGES[:2]:
        shutil.copytree(work / stage.folder, early / stage.folder)
    graphs = []
    for folder in (early, work):
        export_graph(folder, Config(), tmp_path / "graph.npz")
        graphs.append(load_graph(tmp_path / "graph.npz"))
    assert len(graphs[1].axis) == len(read_results(work).layout.tracks.axis)
    for name in ("stamp_s", "translation_m", "frame", "track", "distance_m", "axis", "facing", "extent_m", "sigma_m"):
        np.testing.assert_array_equal(getattr(graphs[0], name), getattr(graphs[1], name))
    # `floorplan solve` on the graph of the segments gives the planes of the whole build, and how well they are known.
    alone, built = solve_graph(graphs[0], Config()).solution, read_results(work).solution
    for name in ("plane_of_track", "plane_axis", "plane_facing"):
        np.testing.assert_array_equal(getattr(alone, name), getattr(built, name))
    for name in ("plane_offset_m", "plane_sigma_m", "position_m"):
        np.testing.assert_allclose(getattr(alone, name), getattr(built, name), rtol=0, atol=1e-6)
    assert np.ptp(built.plane_offset_m) > 5.0


def test_every_hypothesis_is_listed_with_the_frames_that_saw_both_sides(work: Path) -> None:
    results, rows = read_results(work), read_merges(work)
    assert len(rows) == len(results.merged.hypotheses)
    assert sum(row.accepted for row in rows) == int(results.merged.hypotheses.accepted.sum()) > 0
    assert all((row.plane[0] == row.plane[1]) for row in rows if row.accepted)
    assert all(row.distance_m == pytest.approx(row.first.offset_m - row.second.offset_m, abs=1e-9) for row in rows)
    graph, keyframe = results.layout.graph, results.scan.keyframe
    for row in rows[:20]:
        sides = [set(keyframe[graph.frame[graph.track == side.track]].tolist()) for side in (row.first, row.second)]
        assert set(row.frames_of_both) == sides[0] & sides[1]
        assert (row.first.first_frame, row.first.last_frame, row.first.keyframes) == (min(sides[0]), max(sides[0]), len(sides[0]))


def test_finished_stages_are_read_back_whole(work: Path) -> None:
    results = read_results(work)
    count = len(results.solution.plane_axis)
    assert all(plane.tracks for plane in results.plan.planes[:count])
    drawn = {face.plane for face in results.plan.faces}
    assert all(not plane.tracks and plane.id in drawn for plane in results.plan.planes[count:])
    assert len(results.segmented.frames.measured) == len(results.scan.keyframe)


def test_distances_by_tape_calibrate_the_plan_and_leave_no_trace_when_withdrawn(scan: Path, work: Path, tmp_path: Path) -> None:
    folder = tmp_path / "flat"
    shutil.copytree(work, folder)
    before = made_bytes(folder)
    plain = json.loads((folder / "plan.json").read_text())
    spans = {d["id"]: d for d in plain["dimensions"] if d["axis"] != 2}
    laser = tmp_path / "laser.csv"
    laser.write_text("id,measured_m\n" + "".join(f"{id},{1.01 * d['distance_m']:.4f}\n" for id, d in list(spans.items())[:4]), "utf-8")
    assert build(Job(scan, folder, with_laser(Config(), laser))) is not None
    plan = json.loads((folder / "plan.json").read_text())
    ratios = [d["distance_m"] / spans[d["id"]]["distance_m"] for d in plan["dimensions"] if d["id"] in spans]
    assert len(ratios) >= len(spans) - 1
    assert max(abs(ratio - 1.01) for ratio in ratios) < 0.004
    assert plan["shift_m"][:2] == plain["shift_m"][:2]
    assert build(Job(scan, folder)) is not None
    assert made_bytes(folder) == before


def test_a_wrong_merge_forced_by_hand_shows_and_leaves_no_trace_when_undone(scan: Path, work: Path, tmp_path: Path) -> None:
    folder = tmp_path / "flat"
    shutil.copytree(work, folder)
    before = made_bytes(folder)
    plain = json.loads((folder / "plan.json").read_text())
    planes = sorted((p for p in plain["planes"] if p["axis"] == 0 and p["facing"] == 1), key=lambda p: -p["frames"])[:2]
    room = plain["rooms"][0]["id"]
    edits = tmp_path / "edits.toml"
    pair = f"[[always_merge]]\ntracks = [{planes[0]['tracks'][0]}, {planes[1]['tracks'][0]}]\n"
    edits.write_text(pair + f'[[room]]\nid = "{room}"\nname = "Kitchen"\n[[delete]]\nid = "W999"\n', "utf-8")
    results = build(Job(scan, folder, with_edits(Config(), edits)))
    assert results is not None
    notes = " ".join(results.plan.notes)
    assert "Edited by hand: always_merge" in notes
    assert "Edit not applied: delete W999" in notes
    assert len(results.solution.plane_axis) == sum(bool(plane["tracks"]) for plane in plain["planes"]) - 1
    assert "Kitchen" in {one.name for one in results.plan.rooms} or "Edit not applied: room" in notes
    shared = {d["id"]: d["distance_m"] for d in plain["dimensions"]}
    moved = [abs(d.distance_m - shared[d.id]) for d in results.plan.dimensions if d.id in shared]
    assert len(moved) < len(shared) or max(moved) > 0.02
    assert build(Job(scan, folder)) is not None
    assert made_bytes(folder) == before


def test_what_from_asked_for_again_is_not_forgotten_when_interrupted(scan: Path, work: Path, tmp_path: Path) -> None:
    copy = tmp_path / "work"
    shutil.copytree(work, copy)
    build(Job(scan, copy, redo_from=MERGE, until=MERGE))  # as if interrupted after the merge
    states = {state.folder: state.state for state in stages_status(copy, Config(), read_owner(copy))}
    assert [states[stage.folder] for stage in (LEAST_SQUARES, MERGE, RESOLVE, PLAN)] == ["kept", "kept", "missing", "missing"]
    assert build(Job(scan, copy)) is not None
    assert made_bytes(copy) == made_bytes(work)


def test_a_sheet_that_cannot_hold_the_walk_is_refused_before_anything_is_computed(scan: Path, tmp_path: Path) -> None:
    config = Config(drawing=DrawingConfig(scale="1:5", sheet="A4"))
    with pytest.raises(ConfigError, match="walked path alone"):
        build(Job(scan, tmp_path / "work", config, drawings=(Drawing("svg", tmp_path / "plan.svg"),)))
    assert not (tmp_path / "work").exists()


def test_an_export_says_in_one_line_which_stages_are_stale(work: Path, tmp_path: Path) -> None:
    heard: list[str] = []

    class Listener(SilentReporter):
        def message(self, text: str) -> None:
            heard.append(text)

    other = replace(Config(), ingest=replace(Config().ingest, keyframe_distance_m=0.31))
    export(work, other, (Drawing("json", tmp_path / "plan.json"),), Listener())
    stale = [text for text in heard if "stale" in text]
    assert len(stale) == 1
    assert "1-ingest is stale" in stale[0]
    assert "and 5 more stages" in stale[0]
