"""What one finished scan shows of the building: its wall faces and the floor that rays crossed."""

from dataclasses import dataclass

import numpy as np

from floorplan.geometry import rotation_about_z
from floorplan.model.checks import Array
from floorplan.model.plan import Plan


@dataclass(frozen=True)
class Survey:
    """Wall faces (W) and free space of one scan in one plan frame, metres.

    `axis (W,)`, `facing (W,)`, `offset_m (W,)`, `reach_m (W, 2)` from where to where along the wall; `free_xy_m (C, 2)` centres of the
    cells of `cell_m` that rays crossed; `first_xy_m (2,)` where the scan began; `floor_seen` whether z = 0 is the floor.
    """

    axis: Array
    facing: Array
    offset_m: Array
    reach_m: Array
    free_xy_m: Array
    first_xy_m: Array
    floor_seen: bool

    @property
    def length_m(self) -> Array:
        """Lengths (W,) of the faces."""
        return np.asarray(self.reach_m[:, 1] - self.reach_m[:, 0])


@dataclass(frozen=True)
class Laying:
    """Takes one plan frame to another: quarter turns counter-clockwise, then `shift_m (2,)`."""

    quarters: int
    shift_m: Array

    @property
    def turn(self) -> Array:
        """The rotation (3, 3), of whole numbers."""
        return quarter_turn(self.quarters)

    def xy(self, points_m: Array) -> Array:
        """Points (..., 2) in the other frame."""
        return np.asarray(points_m @ self.turn[:2, :2].T + self.shift_m)


def quarter_turn(quarters: int) -> Array:
    """The rotation (3, 3) by quarter turns counter-clockwise about z, of whole numbers."""
    return np.asarray(np.rint(rotation_about_z(np.array(quarters * np.pi / 2))))


def survey_of(plan: Plan, free_xy_m: Array) -> Survey:
    """The survey of a finished plan, whose rays crossed the cells around `free_xy_m (C, 2)`."""
    planes = {plane.id: plane for plane in plan.planes}
    faces = [(face, planes[face.plane]) for face in plan.faces]
    ends = np.array([(face.start[1 - plane.axis], face.end[1 - plane.axis]) for face, plane in faces]).reshape(-1, 2)
    return Survey(
        axis=np.array([plane.axis for _, plane in faces], dtype=np.int64),
        facing=np.array([plane.facing for _, plane in faces], dtype=np.int64),
        offset_m=np.array([plane.offset_m for _, plane in faces], dtype=np.float64),
        reach_m=np.sort(ends, axis=1),
        free_xy_m=free_xy_m,
        first_xy_m=plan.trajectory.position_m[0, :2],
        floor_seen=plan.floor_seen,
    )


def laid(survey: Survey, laying: Laying) -> Survey:
    """The survey in the other plan frame."""
    turn = laying.turn
    new_axis, sign = np.abs(turn).argmax(axis=0), turn.sum(axis=0)
    axis, along = new_axis[survey.axis], new_axis[1 - survey.axis]
    reach = survey.reach_m * sign[1 - survey.axis][:, None] + laying.shift_m[along][:, None]
    return Survey(
        axis=axis,
        facing=(survey.facing * sign[survey.axis]).astype(np.int64),
        offset_m=survey.offset_m * sign[survey.axis] + laying.shift_m[axis],
        reach_m=np.sort(reach, axis=1),
        free_xy_m=laying.xy(survey.free_xy_m),
        first_xy_m=laying.xy(survey.first_xy_m),
        floor_seen=survey.floor_seen,
    )


def together(surveys: list[Survey]) -> Survey:
    """Surveys in one frame as one; the start is that of the first."""
    names = ("axis", "facing", "offset_m", "reach_m", "free_xy_m")
    joined = {name: np.concatenate([getattr(survey, name) for survey in surveys]) for name in names}
    return Survey(**joined, first_xy_m=surveys[0].first_xy_m, floor_seen=surveys[0].floor_seen)
