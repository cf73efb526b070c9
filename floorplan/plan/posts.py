"""Piers between two openings: too slender to be told from clutter but for the wall they stand in line with."""

from floorplan.plan.corners import FaceRun
from floorplan.plan.surface_evidence import MAX_LINE_GAP_M, SAME_SURFACE_M


def standing_posts(slender: tuple[FaceRun, ...], walls: tuple[FaceRun, ...]) -> tuple[FaceRun, ...]:
    """Those of the slender pieces that stand in a gap of a wall: runs of the same surface on both sides of it."""
    return tuple(post for post in slender if not _known(post, walls) and _continued(post, walls, -1) and _continued(post, walls, +1))


def _known(post: FaceRun, walls: tuple[FaceRun, ...]) -> bool:
    return any(wall.run.plane == post.run.plane and wall.overlap_m(post) > 0 for wall in walls)


def _continued(post: FaceRun, walls: tuple[FaceRun, ...], direction: int) -> bool:
    for wall in walls:
        in_line = wall.axis == post.axis and wall.facing == post.facing and abs(wall.offset_m - post.offset_m) <= SAME_SURFACE_M
        ahead = (wall.start_m - post.end_m) if direction > 0 else (post.start_m - wall.end_m)
        if in_line and 0 < ahead <= MAX_LINE_GAP_M:
            return True
    return False
