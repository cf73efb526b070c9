"""Two walks through one simulated building, joined: distances across both scans against the truth."""

import json
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
import pytest

from floorplan.build import Job
from floorplan.build_several import build_several, title_of
from floorplan.config import Config, SeveralConfig
from floorplan.errors import InputError, UsageError
from floorplan.model.checks import Array
from floorplan.results import Results
from floorplan.simulate import simulate
from floorplan.simulate.walk_part import WalkPart
from floorplan.work.folder import part_folders, read_owner
from floorplan.work.stages import STAGES
from tests.bench.score_input import Placement, best_placement, read_tum


@dataclass(frozen=True)
class Joined:
    """Two scans, their joint folder, what was built."""

    scans: list[Path]
    work: Path
    results: Results


def job(work: Path, scans: list[Path]) -> Job:
    return Job(Path(title_of(scans)), work)


@pytest.fixture(scope="module")
def joined(tmp_path_factory: pytest.TempPathFactory) -> Joined:
    """An office walked to its middle, and from its end back to before the middle, by two people."""
    folder = tmp_path_factory.mktemp("several")
    scans = [folder / "ground", folder / "ground-2"]
    for path, part in zip(scans, (WalkPart(0.0, 0.55), WalkPart(1.0, 0.4)), strict=True):
        simulate(path, "office", 1, rate_hz=4.0, image_scale=0.3, walk_part=part)
    results = build_several(job(folder / "both", scans), scans)
    assert results is not None
    return Joined(scans, folder / "both", results)


def truth(scan: Path) -> dict:
    return json.loads((scan / "truth.json").read_text())


def placed(joined: Joined) -> tuple[Placement, list[Array], list[Array]]:
    """Plan to building; the true path of each scan, and the solved one in the building's frame."""
    true = [np.array(truth(scan)["trajectory"]["pose"])[:, :3] for scan in joined.scans]
    got = [read_tum(joined.work / f"trajectory-scan-{k}.tum")[1] for k in (1, 2)]
    placement = best_placement(np.concatenate(got), np.concatenate(true))
    return placement, true, [placement.xy(path[:, :2]) for path in got]


def test_both_trajectories_lie_in_one_frame_to_a_centimetre(joined: Joined) -> None:
    _, true, got = placed(joined)
    off = [path - want[:, :2] for path, want in zip(got, true, strict=True)]
    assert 1e-6 < np.linalg.norm(off[1].mean(axis=0) - off[0].mean(axis=0)) < 0.015
    assert 1e-4 < np.sqrt((np.concatenate(off) ** 2).sum(axis=1).mean()) < 0.02


def test_distances_from_walls_of_one_scan_to_walls_of_the_other_are_right_to_a_centimetre(joined: Joined) -> None:
    results, (placement, _, _) = joined.results, placed(joined)
    true = [(face["axis"], face["facing"], face["offset"]) for face in truth(joined.scans[0])["faces"]]
    graph, second = results.layout.graph, results.scan.parts[1].first_keyframe
    error: dict[tuple[int, str], list[float]] = {}
    for plane in results.plan.planes:
        frames = graph.frame[np.isin(graph.track, plane.tracks)]
        of_both = (frames < second).any() and (frames >= second).any()
        if of_both or plane.axis == 2 or plane.id not in {face.plane for face in results.plan.faces}:
            continue
        axis, sign = placement.axis(plane.axis), placement.rotation[:, plane.axis].sum()
        at = float(placement.vector(plane.axis)[axis] * plane.offset_m + placement.shift_m[axis])
        near = min((o for a, f, o in true if a == axis and f == plane.facing * sign), key=lambda offset: abs(offset - at))
        error.setdefault((axis, "first" if (frames < second).all() else "second"), []).append(at - near)
    across = [a - b for axis in (0, 1) for a in error.get((axis, "first"), []) for b in error.get((axis, "second"), [])]
    assert len(across) >= 4
    assert 1e-6 < np.max(np.abs(across)) < 0.02


def test_the_summary_counts_what_was_walked_and_not_the_leap_between_the_scans(joined: Joined) -> None:
    table = json.loads((joined.work / "summary.json").read_text())
    walked = sum(truth(scan)["path_length_m"] for scan in joined.scans)
    seconds = sum(np.ptp(truth(scan)["trajectory"]["stamp_ns"]) for scan in joined.scans) / 1e9
    assert table["path_length_m"] == pytest.approx(walked, rel=0.05)
    assert table["duration_s"] == pytest.approx(seconds, abs=0.01)


def test_the_joint_plan_holds_the_rooms_of_both_scans(joined: Joined) -> None:
    single = [json.loads((joined.work / f"scan-{k}" / "plan.json").read_text()) for k in (1, 2)]
    areas = [sum(room["area_m2"] for room in plan["rooms"]) for plan in single]
    joint = sum(room.area_m2 for room in joined.results.plan.rooms)
    assert max(areas) + 5.0 < joint < sum(areas)


def test_each_scan_keeps_a_work_folder_of_its_own_and_the_joint_one_says_which_they_are(joined: Joined) -> None:
    owner = read_owner(joined.work)
    assert owner.scan == "ground + ground-2"
    assert owner.scans == tuple(str(scan) for scan in joined.scans)
    assert [read_owner(folder).scan for folder in part_folders(joined.work)] == list(owner.scans)
    assert [part.name for part in joined.results.scan.parts] == ["scan-1 (ground)", "scan-2 (ground-2)"]
    assert "walls)" in joined.results.scan.parts[1].start


def test_a_second_build_makes_nothing_again(joined: Joined) -> None:
    before = {path: path.stat().st_mtime_ns for path in joined.work.rglob("stage.json")}
    assert len(before) == 3 * len(STAGES)
    assert build_several(job(joined.work, joined.scans), joined.scans) is not None
    assert before == {path: path.stat().st_mtime_ns for path in joined.work.rglob("stage.json")}


def test_point_pairs_that_are_not_true_are_refused_with_numbers_and_the_remedy(joined: Joined, tmp_path: Path) -> None:
    (tmp_path / "pairs.csv").write_text("x1,y1,x2,y2\n1,1,1,4\n4,1,4,4\n4,3,4,6\n")
    config = Config(several=SeveralConfig(start=str(tmp_path / "pairs.csv"), start_sha256="new"))
    with pytest.raises(InputError, match=r"scan-2 \(ground-2\): .*--start"):
        build_several(replace(job(joined.work, joined.scans), config=config), joined.scans)


def test_the_same_scan_twice_is_refused(joined: Joined, tmp_path: Path) -> None:
    with pytest.raises(UsageError, match="given twice"):
        build_several(job(tmp_path, joined.scans), [joined.scans[0], joined.scans[0]])
