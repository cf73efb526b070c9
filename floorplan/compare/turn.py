"""A plan in another plan's frame: quarter turns about the origin, then a shift."""

from collections.abc import Iterable
from dataclasses import replace

import numpy as np

from floorplan.model.checks import Array
from floorplan.model.plan import Plan, PlanPlane, Point

COS, SIN = (1, 0, -1, 0), (0, 1, 0, -1)  # of 0 to 3 quarter turns


def turned_plan(plan: Plan, quarters: int, shift_m: Array) -> Plan:
    """Planes, faces, walls, openings, rooms, lines and columns turned counter-clockwise, then shifted by (3,).

    Dimensions keep their planes and values; their points and the trajectory are left where they were. Offsets of one axis all keep
    or all change their sign, so the covariance stays.
    """

    def point(at: Point) -> Point:
        cos, sin = COS[quarters % 4], SIN[quarters % 4]
        return cos * at[0] - sin * at[1] + float(shift_m[0]), sin * at[0] + cos * at[1] + float(shift_m[1])

    def ring(points: Iterable[Point]) -> tuple[Point, ...]:
        return tuple(point(at) for at in points)

    return replace(
        plan,
        planes=tuple(_plane(plane, quarters, shift_m) for plane in plan.planes),
        faces=tuple(replace(f, start=point(f.start), end=point(f.end)) for f in plan.faces),
        walls=tuple(
            replace(w, seen=tuple(map(ring, w.seen)), inferred=tuple(map(ring, w.inferred)), fill=ring(w.fill)) for w in plan.walls
        ),
        openings=tuple(replace(o, centre=point(o.centre), along_axis=(o.along_axis + quarters) % 2) for o in plan.openings),
        rooms=tuple(
            replace(r, outline=ring(r.outline), holes=tuple(map(ring, r.holes)), label=point(r.label)) for r in plan.rooms
        ),
        free_lines=tuple(replace(f, start=point(f.start), end=point(f.end)) for f in plan.free_lines),
        glazing=tuple(replace(g, start=point(g.start), end=point(g.end)) for g in plan.glazing),
        columns=tuple(replace(c, outline=ring(c.outline)) for c in plan.columns),
    )


def _plane(plane: PlanPlane, quarters: int, shift_m: Array) -> PlanPlane:
    axis, sign, extent = plane.axis, 1, plane.extent_m
    for _ in range(quarters % 4):  # +x becomes +y, +y becomes -x
        sign = -sign if axis == 1 else sign
        axis = axis if axis == 2 else 1 - axis
        extent = ((-extent[1][1], -extent[1][0]), extent[0], extent[2])
    low = np.array(extent) + np.asarray(shift_m)[:, None]
    x, y, z = (tuple(map(float, row)) for row in low)
    offset = sign * plane.offset_m + float(shift_m[axis])
    return replace(plane, axis=axis, facing=sign * plane.facing, offset_m=offset, extent_m=((x[0], x[1]), (y[0], y[1]), (z[0], z[1])))
