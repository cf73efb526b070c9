"""A second candidate for the evidence merge, measured: covariance-weighted L1, then chi-square, the winner per axis by evidence.

    OMP_NUM_THREADS=1 OPENBLAS_NUM_THREADS=1 python -m tests.bench.l1_candidate --seeds 601 602 [--hard]

Tracks of one system have offsets `m0` with joint covariance `P`. The candidate minimises `sum |m_a - m_b| / sigma_ab` over the gated
pairs inside the ellipsoid of 95 % about `m0`, and then merges pairs in the order of the distances that are left, each where its chi-square
given the merges before is at most 9. Of both partitions of an axis the one of larger log evidence would win.
"""

import argparse
import sys
from dataclasses import replace

import numpy as np
from scipy import sparse, stats
from scipy.sparse import csgraph

from floorplan.layout_graph import with_signs_from_facing
from floorplan.merge.evidence import SMALLEST_BIAS_M, _decided, _planes_of_systems, _with_bias
from floorplan.merge.evidence_bias import PRIOR_BIAS_M, bias_sigma_m, merged_bias_sigma_m
from floorplan.merge.evidence_greedy import Question
from floorplan.merge.evidence_live import SAME_M2, score
from floorplan.merge.evidence_pairs import Planes, seen_apart
from floorplan.noise import estimate_noise
from floorplan.weighted import known_systems
from tests.bench.back_end import agreement
from tests.bench.merge_quality import HARD
from tests.bench.scenes import PAPER_SCENES, Scene, paper_scene

CHI_SQUARE = 9.0
WITHIN = 0.95
JITTER_M2 = 1e-12
ABOVE_ANY_PRIOR = 1000.0  # turns the largest spanning tree into the smallest


def log_evidence(question: Question, planes: Planes, plane: np.ndarray) -> float:
    """Log density of the distances inside the planes of a partition, and the log priors of the likeliest tree that joins each of them."""
    inside = np.flatnonzero(plane[question.first] == plane[question.second])
    if question.apart[inside].any():
        return -np.inf
    size, cost = len(plane), ABOVE_ANY_PRIOR - question.log_prior[inside]
    links = sparse.coo_array((cost, (question.first[inside], question.second[inside])), shape=(size, size)).tocsr()
    tree = csgraph.minimum_spanning_tree(links).tocoo()
    E = np.zeros((len(tree.data), size))
    E[np.arange(len(E)), tree.row], E[np.arange(len(E)), tree.col] = 1.0, -1.0
    lower = np.linalg.cholesky(E @ planes.covariance_m2 @ E.T + JITTER_M2 * np.eye(len(E)))
    white = np.linalg.solve(lower, E @ planes.offset_m)
    density = -0.5 * white @ white - np.log(np.diag(lower)).sum() - 0.5 * len(E) * np.log(2 * np.pi)
    return float(density + (ABOVE_ANY_PRIOR - tree.data).sum())


def l1_offsets_m(question: Question, planes: Planes) -> np.ndarray:
    """Offsets (T,) of the weighted L1 problem."""
    import cvxpy

    asked, size = np.flatnonzero(~question.apart), len(planes.tracks)
    row = np.tile(np.arange(len(asked)), 2)
    column = np.concatenate([question.first[asked], question.second[asked]])
    E = sparse.coo_array((np.repeat([1.0, -1.0], len(asked)), (row, column)), shape=(len(asked), size)).tocsr()
    lower = np.linalg.cholesky(planes.covariance_m2 + JITTER_M2 * np.eye(size))
    white, weight = cvxpy.Variable(size), question.variance_m2[asked] ** -0.5
    gap = cvxpy.multiply(weight, E @ (lower @ white)) + weight * (E @ planes.offset_m)
    ball = cvxpy.norm2(white) <= stats.chi2.ppf(WITHIN, size) ** 0.5
    cvxpy.Problem(cvxpy.Minimize(cvxpy.norm1(gap)), [ball]).solve(solver=cvxpy.CLARABEL)
    return np.asarray(planes.offset_m + lower @ white.value)


def l1_partition(question: Question, planes: Planes) -> np.ndarray:
    """The candidate's planes: a label (T,) per track."""
    near, P, offset = l1_offsets_m(question, planes), planes.covariance_m2.copy(), planes.offset_m.copy()
    label, barred = np.arange(len(near)), np.zeros((len(near), len(near)), dtype=bool)
    barred[question.first[question.apart], question.second[question.apart]] = True
    barred |= barred.T
    for h in np.argsort(np.abs(near[question.first] - near[question.second])):
        a, b = label[question.first[h]], label[question.second[h]]
        gain = P[a] - P[b]
        delta, variance = offset[a] - offset[b], gain[a] - gain[b]
        if a == b or barred[a, b] or variance < SAME_M2 or delta**2 > CHI_SQUARE * variance:
            continue
        if score(delta, variance, question.log_prior[h]) <= 0:
            continue
        offset -= gain * delta / variance
        P -= np.outer(gain, gain) / variance
        label[label == b] = a
        barred[a] |= barred[b]
        barred[:, a] |= barred[:, b]
    return label


def compare(name: str, seed: int, scene: Scene) -> int:
    """Print every axis on which the two candidates differ; gives back how many axes there are."""
    graph, axes = with_signs_from_facing(scene.graph)[0], 0
    noise = estimate_noise(graph)
    systems = _planes_of_systems(graph, known_systems(graph, noise))
    noise = replace(noise, bias_sigma_m=bias_sigma_m(systems, [seen_apart(graph, noise.sigma_m, PRIOR_BIAS_M, p) for p in systems]))
    first = [_decided(graph, noise, planes, None).decision.plane for planes in systems]
    noise = replace(noise, bias_sigma_m=merged_bias_sigma_m(systems, first, noise.bias_sigma_m))
    for one, known in zip(systems, first, strict=True):
        made = _decided(graph, noise, one, known)
        planes = _with_bias(one, max(noise.bias_sigma_m, SMALLEST_BIAS_M))
        greedy, other = np.asarray(made.decision.plane), l1_partition(made.question, planes)
        for axis in np.unique(planes.axis):
            axes += 1
            mine = planes.axis == axis
            ours, theirs, true = (np.unique(x[mine], return_inverse=True)[1] for x in (greedy, other, scene.plane_of_track[planes.tracks]))
            if agreement(ours, theirs) != (1.0, 1.0):
                mixed = np.where(mine, other + len(other), greedy)
                gained = log_evidence(made.question, planes, mixed) - log_evidence(made.question, planes, greedy)
                (p, r), (p1, r1) = agreement(ours, true), agreement(theirs, true)
                sys.stdout.write(f"{name} {seed} {'xyz'[axis]} {p:.3f} {r:.3f}, L1 {p1:.3f} {r1:.3f}, log evidence {gained:+.1f}\n")
    return axes


def main() -> None:
    """Print the axes on which the candidates differ: precision and recall of the default's planes, of L1's, what L1 gains in evidence."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--seeds", type=int, nargs="+", default=[601])
    parser.add_argument("--hard", action="store_true")
    asked = parser.parse_args()
    axes = 0
    for seed in asked.seeds:
        for spec in PAPER_SCENES:
            axes += compare(spec.name, seed, paper_scene(spec.name, seed, HARD if asked.hard else None))
            sys.stdout.flush()
    sys.stdout.write(f"{axes} axes\n")


if __name__ == "__main__":
    main()
