"""The evidence merge on scenes with truth: pairs, drift, distances, and the traps."""

from dataclasses import dataclass

import numpy as np
import pytest

from floorplan.config import LeastSquaresConfig, MergeConfig, ResolveConfig
from floorplan.least_squares import least_squares
from floorplan.merge import merge
from floorplan.model.graph import LayoutGraph, LayoutSolution, MergeResult, Verdict
from floorplan.resolve import resolve
from tests.block_scenes import Scene, SceneSettings, Score, make_scene, score


@dataclass(frozen=True)
class Outcome:
    merged: MergeResult
    solution: LayoutSolution
    score: Score


def solve(scene: Scene) -> Outcome:
    merged = merge(scene.graph, least_squares(scene.graph, LeastSquaresConfig()), MergeConfig(method="evidence"))
    solution = resolve(scene.graph, merged, ResolveConfig())
    offset = solution.plane_offset_m[solution.plane_of_track]
    return Outcome(merged, solution, score(scene, solution.plane_of_track, offset, solution.position_m))


@pytest.mark.parametrize(
    ("seed", "settings"),
    [
        (0, SceneSettings()),
        (3, SceneSettings()),
        (12, SceneSettings(scale_sigma=0.05, sideways_sigma=0.03)),
        (11, SceneSettings(depth_sigma_m=0.03, outliers=0.05, flipped=0.005, bias_sigma_m=0.012)),
    ],
)
def test_right_pairs_are_merged_and_drift_goes(seed: int, settings: SceneSettings) -> None:
    outcome = solve(make_scene(seed, settings))
    assert outcome.score.precision >= 0.97
    assert outcome.score.recall >= 0.97
    assert abs(outcome.score.plane_error) <= 2
    assert outcome.score.drift_m < 0.15
    hypotheses = outcome.merged.hypotheses
    assert hypotheses.accepted.sum() > 300
    assert np.isfinite(hypotheses.sigma_m).all()
    same = outcome.merged.plane_of_track[hypotheses.first] == outcome.merged.plane_of_track[hypotheses.second]
    assert (same == hypotheses.accepted).all()


def walk_past(walls: list[tuple[float, int, int]], frames: int, rate: float, seed: int) -> LayoutGraph:
    """A straight walk of 0.1 m steps along y past walls facing -x: (offset, first frame, last frame), one track each."""
    rng = np.random.default_rng(seed)
    t = np.zeros((frames - 1, 3))
    t[:, 1] = 0.1
    t[:, :2] += rng.normal(0, rate * np.sqrt(0.1), (frames - 1, 2))
    rows = [(f, j, offset) for j, (offset, start, stop) in enumerate(walls) for f in range(start, stop)]
    frame, track, offset = (np.array(column) for column in zip(*rows, strict=True))
    extent = np.full((len(walls), 3, 2), np.nan)
    for j, (place, start, stop) in enumerate(walls):
        extent[j] = ((place, place), (0.1 * start, 0.1 * stop), (-1.0, 1.0))
    distance = offset + rng.normal(0, 0.005, len(rows))
    axis, facing = np.zeros(len(walls), dtype=int), -np.ones(len(walls), dtype=int)
    return LayoutGraph(np.arange(frames) / 10, t, frame, track, distance, axis, facing, extent)


def merged_planes(graph: LayoutGraph) -> MergeResult:
    return merge(graph, least_squares(graph, LeastSquaresConfig()), MergeConfig(method="evidence"))


def test_two_parallel_planes_of_one_frame_stay_apart() -> None:
    graph = walk_past([(2.0, 0, 60), (2.15, 30, 90), (2.0, 70, 120), (2.15, 100, 150)], 150, 0.005, seed=1)
    merged = merged_planes(graph)
    assert merged.plane_of_track.tolist() == [0, 1, 0, 1]
    hypotheses = merged.hypotheses
    pair = np.flatnonzero((hypotheses.first == 0) & (hypotheses.second == 1))
    if len(pair):
        assert hypotheses.verdict[pair[0]] in (Verdict.SEEN_APART, Verdict.BEYOND_COVARIANCE)


def test_walls_5_cm_apart_at_opposite_ends_stay_apart_and_pieces_of_one_wall_are_joined() -> None:
    steady = [(1.2, k, k + 80) for k in range(0, 560, 60)]
    apart = merged_planes(walk_past([(3.0, 0, 50), (3.05, 550, 600), *steady], 640, 0.002, seed=2)).plane_of_track
    assert apart[0] != apart[1]
    joined = merged_planes(walk_past([(3.0, 0, 50), (3.0, 65, 120), *steady], 640, 0.002, seed=3)).plane_of_track
    assert joined[0] == joined[1]
