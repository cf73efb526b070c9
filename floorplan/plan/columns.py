"""Free-standing columns: short bodies that no other wall touches or stands close behind, with a face on three sides at least."""

from floorplan.model.plan import Column
from floorplan.plan.bodies import Body
from floorplan.plan.corners import FaceRun

MAX_SIDE_M = 1.2  # longer it is a piece of wall
MAX_STRETCH = 2.5  # times as long as wide: more is a stub of wall
SAME_EDGE_M = 1e-3
MIN_CLEARANCE_M = 0.10  # nearer to a wall it is a pier of it


def column_bodies(bodies: tuple[Body, ...], faces: tuple[FaceRun, ...]) -> tuple[Body, ...]:
    """The bodies that are columns: both sides seen over their whole length, an end seen, nothing else touching."""
    return tuple(body for body in bodies if _is_column(body, bodies, faces))


def as_columns(bodies: tuple[Body, ...]) -> tuple[Column, ...]:
    """Columns C1.. as they are drawn; the two bodies of a column seen from all sides are one."""
    outlines = {tuple(sorted(_corners(body))): _corners(body) for body in bodies}
    return tuple(Column(f"C{k + 1}", outlines[key]) for k, key in enumerate(sorted(outlines)))


def column_faces(columns: tuple[Body, ...], faces: tuple[FaceRun, ...]) -> frozenset[int]:
    """Faces (indices) that are sides of columns."""
    return frozenset(k for k, face in enumerate(faces) if any(_is_side(face, body) for body in columns))


def _corners(body: Body) -> tuple[tuple[float, float], ...]:
    return tuple((float(x), float(y)) for x, y in list(body.rectangle.exterior.coords)[:-1])


def _is_side(face: FaceRun, body: Body) -> bool:
    x0, y0, x1, y1 = body.rectangle.bounds
    low, high = ((x0, x1), (y0, y1))[face.axis], ((x0, x1), (y0, y1))[1 - face.axis]
    on_edge = min(abs(face.offset_m - edge) for edge in low) < SAME_EDGE_M
    return bool(on_edge and face.start_m >= high[0] - SAME_EDGE_M and face.end_m <= high[1] + SAME_EDGE_M)


def _is_column(body: Body, bodies: tuple[Body, ...], faces: tuple[FaceRun, ...]) -> bool:
    sides = sorted((body.end_m - body.start_m, body.thickness_m))
    if sides[1] > min(MAX_SIDE_M, MAX_STRETCH * sides[0]):
        return False
    whole = all(
        max(abs(faces[k].start_m - body.start_m), abs(faces[k].end_m - body.end_m)) < SAME_EDGE_M for k in (body.low_face, body.high_face)
    )
    ends = _end_face(body, faces, -1) or _end_face(body, faces, +1)
    shape = body.rectangle
    alone = all(other.rectangle.equals(shape) or other.rectangle.distance(shape) > SAME_EDGE_M for other in bodies)
    return whole and ends and alone and not any(_is_near(face, body) for face in faces)


def _is_near(face: FaceRun, body: Body) -> bool:
    """Whether a face that is no side of the body stands within the clearance of it."""
    x0, y0, x1, y1 = body.rectangle.bounds
    low, high = ((x0, x1), (y0, y1))[face.axis], ((x0, x1), (y0, y1))[1 - face.axis]
    across = max(low[0] - face.offset_m, face.offset_m - low[1])
    along = max(high[0] - face.end_m, face.start_m - high[1])
    return max(across, along) < MIN_CLEARANCE_M and not _is_side(face, body)


def _end_face(body: Body, faces: tuple[FaceRun, ...], direction: int) -> bool:
    at = body.end_m if direction > 0 else body.start_m
    return any(
        face.axis != body.axis
        and face.facing == direction
        and abs(face.offset_m - at) < SAME_EDGE_M
        and face.start_m <= body.low_m + SAME_EDGE_M
        and face.end_m >= body.high_m - SAME_EDGE_M
        and face.end_m - face.start_m <= MAX_SIDE_M
        for face in faces
    )
