"""The seen wall faces of a plan as arrays, and how two sets of them lie on each other."""

from dataclasses import dataclass

import numpy as np

from floorplan.model.checks import Array, freeze
from floorplan.model.plan import Certainty, Plan


@dataclass(frozen=True)
class FaceRows:
    """Faces (N,): `axis`, `facing`, `offset_m`, ends `low_m` and `high_m` along the wall, `plane` index, `face` index in the plan."""

    axis: Array
    facing: Array
    offset_m: Array
    low_m: Array
    high_m: Array
    plane: Array
    face: Array

    def __post_init__(self) -> None:
        kinds = {name: (np.int64, ("N",)) for name in ("axis", "facing", "plane", "face")}
        freeze(self, kinds | {name: (np.float64, ("N",)) for name in ("offset_m", "low_m", "high_m")})

    @property
    def length_m(self) -> Array:
        return np.asarray(self.high_m - self.low_m)


def seen_faces(plan: Plan) -> FaceRows:
    """The faces that the sensor saw."""
    index = {plane.id: k for k, plane in enumerate(plan.planes)}
    rows = []
    for number, face in enumerate(plan.faces):
        plane = plan.planes[index[face.plane]]
        if face.certainty is Certainty.SEEN:
            ends = sorted((face.start[1 - plane.axis], face.end[1 - plane.axis]))
            rows.append((plane.axis, plane.facing, plane.offset_m, *ends, index[face.plane], number))
    table = np.array(rows, dtype=float).reshape(-1, 7).T
    return FaceRows(table[0].astype(int), table[1].astype(int), table[2], table[3], table[4], table[5].astype(int), table[6].astype(int))


def overlap_m(a: FaceRows, b: FaceRows, shift_xy: Array) -> Array:
    """Length (A, B) that each pair of equal axis and facing shares along the wall once `b` is shifted; negative: the gap between."""
    along = np.where(b.axis == 0, shift_xy[1], shift_xy[0])
    shared = np.minimum(a.high_m[:, None], b.high_m + along) - np.maximum(a.low_m[:, None], b.low_m + along)
    alike = (a.axis[:, None] == b.axis) & (a.facing[:, None] == b.facing)
    return np.asarray(np.where(alike, shared, -np.inf))


def offset_differences_m(a: FaceRows, b: FaceRows, shift_xy: Array) -> Array:
    """`b` shifted minus `a`, (A, B), across the wall."""
    across = np.where(b.axis == 0, shift_xy[0], shift_xy[1])
    return np.asarray(b.offset_m + across - a.offset_m[:, None])
