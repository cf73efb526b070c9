"""Steps of a wall: where one surface ends and another goes on behind it, the short face between them that was not seen."""

from dataclasses import dataclass

import numpy as np

from floorplan.config import PlanConfig
from floorplan.model.plan import Point, Wall
from floorplan.plan.arrangement import INSIDE_SHARE, Barrier
from floorplan.plan.corners import JAMB_MISMATCH_M, MIN_SIDE_M, FaceRun
from floorplan.plan.free_space import CELL_M, FreeSpace
from floorplan.plan.surface_evidence import SAME_SURFACE_M

INSIDE_M = (CELL_M, 3 * CELL_M)  # behind a step's face there is matter: looked for this far behind it, clear of what smears the edge
SEEN_SHARE = 0.5  # of a step that a drawn face covers


@dataclass(frozen=True)
class Step:
    """The unseen face normal to `axis` at `at_m` along the wall, between the offsets of two surfaces, of which `farther` goes on."""

    axis: int
    at_m: float
    low_m: float
    high_m: float
    farther: FaceRun

    @property
    def line(self) -> tuple[Point, Point]:
        """From the lower to the higher surface."""
        if self.axis == 0:
            return (self.at_m, self.low_m), (self.at_m, self.high_m)
        return (self.low_m, self.at_m), (self.high_m, self.at_m)


def steps(faces: tuple[FaceRun, ...], space: FreeSpace, config: PlanConfig) -> tuple[Step, ...]:
    """Every step between two surfaces of one facing, less than a wall's thickness apart, through whose face no rays went."""
    found: list[Step] = []
    for face in faces:
        for direction in (-1, +1):
            at = face.end_m if direction > 0 else face.start_m
            behind = [(gap, other) for other in faces if (gap := _gap_m(face, other, at, direction, config)) is not None]
            if not behind:
                continue
            other = min(behind, key=lambda one: abs(one[0]))[1]
            low, high = sorted((face.offset_m, other.offset_m))
            step = Step(1 - face.axis, at, low, high, other)
            if not _is_drawn(step, faces, config) and not _is_free(step, direction, space):
                found.append(step)
    return tuple(found)


def _gap_m(face: FaceRun, other: FaceRun, at_m: float, direction: int, config: PlanConfig) -> float | None:
    """Along the wall, from an end of `face` to where `other` begins behind it (negative: before it); None where none goes on beyond."""
    behind = (face.offset_m - other.offset_m) * face.facing
    if other.axis != face.axis or other.facing != face.facing or not SAME_SURFACE_M < behind <= config.max_thickness_m:
        return None
    near, far = (other.start_m, other.end_m) if direction > 0 else (other.end_m, other.start_m)
    gap = (near - at_m) * direction
    return gap if -JAMB_MISMATCH_M < gap <= config.max_bridged_gap_m and (far - at_m) * direction > MIN_SIDE_M else None


def _is_drawn(step: Step, faces: tuple[FaceRun, ...], config: PlanConfig) -> bool:
    """Whether a face that was seen stands at the step already."""
    near = [f for f in faces if f.axis == step.axis and abs(f.offset_m - step.at_m) <= config.max_bridged_gap_m]
    covered = [min(f.end_m, step.high_m) - max(f.start_m, step.low_m) for f in near]
    return max(covered, default=0.0) > SEEN_SHARE * (step.high_m - step.low_m)


def _is_free(step: Step, direction: int, space: FreeSpace) -> bool:
    """Whether rays crossed what the step's face would hide."""
    along = np.sort(step.at_m - direction * np.array(INSIDE_M))
    across = np.array([step.low_m, step.high_m])
    x, y = (along, across) if step.axis == 0 else (across, along)
    return bool(space.share(x, y)[0, 0] > INSIDE_SHARE)


def step_barriers(found: tuple[Step, ...]) -> tuple[Barrier, ...]:
    """The steps, and what is left of the farther surface up to them."""
    closed = [Barrier(step.axis, step.at_m, step.low_m, step.high_m) for step in found]
    for step in found:
        rest = _rest(step)
        if rest is not None:
            closed.append(Barrier(step.farther.axis, step.farther.offset_m, *rest))
    return tuple(closed)


def _rest(step: Step) -> tuple[float, float] | None:
    """The stretch between the step and the beginning of the farther surface."""
    face = step.farther
    if step.at_m < face.start_m:
        return step.at_m, face.start_m
    return (face.end_m, step.at_m) if step.at_m > face.end_m else None


def with_steps(walls: tuple[Wall, ...], found: tuple[Step, ...]) -> tuple[Wall, ...]:
    """The walls, and one of inferred lines for every step."""
    extra = [Wall(f"W{len(walls) + k + 1}", (), (), (_outline(step),)) for k, step in enumerate(found)]
    return (*walls, *extra)


def _outline(step: Step) -> tuple[Point, ...]:
    """The step's line, carried on along the farther surface to where that was seen."""
    rest = _rest(step)
    if rest is None:
        return step.line
    begin = rest[1] if rest[0] == step.at_m else rest[0]
    offset = step.farther.offset_m
    corner_last = step.line if offset == step.high_m else step.line[::-1]
    return (*corner_last, (begin, offset) if step.axis == 0 else (offset, begin))
