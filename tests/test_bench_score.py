"""The scoring of plans: a plan copied from the truth is perfect, a plan that is off by a known amount scores that amount."""

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from floorplan.simulate import simulate
from tests.bench.score import score

QUARTER = np.array([[0.0, 1.0], [-1.0, 0.0]])  # the plan's frame is turned and shifted against the building's
SHIFT = np.array([3.0, -7.0])


@pytest.fixture(scope="module")
def scan(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("scan") / "flat"
    simulate(folder, "flat", 2, rate_hz=3.0, image_scale=0.3)
    return folder


def turned(points: Any) -> list[list[float]]:
    return (np.asarray(points, dtype=float) @ QUARTER.T + SHIFT).tolist()


def copied_plan(truth: dict[str, Any], work: Path, *, wall_error_m: float = 0.0, room_growth_m: float = 0.0) -> None:
    """Writes plan.json and trajectory.tum as a builder with perfect knowledge would."""
    walls = []
    for face in truth["faces"]:
        if face["kind"] in ("wall", "column", "jamb"):
            ends = [[face["offset"] + wall_error_m, face["start"]], [face["offset"] + wall_error_m, face["end"]]]
            ends = ends if face["axis"] == 0 else [end[::-1] for end in ends]
            walls.append({"faces": [], "seen": [turned(ends)], "thickness_m": None})
    rooms = []
    for space in truth["spaces"]:
        outline = np.array(space["outline"])
        outline = outline + room_growth_m * np.sign(outline - outline.mean(axis=0))
        holes = [turned(hole) for hole in space["holes"]]
        rooms.append({"outline": turned(outline), "holes": holes, "area_m2": space["area_m2"], "partial": False})
    openings = [
        {
            "kind": "door",
            "centre": turned([o["centre"]])[0],
            "along_axis": 1 - o["along_axis"],
            "width_m": o["width_m"] + 0.01,
            "width_sigma_m": 0.006,
        }
        for o in truth["openings"]
        if o["kind"] == "door"
    ]
    plan = {"walls": walls, "faces": [], "planes": [], "rooms": rooms, "openings": openings, "dimensions": []}
    work.mkdir()
    (work / "plan.json").write_text(json.dumps(plan))
    rows = []
    for stamp, pose in zip(truth["trajectory"]["stamp_ns"], truth["trajectory"]["pose"], strict=True):
        x, y = turned([pose[:2]])[0]
        rows.append(f"{stamp // 10**9}.{stamp % 10**9:09d} {x:.6f} {y:.6f} {pose[2]:.6f} 0 0 0 1")
    (work / "trajectory.tum").write_text("\n".join(rows) + "\n")


def test_a_plan_copied_from_the_truth_is_perfect(scan: Path, tmp_path: Path) -> None:
    copied_plan(json.loads((scan / "truth.json").read_text()), tmp_path / "work")
    result = score(scan, tmp_path / "work")
    assert result["walls"]["precision"]["3cm"] == 1.0
    assert result["walls"]["recall"]["3cm"] == 1.0
    assert result["rooms"]["room_iou"] > 0.9999
    assert result["rooms"]["corridor_iou"] > 0.9999
    assert result["rooms"]["false_rooms"] == 0
    assert result["spans"]["count"] == 300
    assert result["spans"]["missed"] == 0.0
    assert result["spans"]["mean_relative"] < 1e-6
    assert result["doors"]["found"] == 1.0
    assert result["doors"]["walked"] >= 3
    assert result["doors"]["width_error_m"] == pytest.approx(0.01)
    assert result["widths"]["mean_m"] == result["widths"]["rms_m"] == pytest.approx(0.01)
    assert result["widths"]["within_95"] == 1.0
    assert result["trajectory"]["mean_m"] < 1e-5


def test_walls_four_centimetres_off_count_at_five_and_not_at_three(scan: Path, tmp_path: Path) -> None:
    copied_plan(json.loads((scan / "truth.json").read_text()), tmp_path / "work", wall_error_m=0.04)
    walls = score(scan, tmp_path / "work")["walls"]
    assert walls["precision"]["3cm"] < 0.1
    assert walls["precision"]["5cm"] == 1.0
    assert walls["recall"]["3cm"] < 0.1
    assert walls["recall"]["5cm"] == 1.0


def test_rooms_drawn_too_large_lose_their_overlap(scan: Path, tmp_path: Path) -> None:
    copied_plan(json.loads((scan / "truth.json").read_text()), tmp_path / "work", room_growth_m=0.10)
    assert 0.80 < score(scan, tmp_path / "work")["rooms"]["room_iou"] < 0.97
