"""A row of mullions is glazing, a pillar is a column, and one face is never drawn twice."""

import dataclasses

import numpy as np
import pytest

from tests.plan.box_world import CEILING_M, Box, BoxScan, cast, wall_with_gap

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


def test_a_pier_that_stands_at_a_wall_is_no_column() -> None:
    plan = scanned([(3.8, 4.2, 3.6, 4.0, 0.0, CEILING_M)]).plan()
    assert plan.columns == ()


def test_no_line_is_drawn_twice() -> None:
    plan = scanned([]).plan()
    lines = [tuple(sorted(line)) for wall in plan.walls for line in wall.seen]
    assert len(lines) == len(set(lines)) == 4


def test_a_pane_that_returns_a_few_rays_is_glazing_from_jamb_to_jamb_and_closes_the_room() -> None:
    wall = wall_with_gap(0, 5.0, 5.16, 0.0, 4.0, [(0.6, 3.2, 2.2)])
    scan = scanned(wall, right_m=4.4)
    assert len(scan.plan().rooms) == 1  # an open gap joins
    plan = with_pane(scan, 5.08, 0.6, 3.2).plan()
    (glass,) = plan.glazing
    assert sorted((glass.start[1], glass.end[1])) == pytest.approx([0.6, 3.2], abs=0.02)
    assert glass.start[0] == glass.end[0] == pytest.approx(5.08, abs=0.01)
    assert len(plan.rooms) == 2
    assert not plan.openings


def with_pane(scan: BoxScan, x_m: float, low_m: float, high_m: float) -> BoxScan:
    """One ray in twelve through the strip from `low_m` to `high_m` at `x_m` comes back from there and belongs to no segment."""
    evidence = scan.segmented.evidence
    frame = np.repeat(np.arange(len(evidence.start) - 1), np.diff(evidence.start))
    at, ray = scan.trajectory.position_m[frame], evidence.point_sensor_m.astype(float)
    with np.errstate(divide="ignore", invalid="ignore"):
        share = (x_m - at[:, 0]) / ray[:, 0]
    y, z = at[:, 1] + share * ray[:, 1], at[:, 2] + share * ray[:, 2]
    crossing = np.flatnonzero((share > 0) & (share < 1) & (y > low_m) & (y < high_m) & (z > 0.1) & (z < 2.2))[::12]
    point, segment = ray.copy(), np.array(evidence.segment)
    point[crossing] *= share[crossing, None]
    segment[crossing] = -1
    returned = dataclasses.replace(evidence, point_sensor_m=point, segment=segment)
    return dataclasses.replace(scan, segmented=dataclasses.replace(scan.segmented, evidence=returned))


def test_a_slender_pier_between_two_openings_is_wall_only_in_line_with_walls() -> None:
    wall = wall_with_gap(0, 5.0, 5.16, 0.0, 4.0, [(0.8, 1.7, 2.1), (1.85, 2.75, 2.1)])
    plan = scanned(wall).plan()
    piers = [w for w in plan.walls if w.fill and np.ptp(np.array(w.fill)[:, 1]) == pytest.approx(0.15, abs=0.02)]
    assert len(piers) == 1
    assert len([opening for opening in plan.openings if opening.kind == "door"]) == 2
    assert len(plan.rooms) == 2
    alone = scanned([(5.0, 5.16, 1.7, 1.85, 0.0, CEILING_M)]).plan()
    assert not [w for w in alone.walls if any(4.9 < x < 5.3 for line in w.seen for x, _ in line if 0.1 < line[0][1] < 3.9)]
