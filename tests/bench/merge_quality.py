r"""The default method's bars on paper-size scenes of any seeds: merges, drift, wall-to-wall distances, calibration, seconds.

    OMP_NUM_THREADS=1 OPENBLAS_NUM_THREADS=1 NUMBA_NUM_THREADS=1 python -m tests.bench.merge_quality \
        --seeds 101 102 [--hard] [--scenes area1 area6]

Beside the default stands what the same re-solve makes of the true merges: what is left is not the merging's fault. Drift is told
twice: as it is, and along the axes on which the walk's start is seen again at its end (a true plane in the first and the last
metre); along the others there is nothing to take it out with.
"""

import argparse
import sys
import time
from dataclasses import dataclass

import numpy as np

from floorplan.config import LeastSquaresConfig, MergeConfig, ResolveConfig
from floorplan.least_squares import least_squares
from floorplan.merge import merge
from floorplan.model.graph import LayoutSolution
from floorplan.model.noise import ScanNoise
from floorplan.resolve import resolve
from floorplan.weighted_resolve import weighted_resolve
from tests.bench.back_end import agreement
from tests.bench.scenes import PAPER_SCENES, Errors, Scene, paper_scene

HARD = Errors(sigma_m=0.03, sigma_per_m=0.006, outliers=0.05, flipped=0.005, track_bias_m=0.012)
WITHIN_95 = 1.96  # standard deviations
SAME_ROOM_M = 8.0  # distances up to here are those of one room, beyond are long ones
END_FRAMES = 10  # a metre of walk
MOST_TRACKS = 400  # of one axis, for the mean wall-to-wall error


@dataclass(frozen=True)
class Solved:
    """How well one way of merging did: precision and recall of pairs of tracks, planes too many, drift (and along axes on which the

    start is seen again) and mean wall-to-wall error, the standardised errors of plane-to-plane distances, of one room (or near) and long.
    """

    precision: float
    recall: float
    planes: int
    drift_m: float
    seen_drift_m: float
    wall_to_wall_m: float
    near: np.ndarray
    far: np.ndarray


@dataclass(frozen=True)
class Quality:
    """One scene: the default method, the true merges under the same noise model, the drift of plain least squares (and along axes on

    which the start is seen again), the noise found, processor seconds."""

    found: Solved
    truth: Solved
    plain_drift_m: float
    plain_seen_drift_m: float
    noise: ScanNoise
    seconds: float


def quality(scene: Scene) -> Quality:
    """Run the default back end and the re-solve with true merges on one scene."""
    graph, start = scene.graph, time.process_time()
    solution = least_squares(graph, LeastSquaresConfig())
    merged = merge(graph, solution, MergeConfig())
    if merged.noise is None:
        raise ValueError("the default method weights its rows")
    resolved = resolve(graph, merged, ResolveConfig())
    taken = time.process_time() - start
    true = np.unique(scene.plane_of_track, return_inverse=True)[1]
    plain = _drift(scene, least_squares(graph, LeastSquaresConfig("plain")).position_m)
    found, truth = judge(scene, resolved), judge(scene, weighted_resolve(graph, true, merged.noise))
    return Quality(found, truth, plain.all_m, plain.seen_m, merged.noise, taken)


@dataclass(frozen=True)
class Drift:
    """How far the end of a walk is from where it was, in all and along the axes on which its start is seen again."""

    all_m: float
    seen_m: float


def _drift(scene: Scene, position_m: np.ndarray) -> Drift:
    error = (position_m - scene.position_m)[-1]
    return Drift(float(np.linalg.norm(error)), float(np.linalg.norm(error[axes_seen_again(scene)])))


def axes_seen_again(scene: Scene) -> np.ndarray:
    """Whether a true plane of each axis (3,) is seen in the first and in the last END_FRAMES frames."""
    graph, last = scene.graph, len(scene.graph.stamp_s) - END_FRAMES
    plane = scene.plane_of_track[graph.track]
    both = np.intersect1d(plane[graph.frame < END_FRAMES], plane[graph.frame >= last])
    return np.isin(np.arange(3), scene.planes.axis[both])


def judge(scene: Scene, solution: LayoutSolution) -> Solved:
    """One solution against the scene's truth."""
    precision, recall = agreement(solution.plane_of_track, scene.plane_of_track)
    planes = len(solution.plane_axis) - len(np.unique(scene.plane_of_track))
    drift = _drift(scene, solution.position_m)
    true = scene.planes.offset_m[scene.plane_of_track]
    apart = [_differences(solution.plane_offset_m[solution.plane_of_track] - true, scene.graph.axis == axis) for axis in range(3)]
    near, far = _standardised(solution, true)
    return Solved(precision, recall, planes, drift.all_m, drift.seen_m, float(np.concatenate(apart).mean()), near, far)


def _differences(error_m: np.ndarray, mine: np.ndarray) -> np.ndarray:
    mine = np.flatnonzero(mine)
    mine = mine[:: len(mine) // MOST_TRACKS + 1]
    return np.abs(error_m[mine][:, None] - error_m[mine][None, :]).ravel()


def _standardised(solution: LayoutSolution, true_m: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Errors over their standard deviations of every distance between two planes of one axis: near ones, long ones."""
    count = len(solution.plane_axis)
    true = np.array([np.median(true_m[solution.plane_of_track == k]) for k in range(count)])
    error, covariance = solution.plane_offset_m - true, solution.plane_covariance_m2
    if covariance is None:
        raise ValueError("calibration needs the covariance")
    a, b = np.nonzero(np.triu(solution.plane_axis[:, None] == solution.plane_axis[None, :], 1))
    z = (error[a] - error[b]) / np.sqrt(covariance[a, a] + covariance[b, b] - 2 * covariance[a, b])
    near = np.abs(true[a] - true[b]) <= SAME_ROOM_M
    return z[near], z[~near]


def _line(name: str, seed: int, q: Quality) -> str:
    f, t = q.found, q.truth
    return (
        f"{name} {seed} precision {f.precision:.3f} recall {f.recall:.3f} planes {f.planes:+d} "
        f"drift {f.drift_m:.3f} ({t.drift_m:.3f}, plain {q.plain_drift_m:.3f}) "
        f"seen again {f.seen_drift_m:.3f} ({t.seen_drift_m:.3f}, plain {q.plain_seen_drift_m:.3f}) "
        f"w2w {f.wall_to_wall_m:.4f} ({t.wall_to_wall_m:.4f}) within95 near {_share(f.near)} ({_share(t.near)}) far {_share(f.far)} "
        f"({_share(t.far)}) bias {q.noise.bias_sigma_m:.4f} seconds {q.seconds:.2f}\n"
    )


def _share(standardised: np.ndarray) -> str:
    return f"{np.mean(np.abs(standardised) < WITHIN_95):.3f}" if len(standardised) else "-"


def summary(results: list[Quality]) -> str:
    """The bars of the default method over all results."""
    found, truth = [q.found for q in results], [q.truth for q in results]
    precision, recall = np.array([f.precision for f in found]), np.array([f.recall for f in found])
    drift, true_drift = np.array([f.drift_m for f in found]), np.array([t.drift_m for t in truth])
    ratio = np.mean([f.wall_to_wall_m for f in found]) / np.mean([t.wall_to_wall_m for t in truth])
    near, far = (np.concatenate([getattr(f, side) for f in found]) for side in ("near", "far"))
    true_near, true_far = (np.concatenate([getattr(t, side) for t in truth]) for side in ("near", "far"))
    plain, excess = np.array([q.plain_drift_m for q in results]), drift - true_drift
    seen, true_seen = np.array([f.seen_drift_m for f in found]), np.array([t.seen_drift_m for t in truth])
    plain_seen = np.array([q.plain_seen_drift_m for q in results])
    return (
        f"{len(results)} scenes: precision mean {precision.mean():.3f} min {precision.min():.3f}, recall mean {recall.mean():.3f} "
        f"min {recall.min():.3f}, plane count error {np.abs([f.planes for f in found]).mean():.2f}\n"
        f"drift mean {drift.mean():.3f} worst {drift.max():.3f} m, over true merges {drift.mean() / true_drift.mean():.2f}, "
        f"over plain least squares {drift.mean() / plain.mean():.2f} (true merges {true_drift.mean() / plain.mean():.2f}); "
        f"worst of true merges {true_drift.max():.3f}, most beyond them {excess.max():.3f} m\n"
        f"along axes on which the start is seen again: mean {seen.mean():.3f} worst {seen.max():.3f} m, over true merges "
        f"{seen.mean() / true_seen.mean():.2f}, over plain least squares {seen.mean() / plain_seen.mean():.2f}; "
        f"wall to wall over true merges {ratio:.3f}\n"
        f"95 % intervals: up to {SAME_ROOM_M:.0f} m {_share(near)}, beyond {_share(far)} "
        f"(true merges {_share(true_near)}, {_share(true_far)})\n"
        f"processor seconds, median {np.median([q.seconds for q in results]):.3f}\n"
    )


def main() -> None:
    """Print one line per scene and seed, then the bars."""
    names = [spec.name for spec in PAPER_SCENES]
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--seeds", type=int, nargs="+", default=[101])
    parser.add_argument("--scenes", nargs="+", choices=names, default=names)
    parser.add_argument("--hard", action="store_true", help="3 x depth noise, 5 %% outliers, 0.5 %% flipped signs, 1.2 cm bias per track")
    asked = parser.parse_args()
    quality(paper_scene(names[0], 0))
    results = []
    for seed in asked.seeds:
        for name in asked.scenes:
            results.append(quality(paper_scene(name, seed, HARD if asked.hard else None)))
            sys.stdout.write(_line(name, seed, results[-1]))
            sys.stdout.flush()
    sys.stdout.write(summary(results))


if __name__ == "__main__":
    main()
