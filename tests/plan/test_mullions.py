"""Rows of broad mullions are a glass wall; a single post between two doors is not."""

import numpy as np

from floorplan.plan.corners import FaceRun
from floorplan.plan.faces import Run
from floorplan.plan.gaps import Gap
from floorplan.plan.glazing import GlazedLine
from floorplan.plan.mullions import mullion_rows, unglazed

WALKED_ELSEWHERE = np.array([(0.0, 2.0), (9.0, 2.0)])


def wall_of(*pieces: tuple[float, float]) -> tuple[tuple[FaceRun, ...], tuple[Gap, ...]]:
    """Pieces of one surface along x at y = 0, and the gaps between them that rays passed."""
    faces = tuple(FaceRun(Run(0, a, b, ((a, b),), 0.0, 2.6, 9.0), 1, 1, 0.0, 0.001) for a, b in pieces)
    gaps = tuple(Gap(k, k + 1, faces[k].end_m, faces[k + 1].start_m, 1.0, True, 2.2, None, True) for k in range(len(faces) - 1))
    return faces, gaps


def test_slender_pieces_at_regular_distances_are_one_glass_wall_without_doors() -> None:
    faces, gaps = wall_of((0.0, 2.0), (3.0, 3.15), (4.0, 4.12), (5.02, 5.2), (6.1, 9.0))
    rows = mullion_rows(faces, gaps)
    assert rows == (GlazedLine(1, 0.0, 2.0, 6.1),)
    assert unglazed(gaps, faces, rows, WALKED_ELSEWHERE) == ()


def test_a_pane_that_was_walked_through_stays_an_opening() -> None:
    faces, gaps = wall_of((0.0, 2.0), (3.0, 3.15), (4.0, 4.12), (5.02, 5.2), (6.1, 9.0))
    path = np.array([(3.5, 1.0), (3.5, -1.0)])
    assert unglazed(gaps, faces, mullion_rows(faces, gaps), path) == (gaps[1],)


def test_one_post_or_pieces_at_no_regular_distance_are_no_glass_wall() -> None:
    for pieces in (((0.0, 2.0), (3.0, 3.15), (4.0, 9.0)), ((0.0, 2.0), (2.7, 2.8), (4.2, 4.3), (4.9, 5.0), (6.5, 9.0))):
        faces, gaps = wall_of(*pieces)
        assert mullion_rows(faces, gaps) == ()
        assert unglazed(gaps, faces, (), WALKED_ELSEWHERE) == gaps
