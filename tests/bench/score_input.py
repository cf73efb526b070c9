"""What is scored: a built plan in the truth's frame, and the truth."""

import json
from dataclasses import dataclass
from decimal import Decimal
from pathlib import Path
from typing import Any

import numpy as np

from floorplan.model.checks import Array

NS = Decimal(1_000_000_000)
MATCH_NS = 1_000_000  # stamps of one frame agree this well in two files


@dataclass(frozen=True)
class Placement:
    """Takes plan coordinates to the building's: a quarter turn `rotation (2, 2)`, then `shift_m (3,)`."""

    rotation: Array
    shift_m: Array

    def xy(self, points: Any) -> Array:
        """Plan points (..., 2) in the building's frame."""
        return np.asarray(points, dtype=float) @ self.rotation.T + self.shift_m[:2]

    def vector(self, axis: int, sign: int = 1) -> Array:
        """The plan's unit vector along `axis` (0, 1) in the building's frame."""
        return np.asarray(sign * self.rotation[:, axis])

    def axis(self, axis: int) -> int:
        """Which axis of the building the plan's axis lies on."""
        return int(np.argmax(np.abs(self.rotation[:, axis])))


@dataclass(frozen=True)
class Case:
    """One plan to score. `path_plan_m`, `path_true_m (N, 3)`: the same frames, both in the building's frame."""

    truth: dict[str, Any]
    plan: dict[str, Any]
    placement: Placement
    path_plan_m: Array
    path_true_m: Array


def load_case(scan: Path, work: Path) -> Case:
    """The plan of `work` placed on the truth of `scan`: the best of four quarter turns and the mean shift of the trajectory."""
    truth = json.loads((scan / "truth.json").read_text())
    plan = json.loads((work / "plan.json").read_text())
    stamps, positions = read_tum(work / "trajectory.tum")
    true_stamps = np.array(truth["trajectory"]["stamp_ns"])
    nearest = np.clip(np.searchsorted(true_stamps, stamps - MATCH_NS), 0, len(true_stamps) - 1)
    same = np.abs(true_stamps[nearest] - stamps) <= MATCH_NS
    path_true = np.array(truth["trajectory"]["pose"])[nearest[same], :3]
    placement = best_placement(positions[same], path_true)
    z = positions[same][:, 2] + placement.shift_m[2]
    return Case(truth, plan, placement, np.column_stack((placement.xy(positions[same][:, :2]), z)), path_true)


def read_tum(path: Path) -> tuple[Array, Array]:
    """Stamps (N,) ns and positions (N, 3) of a .tum trajectory."""
    rows = [line.split() for line in path.read_text().splitlines() if line and not line.startswith("#")]
    stamps = np.array([int(Decimal(row[0]) * NS) for row in rows], dtype=np.int64)
    return stamps, np.array([[float(v) for v in row[1:4]] for row in rows])


def best_placement(positions: Array, path_true: Array) -> Placement:
    """The quarter turn and mean shift that take positions (N, 3) nearest to the true ones."""
    found = []
    for quarters in range(4):
        c, s = [(1, 0), (0, 1), (-1, 0), (0, -1)][quarters]
        rotation = np.array([[c, -s], [s, c]], dtype=float)
        turned = np.column_stack((positions[:, :2] @ rotation.T, positions[:, 2]))
        shift = (path_true - turned).mean(axis=0)
        found.append((float(np.linalg.norm(path_true - turned - shift, axis=1).mean()), Placement(rotation, shift)))
    return min(found, key=lambda pair: pair[0])[1]
