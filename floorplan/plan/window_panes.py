"""Panes of windows: what returns rays from within the depth of a wall, over its sill, is no wall."""

from floorplan.config import PlanConfig
from floorplan.model.plan import Rejection
from floorplan.plan.corners import MIN_SIDE_M, FaceRun
from floorplan.plan.faces import Reason
from floorplan.plan.gaps import Gap

WITHIN_SHARE = 0.8  # of a pane's length that lies within its window


def panes_of_windows(faces: tuple[FaceRun, ...], gaps: tuple[Gap, ...], config: PlanConfig) -> frozenset[int]:
    """The faces (indices) that stand in a window of a face before them, less than a wall's thickness back."""
    windows = [gap for gap in gaps if gap.is_window and gap.lintel is not False]
    return frozenset(k for k, face in enumerate(faces) if any(_is_pane(face, faces[gap.face], gap, config) for gap in windows))


def _is_pane(face: FaceRun, wall: FaceRun, gap: Gap, config: PlanConfig) -> bool:
    if face.axis != wall.axis or face.facing != wall.facing:
        return False
    behind = (wall.offset_m - face.offset_m) * face.facing
    within = min(face.end_m, gap.end_m) - max(face.start_m, gap.start_m)
    return MIN_SIDE_M < behind <= config.max_thickness_m and within >= WITHIN_SHARE * face.run.length_m


def without_panes(faces: tuple[FaceRun, ...], panes: frozenset[int]) -> tuple[FaceRun, ...]:
    """The other faces."""
    return tuple(face for k, face in enumerate(faces) if k not in panes)


def pane_rejections(faces: tuple[FaceRun, ...], panes: frozenset[int]) -> tuple[Rejection, ...]:
    """One line for the summary where there are any."""
    return (Rejection(str(Reason.PANE), len(panes), sum(faces[k].run.length_m for k in sorted(panes))),) if panes else ()
