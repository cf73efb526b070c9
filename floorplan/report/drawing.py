"""The plan as shapes of a page: SVG points in metres, y downwards, each shape with the id that its numbers are kept under."""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass

import numpy as np

from floorplan.model.checks import Array
from floorplan.model.plan import Dimension, DimensionRole, Opening, Plan, Point

MARGIN_M = 0.8
TEXT_ABOVE_M = 0.08  # between a dimension's line and its text


@dataclass(frozen=True)
class Shape:
    """One SVG path: `path` its data, `kind` its class, `id` of the thing, `label` what a screen reader says."""

    id: str
    kind: str
    path: str
    label: str


@dataclass(frozen=True)
class Text:
    """One text: `x`, `y` in the page's metres, `turned` for texts that run upwards."""

    id: str
    kind: str
    x: float
    y: float
    text: str
    turned: bool = False


@dataclass(frozen=True)
class Drawing:
    """Shapes from the bottom to the top, texts, and the view box (x, y, width, height)."""

    shapes: tuple[Shape, ...]
    texts: tuple[Text, ...]
    view: tuple[float, float, float, float]


def plan_drawing(plan: Plan) -> Drawing:
    """Everything drawn: rooms, walls, openings, glazing, lines off the axes, dimensions, the path."""
    shapes = (
        *(Shape(r.id, f"room {r.kind}", rings((r.outline, *r.holes)), f"room {r.id} {r.name}") for r in plan.rooms),
        *(Shape(w.id, "fill", rings((w.fill,)), f"wall {w.id}") for w in plan.walls if w.fill),
        *(Shape(w.id, "wall", lines(w.seen), f"wall {w.id}") for w in plan.walls if w.seen),
        *(Shape(w.id, "inferred", lines(w.inferred), f"wall {w.id}, inferred part") for w in plan.walls if w.inferred),
        *(Shape(c.id, "fill", rings((c.outline,)), f"column {c.id}") for c in plan.columns),
        *(Shape(g.id, "glass", lines(((g.start, g.end),)), f"glazing {g.id}") for g in plan.glazing),
        *(Shape(f.id, "free", lines(((f.start, f.end),)), f"wall off the axes {f.id}") for f in plan.free_lines),
        *(Shape(o.id, f"opening {o.kind}", rings((_opening(o),)), f"{o.kind} {o.id}") for o in plan.openings),
        Shape("", "path", track(plan.trajectory.position_m), "path of the sensor"),
        *(Shape(d.id, "dimension", lines((_line(d),)), f"dimension {d.id}") for d in _drawn(plan)),
    )
    stamps = (Text(r.id, "stamp", r.label[0], -r.label[1], f"{r.id} {r.name}".strip()) for r in plan.rooms)
    areas = (Text(r.id, "area", r.label[0], -r.label[1] + 0.35, f"{r.area_m2:.1f} m²") for r in plan.rooms)
    return Drawing(shapes, (*stamps, *areas, *(_dimension_text(d) for d in _drawn(plan))), _view(plan))


def rings(outlines: Iterable[Sequence[Point]]) -> str:
    """Closed outlines as path data."""
    return "".join(f"M{_points(outline)}Z" for outline in outlines if len(outline) > 1)


def lines(polylines: Iterable[Sequence[Point]]) -> str:
    """Open polylines as path data."""
    return "".join(f"M{_points(line)}" for line in polylines if len(line) > 1)


def track(position_m: Array) -> str:
    """A path (N, 2 or 3), thinned to a line that looks the same."""
    step = max(1, len(position_m) // 1500)
    return f"M{_points([(float(p[0]), float(p[1])) for p in position_m[::step]])}" if len(position_m) else ""


def _points(points: Sequence[Point]) -> str:
    return "L".join(f"{x:.3f} {-y:.3f}" for x, y in points)


def _opening(opening: Opening) -> tuple[Point, ...]:
    half = np.array([opening.width_m / 2, max(opening.depth_m, 0.06) / 2])
    dx, dy = half if opening.along_axis == 0 else half[::-1]
    x, y = opening.centre
    return ((x - dx, y - dy), (x + dx, y - dy), (x + dx, y + dy), (x - dx, y + dy))


def _drawn(plan: Plan) -> tuple[Dimension, ...]:
    return tuple(d for d in plan.dimensions if d.role is not DimensionRole.HEIGHT)


def _line(dimension: Dimension) -> tuple[Point, Point]:
    """From face to face through the point that the dimension line passes."""
    across = 1 - dimension.axis
    start, end = list(dimension.start), list(dimension.end)
    start[across] = end[across] = dimension.line[across]
    return (start[0], start[1]), (end[0], end[1])


def _dimension_text(dimension: Dimension) -> Text:
    start, end = _line(dimension)
    x, y = (start[0] + end[0]) / 2, -(start[1] + end[1]) / 2
    text = f"{dimension.distance_m:.3f}"
    return Text(dimension.id, "measure", x, y - TEXT_ABOVE_M, text) if dimension.axis == 0 else Text(
        dimension.id, "measure", x - TEXT_ABOVE_M, y, text, turned=True
    )


def _view(plan: Plan) -> tuple[float, float, float, float]:
    points = [p for wall in plan.walls for line in (*wall.seen, *wall.inferred) for p in line]
    points += [p for room in plan.rooms for p in room.outline] + [p for free in plan.free_lines for p in (free.start, free.end)]
    table = np.array(points or [(float(p[0]), float(p[1])) for p in plan.trajectory.position_m] or [(0.0, 0.0)])
    low, high = table.min(axis=0) - MARGIN_M, table.max(axis=0) + MARGIN_M
    return float(low[0]), float(-high[1]), float(high[0] - low[0]), float(high[1] - low[1])
