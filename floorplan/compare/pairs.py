"""Which wall of one survey is which of the other, and what of either has no partner."""

from dataclasses import dataclass

import numpy as np

from floorplan.compare.faces import FaceRows, offset_differences_m, overlap_m
from floorplan.model.checks import Array
from floorplan.model.plan import PlanPlane

FARTHEST_M = 0.50  # a wall that moved by more is one gone and one new
MIN_SHARED_M = 0.30  # along the wall; less is the play of corners
FREE_SHARE = 0.5  # of the shorter face, that nearer partners have left over
CELL_M = 0.05  # grain along the wall
MIN_PIECE_M = 0.50  # shorter pieces without a partner are the play of a wall's ends


@dataclass(frozen=True)
class PlanePair:
    """A plane of each survey (indices) that are one wall: faces (plan indices) that lie on each other, over `spans_m` along the wall."""

    first: int
    second: int
    first_faces: tuple[int, ...]
    second_faces: tuple[int, ...]
    spans_m: tuple[tuple[float, float], ...]

    @property
    def length_m(self) -> float:
        return sum(high - low for low, high in self.spans_m)

    def away_m(self, along_m: float) -> float:
        """How far a place along the wall lies from where the faces lie on each other."""
        return min(max(low - along_m, along_m - high, 0.0) for low, high in self.spans_m)


@dataclass(frozen=True)
class Piece:
    """A stretch of one survey's face (index in the plan) without a partner in the other."""

    face: int
    axis: int
    offset_m: float
    low_m: float
    high_m: float


@dataclass(frozen=True)
class Pairing:
    """All that belongs together, and what is left of either survey."""

    pairs: tuple[PlanePair, ...]
    left_first: tuple[Piece, ...]
    left_second: tuple[Piece, ...]


def pair_faces(a: FaceRows, b: FaceRows) -> Pairing:
    """The nearest faces of equal facing that lie beside each other, nearest first; both sets in one frame."""
    still = np.zeros(2)
    apart, shared = np.abs(offset_differences_m(a, b, still)), overlap_m(a, b, still)
    first, second = np.nonzero((apart < FARTHEST_M) & (shared >= MIN_SHARED_M))
    covered_a, covered_b = _cells(a), _cells(b)
    found: dict[tuple[int, int], list[tuple[int, int, float, float]]] = {}
    for k in np.argsort(apart[first, second], kind="stable"):
        i, j = int(first[k]), int(second[k])
        low, high = max(a.low_m[i], b.low_m[j]), min(a.high_m[i], b.high_m[j])
        cells = (_slice(a, i, low, high), _slice(b, j, low, high))
        free_m = CELL_M * min(float((~covered_a[i][cells[0]]).sum()), float((~covered_b[j][cells[1]]).sum()))
        if free_m < max(MIN_SHARED_M, FREE_SHARE * (high - low)) - CELL_M:
            continue
        covered_a[i][cells[0]], covered_b[j][cells[1]] = True, True
        found.setdefault((int(a.plane[i]), int(b.plane[j])), []).append((int(a.face[i]), int(b.face[j]), float(low), float(high)))
    pairs = tuple(
        PlanePair(p, q, tuple(sorted({row[0] for row in rows})), tuple(sorted({row[1] for row in rows})), tuple(row[2:] for row in rows))
        for (p, q), rows in sorted(found.items())
    )
    return Pairing(pairs, _left(a, covered_a), _left(b, covered_b))


def level_pairs(first: tuple[PlanPlane, ...], second: tuple[PlanPlane, ...]) -> tuple[tuple[int, int], ...]:
    """Floors and ceilings (indices) that are the same: equal facing, one above the other, the nearest height."""
    found = []
    for i, a in enumerate(first):
        near = [
            (abs(a.offset_m - b.offset_m), j)
            for j, b in enumerate(second)
            if a.axis == b.axis == 2 and a.facing == b.facing and abs(a.offset_m - b.offset_m) < FARTHEST_M and _above(a, b)
        ]
        if near:
            found.append((i, min(near)[1]))
    return tuple(found)


def _above(a: PlanPlane, b: PlanPlane) -> bool:
    return all(min(a.extent_m[k][1], b.extent_m[k][1]) > max(a.extent_m[k][0], b.extent_m[k][0]) for k in range(2))


def _cells(faces: FaceRows) -> list[Array]:
    """Per face, whether each cell along it has found its partner."""
    return [np.zeros(max(1, round(float(length) / CELL_M)), dtype=bool) for length in faces.length_m]


def _slice(faces: FaceRows, row: int, low: float, high: float) -> slice:
    return slice(round((low - faces.low_m[row]) / CELL_M), round((high - faces.low_m[row]) / CELL_M))


def _left(faces: FaceRows, covered: list[Array]) -> tuple[Piece, ...]:
    pieces = []
    for row, cells in enumerate(covered):
        edges = np.diff(np.concatenate(([1], cells.astype(int), [1])))
        for start, end in zip(np.flatnonzero(edges == -1), np.flatnonzero(edges == 1), strict=True):
            low, high = faces.low_m[row] + CELL_M * start, faces.low_m[row] + CELL_M * end
            if high - low >= MIN_PIECE_M:
                pieces.append(Piece(int(faces.face[row]), int(faces.axis[row]), float(faces.offset_m[row]), float(low), float(high)))
    return tuple(pieces)
