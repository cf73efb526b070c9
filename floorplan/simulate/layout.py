"""A random building of a preset: corridors on a grid, rooms along them, doors, windows."""

from dataclasses import dataclass, field

import numpy as np
from shapely.geometry import Polygon
from shapely.ops import unary_union

from floorplan.simulate.building import Building, Opening, OpeningKind, Rect, Space, SpaceKind, rect_along
from floorplan.simulate.presets import Preset

DOOR_WIDTH_M = (0.78, 1.02)
DOOR_HEAD_M = (2.0, 2.14)
DOOR_CORNER_M = 0.25  # a door stands at least this far from the corner of its room
MIN_ROOM_WIDTH_M = 2.2
MIN_ROW_DEPTH_M = 2.4
INNER_WALL_M = (0.09, 0.24)
OUTER_WALL_M = (0.28, 0.42)


@dataclass(frozen=True)
class CorridorGrid:
    """Corridors as bands: `bands_x` are the x ranges of those that run along y, `bands_y` the y ranges of the others."""

    bands_x: tuple[tuple[float, float], ...]
    bands_y: tuple[tuple[float, float], ...]
    bounds: Rect  # of the free corridor area

    @property
    def rects(self) -> list[Rect]:
        """One rectangle per corridor, each over the whole bounds."""
        upright = [Rect(x0, self.bounds.y0, x1, self.bounds.y1) for x0, x1 in self.bands_x]
        return upright + [Rect(self.bounds.x0, y0, self.bounds.x1, y1) for y0, y1 in self.bands_y]

    @property
    def outline(self) -> Polygon:
        """The free area of all corridors together."""
        return unary_union([rect.polygon for rect in self.rects])


@dataclass(frozen=True)
class Row:
    """A strip of rooms beside a corridor: `long` the axis it runs along, `door_side` -1 or +1 on the other axis.

    `corridor` is the range along `long` in which doors may stand, `wall_m` the thickness of the corridor wall,
    `outer` whether the far side faces outdoors.
    """

    rect: Rect
    long: int
    door_side: int
    corridor: tuple[float, float]
    wall_m: float
    outer: bool


@dataclass
class Draft:
    """What the generator has put down so far (private to this module)."""

    rng: np.random.Generator
    preset: Preset
    spaces: list[Space] = field(default_factory=list)
    openings: list[Opening] = field(default_factory=list)

    def between(self, low_high: tuple[float, float]) -> float:
        """A number drawn from the range, rounded to 5 mm as real buildings are not."""
        return round(float(self.rng.uniform(*low_high)), 4)


def draw_building(preset: Preset, rng: np.random.Generator) -> tuple[Building, CorridorGrid]:
    """Building without furniture, and its corridor grid."""
    draft = Draft(rng, preset)
    grid = _corridor_grid(draft)
    corridor = Space("C1", SpaceKind.CORRIDOR, grid.outline, draft.between(preset.ceiling_m))
    draft.spaces.append(corridor)
    wall_m, outer_m = draft.between(INNER_WALL_M), draft.between(OUTER_WALL_M)
    for row in _inner_rows(draft, grid, wall_m) + _outer_rows(draft, grid, wall_m):
        _fill_row(draft, row, outer_m)
    if preset.lines_x == 0:
        _end_windows(draft, grid, outer_m)
    gross = unary_union([space.outline for space in draft.spaces]).envelope.buffer(outer_m, join_style="mitre")
    return Building(tuple(draft.spaces), tuple(draft.openings), gross), grid


def _corridor_grid(draft: Draft) -> CorridorGrid:
    """Corridors whose tour (each block once around, or there and back) is `corridor_share` of the path."""
    preset, rng = draft.preset, draft.rng
    tour_m = preset.path_m * preset.corridor_share
    blocks = max(preset.lines_x - 1, 1) * max(preset.lines_y - 1, 1)
    if preset.lines_x == 0:
        width = draft.between(preset.corridor_width_m)
        length = tour_m / 2 + width
        return CorridorGrid((), ((0.0, width),), Rect(0.0, 0.0, length, width))
    half = tour_m / blocks / 2
    share = float(rng.uniform(0.52, 0.62))
    bands_x = _bands(draft, preset.lines_x, half * share)
    bands_y = _bands(draft, preset.lines_y, half * (1 - share))
    return CorridorGrid(bands_x, bands_y, Rect(bands_x[0][0], bands_y[0][0], bands_x[-1][1], bands_y[-1][1]))


def _bands(draft: Draft, count: int, pitch_m: float) -> tuple[tuple[float, float], ...]:
    """Corridor ranges whose middles are about `pitch_m` apart (never too narrow to leave a core)."""
    widths = [draft.between(draft.preset.corridor_width_m) for _ in range(count)]
    middles = np.cumsum([0.0] + [max(pitch_m * float(draft.rng.uniform(0.85, 1.15)), 3.2) for _ in range(count - 1)])
    return tuple((round(float(m - w / 2), 4), round(float(m + w / 2), 4)) for m, w in zip(middles, widths, strict=True))


def _inner_rows(draft: Draft, grid: CorridorGrid, wall_m: float) -> list[Row]:
    """Rows inside the blocks that corridors enclose: two back to back, one, or a solid core."""
    rows: list[Row] = []
    for (_, x0), (x1, _) in zip(grid.bands_x[:-1], grid.bands_x[1:], strict=True):
        for (_, y0), (y1, _) in zip(grid.bands_y[:-1], grid.bands_y[1:], strict=True):
            rows += _block_rows(draft, Rect(x0 + wall_m, y0 + wall_m, x1 - wall_m, y1 - wall_m), wall_m)
    return rows


def _block_rows(draft: Draft, block: Rect, wall_m: float) -> list[Row]:
    long = 0 if block.size(0) >= block.size(1) else 1
    along, across = block.interval(long), block.interval(1 - long)
    depth = across[1] - across[0]
    if depth < MIN_ROW_DEPTH_M or along[1] - along[0] < MIN_ROOM_WIDTH_M:
        return []
    if depth < 2 * MIN_ROW_DEPTH_M + 0.3:
        side = int(draft.rng.choice((-1, 1)))
        return [Row(block, long, side, along, wall_m, False)]
    middle, party = across[0] + depth * float(draft.rng.uniform(0.42, 0.58)), draft.between(INNER_WALL_M)
    low = rect_along(long, along, (across[0], middle - party / 2))
    high = rect_along(long, along, (middle + party / 2, across[1]))
    return [Row(low, long, -1, along, wall_m, False), Row(high, long, 1, along, wall_m, False)]


def _outer_rows(draft: Draft, grid: CorridorGrid, wall_m: float) -> list[Row]:
    """Rows between the corridors and the outer walls; those above and below reach over the corners."""
    bounds, depth = grid.bounds, [draft.between(draft.preset.room_depth_m) for _ in range(4)]
    span = (bounds.x0, bounds.x1)
    rows: list[Row] = []
    if grid.bands_x:
        span = (bounds.x0 - wall_m - depth[0], bounds.x1 + wall_m + depth[1])
        upright = (bounds.y0, bounds.y1)
        rows.append(Row(Rect(span[0], bounds.y0, bounds.x0 - wall_m, bounds.y1), 1, 1, upright, wall_m, True))
        rows.append(Row(Rect(bounds.x1 + wall_m, bounds.y0, span[1], bounds.y1), 1, -1, upright, wall_m, True))
    corridor = (bounds.x0, bounds.x1)
    rows.append(Row(Rect(span[0], bounds.y0 - wall_m - depth[2], span[1], bounds.y0 - wall_m), 0, 1, corridor, wall_m, True))
    rows.append(Row(Rect(span[0], bounds.y1 + wall_m, span[1], bounds.y1 + wall_m + depth[3]), 0, -1, corridor, wall_m, True))
    return rows


def _fill_row(draft: Draft, row: Row, outer_m: float) -> None:
    """Cut a row into rooms, each with a door to the corridor, some with windows and a door to their neighbour."""
    pieces = _cut(draft, row)
    across = row.rect.interval(1 - row.long)
    previous: Space | None = None
    for start, end in pieces:
        rect = rect_along(row.long, (start, end), across)
        room = Space(f"R{len(draft.spaces)}", SpaceKind.ROOM, _with_recess(draft, rect, row), draft.between(draft.preset.ceiling_m))
        draft.spaces.append(room)
        _corridor_door(draft, row, room, (start, end))
        if row.outer and draft.rng.random() < draft.preset.windows:
            _window(draft, row, room, (start, end), outer_m)
        if previous is not None and draft.rng.random() < 0.15:
            _party_door(draft, row, (previous, room), (pieces[pieces.index((start, end)) - 1][1], start))
        previous = room


def _cut(draft: Draft, row: Row) -> list[tuple[float, float]]:
    """Ranges of the rooms of a row; every one has at least a door's room of corridor beside it."""
    start, stop = row.rect.interval(row.long)
    need = DOOR_WIDTH_M[1] + 2 * DOOR_CORNER_M
    pieces: list[tuple[float, float]] = []
    while True:
        first_end = max(start + MIN_ROOM_WIDTH_M, row.corridor[0] + need)
        end = max(start + draft.between(draft.preset.room_width_m), first_end)
        wall = draft.between(INNER_WALL_M)
        rest_needs = max(MIN_ROOM_WIDTH_M, need + max(stop - row.corridor[1], 0.0))
        if end + wall + rest_needs > stop:
            pieces.append((round(start, 4), round(stop, 4)))
            return pieces
        pieces.append((round(start, 4), round(end, 4)))
        start = end + wall


def _with_recess(draft: Draft, rect: Rect, row: Row) -> Polygon:
    """The room's outline, for some rooms with a pier or a duct cut out of a far corner."""
    outline = rect.polygon
    if draft.rng.random() > 0.35 or rect.size(0) < 3.0 or rect.size(1) < 3.0:
        return outline
    along, across = rect.interval(row.long), rect.interval(1 - row.long)
    size, depth = draft.between((0.3, 0.9)), draft.between((0.15, 0.5))
    at = along[0] if draft.rng.random() < 0.5 else along[1] - size
    far = (across[0], across[0] + depth) if row.door_side > 0 else (across[1] - depth, across[1])
    return outline.difference(rect_along(row.long, (at, at + size), far).polygon)


def _corridor_door(draft: Draft, row: Row, room: Space, piece: tuple[float, float]) -> None:
    low, high = max(piece[0], row.corridor[0]) + DOOR_CORNER_M, min(piece[1], row.corridor[1]) - DOOR_CORNER_M
    width = draft.between(DOOR_WIDTH_M)
    if high - low < width:
        return
    at = round(float(draft.rng.uniform(low, high - width)), 4)
    across = row.rect.interval(1 - row.long)
    wall = (across[1], across[1] + row.wall_m) if row.door_side > 0 else (across[0] - row.wall_m, across[0])
    _add_opening(draft, OpeningKind.DOOR, row.long, (at, at + width), wall, (0.0, draft.between(DOOR_HEAD_M)), (room.id, "C1"))


def _party_door(draft: Draft, row: Row, rooms: tuple[Space, Space], wall: tuple[float, float]) -> None:
    across = row.rect.interval(1 - row.long)
    width = draft.between(DOOR_WIDTH_M)
    low, high = across[0] + 1.0, across[1] - 1.0 - width  # clear of corners and of piers
    if high <= low:
        return
    at = round(float(draft.rng.uniform(low, high)), 4)
    ids = (rooms[0].id, rooms[1].id)
    _add_opening(draft, OpeningKind.DOOR, 1 - row.long, (at, at + width), wall, (0.0, draft.between(DOOR_HEAD_M)), ids)


def _window(draft: Draft, row: Row, room: Space, piece: tuple[float, float], outer_m: float) -> None:
    low, high = piece[0] + 1.0, piece[1] - 1.0  # clear of corners and of piers
    width = min(draft.between((0.9, 2.4)), high - low)
    if width < 0.6:
        return
    at = round(float(draft.rng.uniform(low, max(high - width, low))), 4)
    across = row.rect.interval(1 - row.long)
    wall = (across[0] - outer_m, across[0]) if row.door_side > 0 else (across[1], across[1] + outer_m)
    heights = (draft.between((0.8, 1.0)), draft.between((2.0, 2.3)))
    _add_opening(draft, OpeningKind.WINDOW, row.long, (at, round(at + width, 4)), wall, heights, (room.id, ""))


def _end_windows(draft: Draft, grid: CorridorGrid, outer_m: float) -> None:
    """A corridor that ends at an outer wall has a window there, sometimes."""
    low, high = grid.bounds.interval(1)
    for wall in ((grid.bounds.x0 - outer_m, grid.bounds.x0), (grid.bounds.x1, grid.bounds.x1 + outer_m)):
        if draft.rng.random() < draft.preset.windows / 2:
            heights = (draft.between((0.8, 1.0)), draft.between((2.0, 2.3)))
            _add_opening(draft, OpeningKind.WINDOW, 1, (low + 0.3, high - 0.3), wall, heights, ("C1", ""))


def _add_opening(
    draft: Draft,
    kind: OpeningKind,
    along: int,
    width: tuple[float, float],
    wall: tuple[float, float],
    heights: tuple[float, float],
    spaces: tuple[str, str],
) -> None:
    rect = rect_along(along, width, wall)
    draft.openings.append(Opening(f"O{len(draft.openings) + 1}", kind, rect, along, heights[0], heights[1], spaces))
