"""Where the chains outside the plan go: one line per side, words over their bay or in rows beyond it, the overall length outermost."""

from collections import defaultdict
from dataclasses import dataclass, field

from floorplan.model.plan import Dimension, DimensionRole, Plan, Point, Room
from floorplan.writers.dimension_spots import CLEARANCE_MM, TEXT_GAP_MM, TEXT_HEIGHT_MM, point_at, span
from floorplan.writers.occupancy import Rectangle
from floorplan.writers.placed_dimension import PlacedDimension, dimension_label
from floorplan.writers.scale import Scale
from floorplan.writers.text_size import text_width
from floorplan.writers.unit_style import UnitStyle

OUTSIDE = (DimensionRole.CHAIN, DimensionRole.OVERALL)
FIRST_LINE_MM = 8.0  # from the plan to the chain: room for the words over a bay, and for door swings that open outwards
ROW_MM = TEXT_HEIGHT_MM + 2 * CLEARANCE_MM  # between rows of words
NEXT_LINE_MM = 5.5  # from the outermost words of one line to the next line
MOST_ROWS = 3  # a chain with more rows of words beyond it hides the plan; what finds no place is left to the table
SLIDES = (0.0, 0.25, -0.25, 0.45, -0.45)  # of its width, how far a text may stand aside of its bay


@dataclass(frozen=True)
class Track:
    """A side of the plan: lines run along `axis`, `sign` says which way out is; `edge_m` of the plan there; `lined` words stand outside."""

    axis: int
    sign: float
    edge_m: float

    @property
    def words_outside(self) -> bool:
        """Words stand over horizontal lines and to the left of upright ones: outside at the top and on the left."""
        return (self.sign > 0) == (self.axis == 0)


@dataclass
class _Line:
    """Words placed so far along one line, as boxes in (along, out) from the line, metres; `reach_m` the farthest out."""

    boxes: list[Rectangle] = field(default_factory=list)
    reach_m: float = 0.0

    def take(self, box: Rectangle) -> None:
        self.boxes.append(box)
        self.reach_m = max(self.reach_m, box.y1)

    def free(self, box: Rectangle) -> bool:
        return not any(box.x0 < b.x1 and b.x0 < box.x1 and box.y0 < b.y1 and b.y0 < box.y1 for b in self.boxes)


def place_chains(plan: Plan, extents: Rectangle, scale: Scale, units: UnitStyle) -> tuple[PlacedDimension, ...]:
    """All chains and overall dimensions of a plan whose walls and rooms lie in `extents`, in the plan's order."""
    sides: dict[tuple[int, float], list[Dimension]] = defaultdict(list)
    for dimension in outside(plan):
        sides[dimension.axis, _outward(dimension, extents)].append(dimension)
    placed: dict[str, PlacedDimension] = {}
    for (axis, sign), dimensions in sides.items():
        track = Track(axis, sign, _edge(extents, axis, sign))
        out = scale.model_m(FIRST_LINE_MM)
        whole = [d for d in dimensions if d.role is DimensionRole.OVERALL or _spans_another(d, dimensions)]
        for members in ([d for d in dimensions if d not in whole], whole):
            if members:
                line = _Line()
                for one in _placed_line(members, track, out, line, scale, units):
                    placed[one.dimension.id] = one
                out += line.reach_m + scale.model_m(NEXT_LINE_MM)
    return tuple(placed[d.id] for d in plan.dimensions if d.id in placed)


def outside(plan: Plan) -> tuple[Dimension, ...]:
    """The dimensions that stand outside: chains, lengths over all, and sizes of rooms that a chain took over, whose line left the room."""
    rooms = {room.id: room for room in plan.rooms}
    return tuple(d for d in plan.dimensions if d.axis < 2 and (d.role in OUTSIDE or _has_left(d, rooms.get(d.room))))


def _has_left(dimension: Dimension, room: Room | None) -> bool:
    if room is None or dimension.role is not DimensionRole.ROOM:
        return False
    across = [point[1 - dimension.axis] for point in room.outline]
    return not min(across) <= dimension.line[1 - dimension.axis] <= max(across)


def _spans_another(dimension: Dimension, others: list[Dimension]) -> bool:
    """Whether a dimension runs over one of `others`: then it is the length over all, whatever room it is the size of as well."""
    low, high = span(dimension)
    return any(low <= span(d)[0] and span(d)[1] <= high for d in others if d is not dimension and span(d) != (low, high))


def _outward(dimension: Dimension, extents: Rectangle) -> float:
    middle = (extents.y0 + extents.y1) / 2 if dimension.axis == 0 else (extents.x0 + extents.x1) / 2
    return 1.0 if dimension.line[1 - dimension.axis] >= middle else -1.0


def _edge(extents: Rectangle, axis: int, sign: float) -> float:
    low, high = (extents.y0, extents.y1) if axis == 0 else (extents.x0, extents.x1)
    return high if sign > 0 else low


def _placed_line(
    dimensions: list[Dimension], track: Track, out: float, line: _Line, scale: Scale, units: UnitStyle
) -> list[PlacedDimension]:
    """Those whose words fit their bay first, then the others, each in the nearest row that is free."""
    widths = {d.id: scale.model_m(text_width(dimension_label(d, units), TEXT_HEIGHT_MM)) for d in dimensions}
    ends = [end for d in dimensions for end in span(d)]
    clear = scale.model_m(CLEARANCE_MM)
    found = []
    for dimension in sorted(dimensions, key=lambda d: widths[d.id] > span(d)[1] - span(d)[0]):
        low, high = span(dimension)
        fits = widths[dimension.id] + 2 * clear <= high - low
        box = _over_the_bay(low, high, widths[dimension.id], track, scale)
        if not fits or not line.free(box):
            aside = _beyond(low, high, widths[dimension.id], (min(ends), max(ends)), track, line, scale)
            if aside is None:
                continue
            box = aside
        line.take(box)
        found.append(_settled(dimension, box, track, out, scale, units))
    return found


def _box(along: float, out: float, width: float, scale: Scale) -> Rectangle:
    """The box of words about a centre."""
    clear, height = scale.model_m(CLEARANCE_MM), scale.model_m(TEXT_HEIGHT_MM)
    return Rectangle.centred((along, out), width + 2 * clear, height + clear)


def _over_the_bay(low: float, high: float, width: float, track: Track, scale: Scale) -> Rectangle:
    offset = scale.model_m(TEXT_GAP_MM + TEXT_HEIGHT_MM / 2)
    return _box((low + high) / 2, offset if track.words_outside else -offset, width, scale)


def _beyond(low: float, high: float, width: float, ends: tuple[float, float], track: Track, line: _Line, scale: Scale) -> Rectangle | None:
    """Outside the line, as near its bay as there is room; not across the extension lines of the overall length at `ends`."""
    offset = scale.model_m(TEXT_GAP_MM + TEXT_HEIGHT_MM / 2 + CLEARANCE_MM)
    middle = (low + high) / 2
    rows = range(1 if track.words_outside else 0, MOST_ROWS)
    tries = [_box(middle + slide * width, offset + row * scale.model_m(ROW_MM), width, scale) for row in rows for slide in SLIDES]
    inside = [box for box in tries if not any(box.x0 < end < box.x1 for end in ends)]
    for box in inside or tries:
        if line.free(box) and line.free(Rectangle(middle, 0.0, middle, box.y0)):
            return box
    return None


def _settled(dimension: Dimension, box: Rectangle, track: Track, out: float, scale: Scale, units: UnitStyle) -> PlacedDimension:
    """From (along, out of the line) to the plan; words beyond the line have a leader from the middle of their bay."""
    axis, (low, high) = track.axis, span(dimension)
    across = track.edge_m + track.sign * out
    ends = point_at(axis, dimension.start[axis], across), point_at(axis, dimension.end[axis], across)
    centre = (box.x0 + box.x1) / 2, (box.y0 + box.y1) / 2
    reading = scale.model_m(TEXT_GAP_MM + TEXT_HEIGHT_MM / 2)
    beyond = abs(centre[1]) > 1.01 * reading
    leader = _leader(axis, (low + high) / 2, across, across + track.sign * box.y0) if beyond else None
    corners = point_at(axis, box.x0, across + track.sign * box.y0), point_at(axis, box.x1, across + track.sign * box.y1)
    return PlacedDimension(
        dimension=dimension,
        text=dimension_label(dimension, units),
        line=ends,
        line_reach=ends,
        text_centre=point_at(axis, centre[0], across + track.sign * centre[1]),
        text_rotation_deg=90.0 * axis,
        extended=(True, True),
        text_box=Rectangle.around(corners),
        line_box=Rectangle.around(ends, scale.model_m(CLEARANCE_MM / 2)),
        leader=leader,
    )


def _leader(axis: int, along: float, line: float, words: float) -> tuple[Point, Point]:
    return point_at(axis, along, line), point_at(axis, along, words)
