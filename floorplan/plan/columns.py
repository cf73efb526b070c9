"""Free-standing columns: bodies with a face on all four sides."""

from floorplan.model.plan import Column
from floorplan.plan.bodies import Body
from floorplan.plan.corners import FaceRun

MAX_SIDE_M = 1.2  # longer it is a piece of wall
SAME_EDGE_M = 1e-3


def find_columns(bodies: tuple[Body, ...], faces: tuple[FaceRun, ...]) -> tuple[Column, ...]:
    """Columns C1..: short bodies whose two ends are faces looking outwards."""
    outlines = []
    for body in bodies:
        if body.end_m - body.start_m <= MAX_SIDE_M and _end_face(body, faces, -1) and _end_face(body, faces, +1):
            corners = tuple((float(x), float(y)) for x, y in list(body.rectangle.exterior.coords)[:-1])
            if sorted(corners) not in [sorted(other) for other in outlines]:
                outlines.append(corners)
    return tuple(Column(f"C{k + 1}", outline) for k, outline in enumerate(sorted(outlines)))


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
