"""Back-end benchmark: verbatim cvxpy + Clarabel beside the reduced engine beside "evidence", in the same run.

    OMP_NUM_THREADS=1 OPENBLAS_NUM_THREADS=1 NUMBA_NUM_THREADS=1 python -m tests.bench.back_end [--write docs/benchmarks.md]

Seconds are processor seconds of one thread, medians over runs. Every scale runs in a process of its own, whose peak memory is given.
"""

import argparse
import json
import resource
import statistics
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable
from dataclasses import asdict, dataclass
from pathlib import Path

import numpy as np

from floorplan.config import Config, LeastSquaresConfig, MergeConfig, ResolveConfig
from floorplan.errors import NoSolutionError
from floorplan.graph_file import load_graph, save_graph
from floorplan.least_squares import least_squares
from floorplan.merge import merge
from floorplan.merge.paper import solve_paper
from floorplan.merge.paper_cvxpy import verbatim_matrices
from floorplan.merge.paper_problem import PaperProblem, paper_problem
from floorplan.model.graph import LayoutGraph, MergeResult
from floorplan.resolve import resolve
from floorplan.solve_graph import solve_graph
from tests.bench.scenes import PAPER_SCENES, Scene, make_scene, scale_spec

SEED = 1
RUNS = 5
SCALES = (1, 2, 4, 8, 16)
VERBATIM_UP_TO = 2  # larger ones take minutes and break
LONGEST_S = 1800  # wall clock, on a machine that may be busy
GRAPH, TRUE = "graph.npz", "true.npy"
START, END = "<!-- back end: start -->", "<!-- back end: end -->"
PLAIN = LeastSquaresConfig(method="plain")


@dataclass(frozen=True)
class Comparison:
    """One scene: median seconds of the three pipelines and what the two engines disagree about."""

    name: str
    tracks: int
    pairs: int
    verbatim_s: float
    reduced_s: float
    evidence_s: float
    objective_difference: float
    plane_difference_m: float
    decisions_differing: int


@dataclass(frozen=True)
class Scale:
    """One engine on one scale: seconds to the end of its merge and in all, peak memory in MB, quality of the merges, or why none."""

    frames: int
    tracks: int
    merge_s: float
    seconds: float
    peak_mb: float
    precision: float
    recall: float
    failure: str = ""


def seconds(work: Callable[[], object]) -> float:
    """Median processor seconds over `RUNS` runs after one to warm up."""
    work()
    taken = []
    for _ in range(RUNS):
        start = time.process_time()
        work()
        taken.append(time.process_time() - start)
    return statistics.median(taken)


def published(graph: LayoutGraph, radius_m: float) -> MergeResult:
    """Least squares, L1, threshold, re-solve: the published back end on the reduced engine."""
    merged = merge(graph, least_squares(graph, PLAIN), MergeConfig(method="paper", engine="reduced", radius_m=radius_m))
    resolve(graph, merged, ResolveConfig())
    return merged


def verbatim(problem: PaperProblem, mu_m: float) -> None:
    """L1 and re-solve, both with all variables in cvxpy + Clarabel."""
    import cvxpy

    answer = solve_paper(problem, "cvxpy")[0]
    matrices = verbatim_matrices(problem)
    accepted = np.abs(problem.pairs.gap_m(answer.track_offset_m)) <= mu_m
    xi = cvxpy.Variable(matrices.a.shape[1])
    same, signs = matrices.e[np.flatnonzero(accepted)] @ xi == 0, matrices.d @ xi <= 0
    cvxpy.Problem(cvxpy.Minimize(cvxpy.norm2(matrices.a @ xi - matrices.b)), [same, signs]).solve(solver=cvxpy.CLARABEL)


def compare(scene: Scene) -> Comparison:
    """The three pipelines on one scene."""
    graph, mu_m = scene.graph, MergeConfig().mu_m
    problem = paper_problem(graph, least_squares(graph, PLAIN), scene.radius_m, MergeConfig().eps)
    (theirs, reference), (ours, certificate) = solve_paper(problem, "cvxpy"), solve_paper(problem, "reduced")
    gap, other = (np.abs(problem.pairs.gap_m(answer.track_offset_m)) for answer in (ours, theirs))
    return Comparison(
        name=scene.name,
        tracks=len(graph.axis),
        pairs=len(problem.pairs),
        verbatim_s=seconds(lambda: verbatim(problem, mu_m)),
        reduced_s=seconds(lambda: published(graph, scene.radius_m)),
        evidence_s=seconds(lambda: solve_graph(graph, Config(), "evidence")),
        objective_difference=abs(certificate.objective_m / reference.objective_m - 1),
        plane_difference_m=float(np.abs(ours.track_offset_m - theirs.track_offset_m).max()),
        decisions_differing=int(((gap <= mu_m) != (other <= mu_m)).sum()),
    )


def scale(folder: Path, engine: str) -> Scale:
    """A graph that `saved_scene` wrote, by "cvxpy", "reduced" or "evidence", in this process, once (after a small scene to warm up)."""
    method = "evidence" if engine == "evidence" else "paper"
    config = Config(merge=MergeConfig(method=method, engine="cvxpy" if engine == "cvxpy" else "reduced"))
    solve_graph(make_scene(PAPER_SCENES[0], SEED).graph, config)
    graph, true = load_graph(folder / GRAPH), np.load(folder / TRUE)
    start, failure, merged, plane_of_track = time.process_time(), "", time.process_time(), np.arange(len(graph.axis))
    try:
        solution = least_squares(graph, PLAIN if method == "paper" else LeastSquaresConfig())
        made = merge(graph, solution, config.merge)
        merged = time.process_time()
        plane_of_track = resolve(graph, made, ResolveConfig(covariance=False)).plane_of_track
    except NoSolutionError as error:
        failure = str(error)
    taken = time.process_time() - start
    precision, recall = agreement(plane_of_track, true)
    return Scale(len(graph.stamp_s), len(graph.axis), merged - start, taken, peak_mb(), precision, recall, failure)


def peak_mb() -> float:
    """Most memory that this process has held; `ru_maxrss` would count what the process that started it held before."""
    status = Path("/proc/self/status")
    if not status.exists():
        return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1000
    peak = next(line for line in status.read_text("utf-8").splitlines() if line.startswith("VmHWM"))
    return int(peak.split()[1]) / 1000


def saved_scene(factor: int, folder: Path) -> int:
    """Write a scale's graph and true planes into `folder`: making it takes more memory than solving. Gives back its hypotheses."""
    scene = make_scene(scale_spec(factor), SEED)
    save_graph(scene.graph, folder / GRAPH)
    np.save(folder / TRUE, scene.plane_of_track)
    return len(paper_problem(scene.graph, least_squares(scene.graph, PLAIN), scene.radius_m, MergeConfig().eps).pairs)


def agreement(found: np.ndarray, true: np.ndarray) -> tuple[float, float]:
    """Precision and recall of pairs of tracks that are one plane, from the sizes of the common groups."""
    both = np.unique(np.stack((found, true)), axis=1, return_counts=True)[1]
    together, ours, theirs = (float((n * (n - 1.0) / 2).sum()) for n in (both, np.bincount(found), np.bincount(true)))
    return together / max(ours, 1.0), together / max(theirs, 1.0)


def scale_apart(folder: Path, engine: str) -> Scale:
    """`scale` in a process of its own."""
    command = [sys.executable, "-m", "tests.bench.back_end", "--one", str(folder), engine]
    done = subprocess.run(command, capture_output=True, text=True, check=True, timeout=LONGEST_S)
    return Scale(**json.loads(done.stdout.splitlines()[-1]))


def scene_table(rows: list[Comparison]) -> list[str]:
    """Markdown of the six scenes."""
    lines = [
        "| scene | tracks | hypotheses | verbatim s | reduced s | times faster | evidence s | times faster "
        "| objective | planes mm | decisions |",
        "| --- " * 11 + "|",
    ]
    for r in rows:
        lines.append(
            f"| {r.name} | {r.tracks} | {r.pairs} | {r.verbatim_s:.3f} | {r.reduced_s:.4f} | {r.verbatim_s / r.reduced_s:.0f} | "
            f"{r.evidence_s:.3f} | {r.verbatim_s / r.evidence_s:.1f} | {r.objective_difference:.0e} | {r.plane_difference_m * 1e3:.4f} | "
            f"{r.decisions_differing} |"
        )
    lines += ["", f"Against verbatim: reduced {_times([r.verbatim_s / r.reduced_s for r in rows])}, "
              f"the default method {_times([r.verbatim_s / r.evidence_s for r in rows])}."]  # fmt: skip
    return lines


def _times(faster: list[float]) -> str:
    return f"{statistics.median(faster):.1f} times faster (median; {min(faster):.1f} worst)"


def scale_table(engines: list[str], factors: list[int]) -> list[str]:
    """Markdown of the scaling series."""
    lines = [
        "| scale | engine | frames | tracks | hypotheses | to the merge s | in all s | peak MB | precision | recall |",
        "| --- " * 10 + "|",
    ]
    for factor in factors:
        with tempfile.TemporaryDirectory() as name:
            folder = Path(name)
            pairs = saved_scene(factor, folder)
            lines += [_scale_row(f"{factor}x", folder, e, pairs) for e in engines if e != "cvxpy" or factor <= VERBATIM_UP_TO]
    return lines


def _scale_row(name: str, folder: Path, engine: str, pairs: int) -> str:
    try:
        r = scale_apart(folder, engine)
    except subprocess.TimeoutExpired:
        return f"| {name} | {engine} | | | {pairs} | | over {LONGEST_S} | | | |"
    quality = f"{r.precision:.3f} | {r.recall:.3f}" if not r.failure else f"{r.failure[:80]} | "
    return f"| {name} | {engine} | {r.frames} | {r.tracks} | {pairs} | {r.merge_s:.2f} | {r.seconds:.2f} | {r.peak_mb:.0f} | {quality} |"


def main() -> None:
    """Run everything and print the tables, or write them between the markers of a page."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--one", nargs=2, metavar=("FOLDER", "ENGINE"), help="one saved scale by one engine, as JSON")
    parser.add_argument("--scales", type=int, nargs="*", default=list(SCALES))
    parser.add_argument("--engines", nargs="*", default=["cvxpy", "reduced", "evidence"])
    parser.add_argument("--only-scales", action="store_true", help="leave the six scenes out")
    parser.add_argument("--write", type=Path)
    asked = parser.parse_args()
    if asked.one:
        sys.stdout.write(json.dumps(asdict(scale(Path(asked.one[0]), asked.one[1]))) + "\n")
        return
    scenes = [] if asked.only_scales else scene_table([compare(make_scene(spec, SEED)) for spec in PAPER_SCENES])
    text = "\n".join([START, "", *scenes, "", *scale_table(asked.engines, asked.scales), "", END])
    sys.stdout.write(text + "\n")
    if asked.write:
        page = asked.write.read_text("utf-8")
        before, _, rest = page.partition(START)
        asked.write.write_text(before + text + rest.partition(END)[2], "utf-8")


if __name__ == "__main__":
    main()
