"""Ends of wall runs brought onto each other: corners meet exactly, overshoots are trimmed, door jambs of two faces agree."""

from dataclasses import dataclass, replace

from floorplan.plan.faces import Run

MIN_SIDE_M = 0.03  # how far a face must reach to one side of another to be called standing on that side
JAMB_MISMATCH_M = 0.15  # ends of two faces of one wall nearer than this are one jamb: no wall is cut so obliquely


@dataclass(frozen=True)
class FaceRun:
    """A run with its plane: `axis` it is normal to, `facing`, `offset_m`; ends are (start, end).

    `cornered`: the end lies on another face; `inner`: that face looks back along this one, so the surface cannot go on.
    """

    run: Run
    axis: int
    facing: int
    offset_m: float
    sigma_m: float
    cornered: tuple[bool, bool] = (False, False)
    inner: tuple[bool, bool] = (False, False)

    @property
    def start_m(self) -> float:
        return self.run.start_m

    @property
    def end_m(self) -> float:
        return self.run.end_m

    def overlap_m(self, other: "FaceRun") -> float:
        """Length along which two parallel runs lie side by side; negative: the gap between them."""
        return min(self.end_m, other.end_m) - max(self.start_m, other.start_m)


def with_ends(face: FaceRun, start_m: float, end_m: float) -> FaceRun:
    """The run from `start_m` to `end_m`; its seen parts are clipped, and the outermost stretched along with short extensions."""
    inside = [(max(a, start_m), min(b, end_m)) for a, b in face.run.seen if min(b, end_m) > max(a, start_m)]
    if inside:
        inside[0] = (start_m, inside[0][1])
        inside[-1] = (inside[-1][0], end_m)
    return replace(face, run=replace(face.run, start_m=start_m, end_m=end_m, seen=tuple(inside)))


def joined_corners(faces: tuple[FaceRun, ...], reach_m: float) -> tuple[FaceRun, ...]:
    """Every end that comes within `reach_m` of a fitting perpendicular face is put onto it."""
    return tuple(_cornered(face, faces, reach_m) for face in faces)


def _cornered(face: FaceRun, faces: tuple[FaceRun, ...], reach_m: float) -> FaceRun:
    corners = [_corner(face, faces, direction, reach_m) for direction in (-1, +1)]
    start, end = (free if corner is None else corner.offset_m for free, corner in zip((face.start_m, face.end_m), corners, strict=True))
    if end - start < MIN_SIDE_M:
        return face
    inner = [corner is not None and corner.facing == -direction for corner, direction in zip(corners, (-1, +1), strict=True)]
    cornered = (corners[0] is not None, corners[1] is not None)
    return replace(with_ends(face, start, end), cornered=cornered, inner=(inner[0], inner[1]))


def _corner(face: FaceRun, faces: tuple[FaceRun, ...], direction: int, reach_m: float) -> FaceRun | None:
    """The nearest perpendicular face that this end can meet, or None."""
    at = face.end_m if direction > 0 else face.start_m
    is_open = face.run.open_end if direction > 0 else face.run.open_start
    best: FaceRun | None = None
    for other in faces:
        if other.axis == face.axis or abs(other.offset_m - at) > reach_m:
            continue
        gap = (other.offset_m - at) * direction
        looks_back = other.facing == -direction
        side = face.facing if looks_back else -face.facing  # inner corner, or outer
        # Rays passed beyond this end: it is where it was seen, nothing but a surface that looks back along it can end it elsewhere,
        # or an edge that both surfaces end at: trails of flying points lengthen them.
        edge = not looks_back and gap > -JAMB_MISMATCH_M and _near_end_m(other, face.offset_m, side) < JAMB_MISMATCH_M
        if is_open and (gap > 2 * MIN_SIDE_M or (gap < -2 * MIN_SIDE_M and not looks_back and not edge)):
            continue
        if _reaches_side(other, face.offset_m, side, reach_m) and (best is None or _ends_sooner(face, other, best, direction)):
            best = other
    return best


def _ends_sooner(face: FaceRun, other: FaceRun, best: FaceRun, direction: int) -> bool:
    """Whether a face is the one to end at rather than the best so far: the nearer one, but nothing is seen behind one that looks back."""
    at = face.end_m if direction > 0 else face.start_m
    before = (best.offset_m - other.offset_m) * direction
    if before > 0 and _stops(other, face, direction):
        return True
    if before < 0 and _stops(best, face, direction):
        return False
    return abs(other.offset_m - at) < abs(best.offset_m - at)


def _stops(other: FaceRun, face: FaceRun, direction: int) -> bool:
    """Whether a perpendicular face looks back along another one and goes on across its line, farther than trails of flying points."""
    beyond = min(face.offset_m - other.start_m, other.end_m - face.offset_m)
    return other.facing == -direction and beyond > JAMB_MISMATCH_M


def _reaches_side(face: FaceRun, offset_m: float, side: int, reach_m: float) -> bool:
    """Whether `face` extends to `side` of the line at `offset_m` and comes within `reach_m` of it."""
    far = face.end_m if side > 0 else face.start_m
    near = face.start_m if side > 0 else face.end_m
    return (far - offset_m) * side > MIN_SIDE_M and (near - offset_m) * side < reach_m


def _near_end_m(face: FaceRun, offset_m: float, side: int) -> float:
    """How far the end of `face` that lies away from `side` is from the line at `offset_m`."""
    return abs((face.start_m if side > 0 else face.end_m) - offset_m)


def agreed_jambs(faces: tuple[FaceRun, ...], pairs: tuple[tuple[int, int], ...]) -> tuple[FaceRun, ...]:
    """Free ends of the two faces of one wall that nearly agree are put at their mean."""
    result = list(faces)
    for a, b in pairs:
        first, second = result[a], result[b]
        ends = [[first.start_m, first.end_m], [second.start_m, second.end_m]]
        for k in range(2):
            free = not (first.cornered[k] or second.cornered[k])
            if free and abs(ends[0][k] - ends[1][k]) < JAMB_MISMATCH_M:
                ends[0][k] = ends[1][k] = 0.5 * (ends[0][k] + ends[1][k])
        result[a], result[b] = with_ends(first, *ends[0]), with_ends(second, *ends[1])
    return tuple(result)
