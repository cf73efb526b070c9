"""The back end alone, from a graph to its JSON."""

import json
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from floorplan.config import Config
from floorplan.graph_file import save_graph
from floorplan.solve_graph import solve_graph, solved_to_json
from tests.bench.scenes import Errors, paper_scene
from tests.graphs import graph_along_x, loop_graph

COMMON = {
    "method", "positions", "plane_of_track", "plane_offset_m", "plane_sigma_m", "plane_covariance_m2",
    "hypotheses", "accepted", "objective", "delta", "residual", "seconds",
}  # fmt: skip


def solve_command(*arguments: object) -> subprocess.CompletedProcess[str]:
    command = [sys.executable, "-c", "from floorplan.cli import main; main()", "solve", *map(str, arguments)]
    return subprocess.run(command, capture_output=True, text=True, check=False, timeout=120)


@pytest.mark.parametrize("method", ["paper", "evidence"])
def test_a_scene_is_solved_into_the_promised_json(method: str) -> None:
    scene = paper_scene("area1", 2)
    content = json.loads(solved_to_json(solve_graph(scene.graph, Config(), method)))
    assert set(content) >= COMMON
    assert ("track_offset_m" in content) == (method == "paper")
    planes = len(content["plane_offset_m"])
    assert np.shape(content["positions"]) == (len(scene.graph.stamp_s), 3)
    assert sorted(set(content["plane_of_track"])) == list(range(planes))
    assert np.shape(content["plane_covariance_m2"]) == (planes, planes)
    assert 0 < content["accepted"] <= content["hypotheses"]
    assert isinstance(content["seconds"], float)
    dead_reckoned = np.vstack((np.zeros(3), np.cumsum(scene.graph.translation_m, axis=0)))
    before = np.linalg.norm(dead_reckoned - scene.position_m, axis=1).mean()
    assert 0.001 < np.linalg.norm(np.array(content["positions"]) - scene.position_m, axis=1).mean() < before


@pytest.mark.parametrize("method", ["paper", "evidence"])
def test_flipped_signs_and_outliers_are_survived_and_counted(method: str) -> None:
    scene = paper_scene("area4", 1, Errors(outliers=0.05, flipped=0.005))
    solved = solve_graph(scene.graph, Config(), method)
    assert 5 < solved.rejected_rows < 0.01 * len(scene.graph.frame)
    assert "NaN" not in solved_to_json(solved)


@pytest.mark.parametrize("method", ["paper", "evidence"])
@pytest.mark.parametrize(
    "graph",
    [
        graph_along_x([], [(0, 0, 2.0)], [-1]),
        graph_along_x([0.1], [(0, 0, 2.0), (1, 1, 1.9)], [-1, -1]),
        loop_graph(0, sigma_m=0, drift_m=0)[0],
    ],
    ids=["one row", "two rows that agree", "an exact loop"],
)
def test_small_and_exact_graphs_have_finite_answers(graph: object, method: str) -> None:
    content = json.loads(solved_to_json(solve_graph(graph, Config(), method)))
    assert np.isfinite(content["plane_sigma_m"]).all()
    assert min(content["plane_sigma_m"]) >= 0


def test_covariance_can_be_left_out() -> None:
    solved = solve_graph(loop_graph(1)[0], Config(), "paper", covariance=False)
    assert "plane_covariance_m2" not in json.loads(solved_to_json(solved))


def test_the_command_writes_the_answer_and_refuses_a_bad_graph_and_an_empty_ball(tmp_path: Path) -> None:
    graph, out = tmp_path / "graph.npz", tmp_path / "out.json"
    save_graph(loop_graph(2)[0], graph)
    done = solve_command(graph, "--json", out, "--method", "paper", "--no-covariance")
    assert done.returncode == 0, done.stderr
    assert json.loads(out.read_text("utf-8"))["method"] == "paper"
    assert done.stdout == ""
    bad = solve_command(out, "--json", tmp_path / "never.json")
    assert bad.returncode == 3
    assert "not a layout graph" in bad.stderr
    save_graph(graph_along_x([1.0], [(0, 0, 0.1), (1, 0, 0.1), (0, 1, 1.9), (0, 1, 2.1)], facing=[-1, -1]), graph)
    empty = solve_command(graph, "--json", tmp_path / "never.json", "--method", "paper")
    assert empty.returncode == 4
    assert "merge.eps" in empty.stderr
    assert not (tmp_path / "never.json").exists()
