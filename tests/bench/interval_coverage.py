"""How often the 95 % interval of a plane-to-plane distance contains the truth, in whole builds of simulated scans.

    python -m tests.bench.interval_coverage SCAN WORK [SCAN WORK ...]

WORK holds the stages up to least squares; least squares, merge and re-solve are done again here. A final plane is compared with the true
plane that most of its rows lie on, told by the true poses. "Same room": up to 8 m and seen together in some frame. The path's error is that
of the keyframes' positions once both paths have one mean. `--exact-sensor`: the depth has no scale error and no bias, for scans simulated
before recordings said so.
"""

import argparse
import json
import sys
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from floorplan.config import LeastSquaresConfig, MergeConfig, ResolveConfig
from floorplan.least_squares import least_squares
from floorplan.merge import merge
from floorplan.model.graph import LayoutGraph, LayoutSolution
from floorplan.model.scan import IngestedScan, RangeAccuracy
from floorplan.noise.range_accuracy import range_accuracy
from floorplan.resolve import resolve
from floorplan.work.npz import read_npz
from floorplan.work.values import decode, load_value

WITHIN_95 = 1.96
SAME_ROOM_M = 8.0
NEAREST_M = 0.15  # a track whose rows lie further from every true plane saw something else (a cabinet, a door leaf)
FEWEST_ROWS = 5


@dataclass(frozen=True)
class Truth:
    """True positions (N, 3) of the keyframes, and planes, in the solution's directions: `axis (P,)`, `facing (P,)`, `offset_m (P,)`."""

    position_m: np.ndarray
    axis: np.ndarray
    facing: np.ndarray
    offset_m: np.ndarray


def truth_of(scan: Path, ingested: IngestedScan, solution: LayoutSolution) -> Truth:
    """truth.json turned by the quarter turn that brings it to the solution."""
    data = json.loads((scan / "truth.json").read_text("utf-8"))
    stamp = np.array(data["trajectory"]["stamp_ns"])
    mine = ingested.recording.stamp_ns[ingested.keyframe]
    pose = np.array(data["trajectory"]["pose"])[:, :3]
    place = np.stack([np.interp(mine, stamp, pose[:, k]) for k in range(3)], axis=1)
    turn = best_quarter_turn(place, solution.position_m)
    planes = data["planes"]
    normal = np.zeros((len(planes), 3))
    normal[np.arange(len(planes)), [p["axis"] for p in planes]] = 1.0
    turned = normal @ turn.T
    axis = np.abs(turned).argmax(axis=1)
    sign = turned[np.arange(len(planes)), axis]
    facing, offset = (np.array([p[name] for p in planes]) * sign for name in ("facing", "offset"))
    return Truth(place @ turn.T, axis, facing.round().astype(int), offset)


def best_quarter_turn(true_m: np.ndarray, found_m: np.ndarray) -> np.ndarray:
    """Rotation (3, 3) by a multiple of 90 degrees about z that fits best."""
    turns = [np.array([[c, -s, 0], [s, c, 0], [0, 0, 1.0]]) for c, s in ((1, 0), (0, 1), (-1, 0), (0, -1))]
    a, b = true_m - true_m.mean(axis=0), found_m - found_m.mean(axis=0)
    return min(turns, key=lambda turn: float(np.linalg.norm(a @ turn.T - b)))


def true_offsets(graph: LayoutGraph, solution: LayoutSolution, truth: Truth) -> np.ndarray:
    """True offset (L,) of every final plane, NaN where it is none of the true planes."""
    level = graph.distance_m + truth.position_m[graph.frame, graph.axis[graph.track]]
    plane = solution.plane_of_track[graph.track]
    result = np.full(len(solution.plane_axis), np.nan)
    for k in range(len(result)):
        rows = level[plane == k]
        same = np.flatnonzero((truth.axis == solution.plane_axis[k]) & (truth.facing == solution.plane_facing[k]))
        if len(rows) < FEWEST_ROWS or len(same) == 0:
            continue
        nearest = truth.offset_m[same[np.abs(truth.offset_m[same] - np.median(rows)).argmin()]]
        if abs(nearest - np.median(rows)) < NEAREST_M:
            result[k] = nearest
    return result


def seen_together(graph: LayoutGraph, solution: LayoutSolution) -> np.ndarray:
    """Whether any frame saw both planes (L, L)."""
    saw = np.zeros((len(graph.stamp_s), len(solution.plane_axis)))
    saw[graph.frame, solution.plane_of_track[graph.track]] = 1.0
    return np.asarray(saw.T @ saw > 0)


def stored_graph(stage: Path) -> LayoutGraph:
    """The layout graph of a work folder, of this version or an earlier one."""
    tree = json.loads((stage / "value.json").read_text("utf-8"))
    graph: LayoutGraph = decode(LayoutGraph, tree["graph"], read_npz(stage / "value.npz"))
    return graph


def coverage(scan: Path, work: Path, exact_sensor: bool = False) -> str:
    """One line: shares within the interval, of one room, near, and long, and the size of the errors."""
    graph = stored_graph(work / "3-least-squares")
    ingested = load_value(work / "1-ingest", IngestedScan)
    if graph.range_accuracy is None:
        graph = replace(graph, range_accuracy=range_accuracy(ingested.recording.sensor))
    if exact_sensor:
        graph = replace(graph, range_accuracy=RangeAccuracy(0.0, 0.0))
    merged = merge(graph, least_squares(graph, LeastSquaresConfig()), MergeConfig())
    solution = resolve(graph, merged, ResolveConfig())
    place = truth_of(scan, ingested, solution)
    true = true_offsets(graph, solution, place)
    error, covariance = solution.plane_offset_m - true, solution.plane_covariance_m2
    known = np.isfinite(true)
    a, b = np.nonzero(np.triu((solution.plane_axis[:, None] == solution.plane_axis[None, :]) & known[:, None] & known[None, :], 1))
    if covariance is None or len(a) == 0:
        return f"{work.name}: nothing to compare"
    wrong, sigma = error[a] - error[b], np.sqrt(covariance[a, a] + covariance[b, b] - 2 * covariance[a, b])
    span_m = np.abs(true[a] - true[b])
    room = seen_together(graph, solution)[a, b] & (span_m <= SAME_ROOM_M)
    kinds = (("same room", room), (f"up to {SAME_ROOM_M:.0f} m", ~room & (span_m <= SAME_ROOM_M)), ("beyond", span_m > SAME_ROOM_M))
    parts = [
        f"{name} {np.mean(np.abs(wrong[some] / sigma[some]) < WITHIN_95):.3f} of {some.sum()} (error {np.median(np.abs(wrong[some])):.4f} "
        f"sigma {np.median(sigma[some]):.4f})"
        for name, some in kinds
        if some.any()
    ]
    return f"{work.name}: planes {known.sum()} of {len(known)}; {'; '.join(parts)}; {path_error(solution, place)}"


def path_error(solution: LayoutSolution, truth: Truth) -> str:
    """Mean and largest error of the keyframes' positions."""
    off = solution.position_m - truth.position_m
    error = np.linalg.norm(off - off.mean(axis=0), axis=1)
    return f"path mean {error.mean():.4f} worst {error.max():.4f}"


def main() -> None:
    """Print one line per scan."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--exact-sensor", action="store_true")
    parser.add_argument("folders", type=Path, nargs="+", metavar="SCAN WORK")
    asked = parser.parse_args()
    folders = asked.folders
    for scan, work in zip(folders[::2], folders[1::2], strict=True):
        sys.stdout.write(coverage(scan, work, asked.exact_sensor) + "\n")
        sys.stdout.flush()


if __name__ == "__main__":
    main()
