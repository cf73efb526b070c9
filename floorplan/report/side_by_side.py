"""Storeys beside each other as one plan, for a page that draws them all in one picture."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from floorplan.model.plan import Plan, Point
from floorplan.model.scan import Trajectory

BETWEEN_M = 2.0  # free space between two storeys


def side_by_side(plan: Plan) -> Plan:
    """One flat plan: every upper storey stands to the right of the one below it; a plan of one storey as it is."""
    if not plan.upper_storeys:
        return plan
    placed = [replace(plan, upper_storeys=())]
    for storey in plan.upper_storeys:
        edge = max(x for x, _ in _corners(placed[-1]))
        placed.append(_moved(storey, edge + BETWEEN_M - min(x for x, _ in _corners(storey))))
    return replace(
        placed[0],
        faces=tuple(face for storey in placed for face in storey.faces),
        walls=tuple(wall for storey in placed for wall in storey.walls),
        free_lines=tuple(line for storey in placed for line in storey.free_lines),
        glazing=tuple(pane for storey in placed for pane in storey.glazing),
        openings=tuple(opening for storey in placed for opening in storey.openings),
        rooms=tuple(room for storey in placed for room in storey.rooms),
        columns=tuple(column for storey in placed for column in storey.columns),
        dimensions=tuple(dimension for storey in placed for dimension in storey.dimensions),
        notes=tuple(f"{storey.level}: {note}" for storey in placed for note in storey.notes),
        rejections=tuple(rejection for storey in placed for rejection in storey.rejections),
    )


def _corners(plan: Plan) -> list[Point]:
    points = [point for wall in plan.walls for line in (*wall.seen, *wall.inferred) for point in line]
    points += [point for room in plan.rooms for point in room.outline]
    return points or [(0.0, 0.0)]


def _moved(plan: Plan, by_m: float) -> Plan:
    def at(point: Point) -> Point:
        return point[0] + by_m, point[1]

    def along(points: Sequence[Point]) -> tuple[Point, ...]:
        return tuple(at(point) for point in points)

    path = plan.trajectory
    return replace(
        plan,
        trajectory=Trajectory(path.stamp_ns, path.position_m + np.array([by_m, 0.0, 0.0]), path.world_from_sensor),
        faces=tuple(replace(f, start=at(f.start), end=at(f.end)) for f in plan.faces),
        walls=tuple(
            replace(w, seen=tuple(map(along, w.seen)), inferred=tuple(map(along, w.inferred)), fill=along(w.fill)) for w in plan.walls
        ),
        free_lines=tuple(replace(f, start=at(f.start), end=at(f.end)) for f in plan.free_lines),
        glazing=tuple(replace(g, start=at(g.start), end=at(g.end)) for g in plan.glazing),
        openings=tuple(replace(o, centre=at(o.centre)) for o in plan.openings),
        rooms=tuple(replace(r, outline=along(r.outline), holes=tuple(map(along, r.holes)), label=at(r.label)) for r in plan.rooms),
        columns=tuple(replace(c, outline=along(c.outline)) for c in plan.columns),
        dimensions=tuple(replace(d, start=at(d.start), end=at(d.end), line=at(d.line)) for d in plan.dimensions),
    )
