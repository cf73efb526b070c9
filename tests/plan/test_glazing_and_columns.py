"""A row of mullions is glazing, a pillar is a column, and one face is never drawn twice."""

import dataclasses

import numpy as np
import pytest

from tests.plan.box_world import CEILING_M, Box, BoxScan, cast

SHELL: list[Box] = [
    (-0.2, 8.2, 4.0, 4.2, 0.0, CEILING_M),
    (-0.2, 8.2, -0.2, 0.0, 0.0, CEILING_M),
    (-0.2, 0.0, 0.0, 4.0, 0.0, CEILING_M),
    (8.0, 8.2, 0.0, 4.0, 0.0, CEILING_M),
]


def scanned(extra: list[Box], right_m: float = 7.4) -> BoxScan:
    return cast([*SHELL, *extra], [(x, y) for x in np.linspace(0.6, right_m, 12) for y in (0.7, 3.2)])


def without_post_segments(scan: BoxScan, low_m: float, high_m: float) -> BoxScan:
    """Points near the posts belong to no segment, as a front end leaves slender things."""
    evidence = scan.segmented.evidence
    frame = np.repeat(np.arange(len(evidence.start) - 1), np.diff(evidence.start))
    x = evidence.point_sensor_m[:, 0] + scan.trajectory.position_m[frame, 0]
    y = evidence.point_sensor_m[:, 1] + scan.trajectory.position_m[frame, 1]
    loose = (x > low_m) & (x < high_m) & (y > 0.05) & (y < 3.95)
    segment = np.where(loose, -1, evidence.segment)
    return dataclasses.replace(scan, segmented=dataclasses.replace(scan.segmented, evidence=dataclasses.replace(evidence, segment=segment)))


def test_posts_with_rays_between_them_are_glazing_that_closes_the_room() -> None:
    posts: list[Box] = [(4.97, 5.03, y - 0.03, y + 0.03, 0.0, CEILING_M) for y in (0.8, 1.6, 2.4, 3.2)]
    plan = without_post_segments(scanned(posts, right_m=4.0), 4.9, 5.1).plan()
    (glass,) = plan.glazing
    width = plan.rooms[0].outline
    assert abs(glass.start[1] - glass.end[1]) == pytest.approx(4.0, abs=0.02)
    assert max(x for x, _ in width) - min(x for x, _ in width) < 8.0


def test_a_pillar_is_a_column_of_its_size() -> None:
    plan = scanned([(3.8, 4.2, 1.7, 2.1, 0.0, CEILING_M)]).plan()
    (column,) = plan.columns
    size = np.ptp(np.array(column.outline), axis=0)
    assert size == pytest.approx([0.4, 0.4], abs=0.01)


def test_no_line_is_drawn_twice() -> None:
    plan = scanned([]).plan()
    lines = [tuple(sorted(line)) for wall in plan.walls for line in wall.seen]
    assert len(lines) == len(set(lines)) == 4
