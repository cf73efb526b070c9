"""Everything that is decided once for all drawings of a plan: sheet, scale, where it lies, where its words go."""

import itertools
from dataclasses import dataclass

from floorplan.config import DrawingConfig
from floorplan.errors import ConfigError
from floorplan.model.plan import DimensionRole, Plan, Point
from floorplan.writers.chain_layout import place_chains
from floorplan.writers.dimension_layout import place_sizes
from floorplan.writers.door_symbol import DoorSymbol, door_symbols
from floorplan.writers.layers import Layer, LayerStyle, layer_styles
from floorplan.writers.occupancy import LINE_WEIGHT, STAMP_WEIGHT, SYMBOL_WEIGHT, TEXT_WEIGHT, WALL_WEIGHT, Occupancy, Rectangle
from floorplan.writers.open_sides import open_sides
from floorplan.writers.placed_dimension import PlacedDimension
from floorplan.writers.scale import Scale, choose_scale
from floorplan.writers.sheet_size import Sheet, sheet_named
from floorplan.writers.stamp_layout import PlacedStamp, place_stamps, stamp_lines, stamp_rectangle
from floorplan.writers.unit_style import UnitStyle, unit_style

PROFILES = ("", "cafm")
DXF_VERSIONS = ("R2000", "R2004", "R2007", "R2010", "R2013", "R2018")
CAFM_DXF_VERSION = "R2000"
EMPTY_PLAN_M = 5.0  # half the side of the empty field shown when there is nothing to draw
FIELD_MARGIN_MM = 4.0  # words of sizes may stand this far outside the outermost wall, before the chains begin
PIECE_M = 0.5  # oblique lines are cut into pieces of this length before they become boxes


@dataclass(frozen=True)
class Composition:
    """A plan laid out on a sheet. `paper_origin_mm` is where the plan's origin falls; placed things are in plan metres."""

    plan: Plan
    sheet: Sheet
    scale: Scale
    units: UnitStyle
    layers: dict[Layer, LayerStyle]
    extents: Rectangle
    paper_origin_mm: Point
    dimensions: tuple[PlacedDimension, ...]
    stamps: tuple[PlacedStamp, ...]
    doors: tuple[DoorSymbol, ...]
    strict: bool  # cafm: what strict importers demand
    open_sides: tuple[tuple[Point, ...], ...] = ()

    @property
    def left_off(self) -> tuple[str, ...]:
        """Ids of the dimensions that found no place at this scale; tables and `plan.json` have them."""
        drawn = {placed.dimension.id for placed in self.dimensions}
        return tuple(d.id for d in self.plan.dimensions if d.axis < 2 and d.role != DimensionRole.HEIGHT and d.id not in drawn)

    def paper(self, point: Point) -> Point:
        """Plan metres to paper millimetres."""
        return (
            self.paper_origin_mm[0] + self.scale.paper_mm(point[0]),
            self.paper_origin_mm[1] + self.scale.paper_mm(point[1]),
        )


def compose(plan: Plan, drawing: DrawingConfig) -> Composition:
    """Lay the plan out; raises ConfigError for settings that do not exist or do not fit."""
    if drawing.profile not in PROFILES:
        raise ConfigError(f"drawing.profile = {drawing.profile!r}: use 'cafm' or leave it empty")
    strict = drawing.profile == "cafm"
    units = unit_style("m" if strict else drawing.units)
    sheet = sheet_named(drawing.sheet)
    extents = plan_extents(plan)

    def drawn(scale: Scale) -> Rectangle:
        return drawn_extents(plan, extents, scale, units)

    scale = choose_scale(drawing.scale, drawn, sheet.drawing, units.metric)
    doors = door_symbols(plan)
    chains = place_chains(plan, extents, scale, units)
    whole = drawn(scale)
    occupied = obstacles(plan, doors, scale)
    _add_dimensions(chains, occupied)
    _add_provisional_stamps(plan, scale, units, occupied)
    sizes = place_sizes(plan, extents.grown(scale.model_m(FIELD_MARGIN_MM)), scale, units, occupied)
    final = obstacles(plan, doors, scale)
    _add_dimensions((*chains, *sizes), final)
    centre = sheet.drawing.centre
    middle = (whole.x0 + whole.x1) / 2, (whole.y0 + whole.y1) / 2
    placed = {one.dimension.id: one for one in (*chains, *sizes)}
    return Composition(
        plan=plan,
        sheet=sheet,
        scale=scale,
        units=units,
        layers=layer_styles(drawing.layers),
        extents=whole,
        paper_origin_mm=(centre[0] - scale.paper_mm(middle[0]), centre[1] - scale.paper_mm(middle[1])),
        dimensions=tuple(placed[dimension.id] for dimension in plan.dimensions if dimension.id in placed),
        stamps=place_stamps(plan, scale, units, final),
        doors=doors,
        strict=strict,
        open_sides=open_sides(plan),
    )


def _add_dimensions(dimensions: tuple[PlacedDimension, ...], occupied: Occupancy) -> None:
    for placed in dimensions:
        occupied.add(placed.text_box, TEXT_WEIGHT)
        occupied.add(placed.line_box, LINE_WEIGHT)
        if placed.leader is not None:
            occupied.add(Rectangle.around(placed.leader), LINE_WEIGHT)


def drawn_extents(plan: Plan, extents: Rectangle, scale: Scale, units: UnitStyle) -> Rectangle:
    """The box around the plan and its chains as a scale spaces them."""
    return extents.joined(box for one in place_chains(plan, extents, scale, units) for box in (one.text_box, one.line_box))


def plan_extents(plan: Plan) -> Rectangle:
    """The box around all that is drawn in true size."""
    points = [point for line in _solid_lines(plan) for point in line]
    points += [point for room in plan.rooms for point in room.outline]
    points += [point for ring in plan.gross_outline for point in ring]
    if not points:
        return Rectangle(-EMPTY_PLAN_M, -EMPTY_PLAN_M, EMPTY_PLAN_M, EMPTY_PLAN_M)
    return Rectangle.around(points)


def _solid_lines(plan: Plan) -> list[tuple[Point, ...]]:
    lines = [line for wall in plan.walls for line in (*wall.seen, *wall.inferred)]
    lines += [(line.start, line.end) for line in plan.free_lines]
    lines += [(glazing.start, glazing.end) for glazing in plan.glazing]
    lines += [(*column.outline, column.outline[0]) for column in plan.columns]
    return lines


def obstacles(plan: Plan, doors: tuple[DoorSymbol, ...], scale: Scale) -> Occupancy:
    """The plan's own lines as boxes."""
    occupied = Occupancy()
    half_pen = scale.model_m(0.25)
    for line in _solid_lines(plan):
        for start, end in itertools.pairwise(line):
            for piece in _pieces(start, end):
                occupied.add(Rectangle.around(piece, half_pen), WALL_WEIGHT)
    for door in doors:
        swing = door.placed(((-0.5, 0.0), (0.5, 0.0), (-0.5, 1.0), (0.5, 1.0)))
        occupied.add(Rectangle.around(swing), SYMBOL_WEIGHT)
    return occupied


def _pieces(start: Point, end: Point) -> list[tuple[Point, Point]]:
    """The line whole when it runs along an axis, else in short pieces, whose boxes hug it."""
    dx, dy = end[0] - start[0], end[1] - start[1]
    count = 1 if min(abs(dx), abs(dy)) < PIECE_M / 10 else max(1, round((abs(dx) + abs(dy)) / PIECE_M))
    points = [(start[0] + dx * step / count, start[1] + dy * step / count) for step in range(count + 1)]
    return list(itertools.pairwise(points))


def _add_provisional_stamps(plan: Plan, scale: Scale, units: UnitStyle, occupied: Occupancy) -> None:
    for room in plan.rooms:
        stamp = PlacedStamp(room, stamp_lines(room, units), room.label, 1.0)
        occupied.add(stamp_rectangle(stamp, scale), STAMP_WEIGHT)
