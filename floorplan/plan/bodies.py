"""Walls as solid bodies: two faces back to back with solid matter between them, and the blocks where bodies meet."""

from dataclasses import dataclass

from shapely.geometry import Polygon, box
from shapely.geometry.base import BaseGeometry
from shapely.ops import unary_union

from floorplan.config import PlanConfig
from floorplan.plan.corners import FaceRun

TOUCH_M = 0.02  # bodies nearer than this touch
MIN_OVERLAP_M = 0.10  # two faces side by side for less than this make no wall


@dataclass(frozen=True)
class Body:
    """The part of a wall between two faces (indices `low_face`, `high_face` by offset): a rectangle normal to `axis`."""

    low_face: int
    high_face: int
    axis: int
    low_m: float
    high_m: float
    start_m: float
    end_m: float

    @property
    def thickness_m(self) -> float:
        return self.high_m - self.low_m

    @property
    def rectangle(self) -> Polygon:
        if self.axis == 0:
            return box(self.low_m, self.start_m, self.high_m, self.end_m)
        return box(self.start_m, self.low_m, self.end_m, self.high_m)


def paired_faces(faces: tuple[FaceRun, ...], config: PlanConfig) -> tuple[tuple[int, int], ...]:
    """Pairs (low, high) of faces that look away from each other, a wall's thickness apart, with nothing between them."""
    pairs = []
    for low, first in enumerate(faces):
        for high, second in enumerate(faces):
            if first.axis != second.axis or first.facing != -1 or second.facing != 1:
                continue
            thickness = second.offset_m - first.offset_m
            thick_enough = config.min_thickness_m <= thickness <= config.max_thickness_m
            if thick_enough and first.overlap_m(second) >= MIN_OVERLAP_M and not _between(faces, first, second):
                pairs.append((low, high))
    return tuple(pairs)


def _between(faces: tuple[FaceRun, ...], first: FaceRun, second: FaceRun) -> bool:
    """Whether another parallel face lies between the two over most of their overlap: the nearer one is the partner then."""
    common = first.overlap_m(second)
    low, high = max(first.start_m, second.start_m), min(first.end_m, second.end_m)
    for other in faces:
        if other.axis == first.axis and first.offset_m < other.offset_m < second.offset_m:
            shared = min(other.end_m, high) - max(other.start_m, low)
            if shared > 0.5 * common:
                return True
    return False


def bodies_of(faces: tuple[FaceRun, ...], pairs: tuple[tuple[int, int], ...]) -> tuple[Body, ...]:
    """One body per pair, along the overlap of its faces."""
    found = []
    for low, high in pairs:
        first, second = faces[low], faces[high]
        start, end = max(first.start_m, second.start_m), min(first.end_m, second.end_m)
        if end - start >= MIN_OVERLAP_M:
            found.append(Body(low, high, first.axis, first.offset_m, second.offset_m, start, end))
    return tuple(found)


def junction_blocks(bodies: tuple[Body, ...]) -> tuple[Polygon, ...]:
    """The rectangles where two perpendicular bodies meet that neither covers: corners of L, T and X junctions."""
    blocks = []
    for a in (body for body in bodies if body.axis == 0):
        for b in (body for body in bodies if body.axis == 1):
            block = box(a.low_m, b.low_m, a.high_m, b.high_m)
            meets = block.distance(a.rectangle) < TOUCH_M and block.distance(b.rectangle) < TOUCH_M
            if meets and not (a.rectangle.buffer(1e-6).contains(block) or b.rectangle.buffer(1e-6).contains(block)):
                blocks.append(block)
    return tuple(blocks)


def solid(bodies: tuple[Body, ...], blocks: tuple[Polygon, ...]) -> BaseGeometry:
    """Union of all wall matter."""
    return unary_union([body.rectangle for body in bodies] + list(blocks))
