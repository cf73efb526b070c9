"""From a building to its surfaces: rectangles with a facing, exact to the millimetre the layout was drawn in."""

import itertools
from dataclasses import dataclass

import numpy as np
from shapely.geometry import Point, Polygon

from floorplan.model.checks import Array
from floorplan.simulate.building import Box, BoxKind, Building, Opening, OpeningKind, Space, SurfaceKind

TOUCH_M = 1e-6  # an opening belongs to a wall face when it lies this close to its line
GLASS_DEPTH_SHARE = 0.6  # where in the wall's depth a pane stands, from the first side


@dataclass(frozen=True)
class Surface:
    """One flat quadrilateral: `corner (4, 3)`; `axis` 0, 1, 2 or -1 for an oblique one; `facing` +1 or -1.

    For upright ones `start`, `end` is the range along the wall and `z0`, `z1` the height; `owner` the space or box.
    """

    kind: SurfaceKind
    owner: str
    axis: int
    facing: int
    corner: Array
    dark: bool = False

    @property
    def offset(self) -> float:
        """Coordinate along `axis`."""
        return float(self.corner[0, self.axis])

    @property
    def along(self) -> tuple[float, float]:
        """Range along the wall (for upright axis-aligned surfaces)."""
        values = self.corner[:, 1 - self.axis]
        return float(values.min()), float(values.max())

    @property
    def heights(self) -> tuple[float, float]:
        """Lowest and highest z."""
        return float(self.corner[:, 2].min()), float(self.corner[:, 2].max())


def surfaces_of(building: Building) -> tuple[Surface, ...]:
    """All surfaces, always in the same order."""
    found: list[Surface] = []
    for space in building.spaces:
        touching = [opening for opening in building.openings if space.id in opening.spaces]
        found += _space_walls(space, touching)
        found += _level_cells(space.outline, space.ceiling_m, -1, SurfaceKind.CEILING, space.id)
    found += _floor(building)
    for opening in building.openings:
        found += _opening_surfaces(opening)
    for index, solid in enumerate(building.boxes):
        found += _box_surfaces(solid, f"B{index + 1}")
    return tuple(found)


def upright(kind: SurfaceKind, owner: str, start: Array, end: Array, z: tuple[float, float], dark: bool = False) -> Surface:
    """Upright rectangle from `start (2,)` to `end (2,)`; it faces to the left of that direction."""
    run = np.asarray(end, float) - np.asarray(start, float)
    normal = np.array([-run[1], run[0]]) / np.hypot(*run)
    axis = int(np.argmax(np.abs(normal)))
    oblique = abs(normal[axis]) < 1 - 1e-9
    corner = np.array([[*start, z[0]], [*end, z[0]], [*end, z[1]], [*start, z[1]]])
    return Surface(kind, owner, -1 if oblique else axis, 1 if normal[axis] > 0 else -1, corner, dark)


def _space_walls(space: Space, openings: list[Opening]) -> list[Surface]:
    outline = space.outline.normalize()  # shapely's normal form: exterior clockwise
    found: list[Surface] = []
    rings = [(outline.exterior, SurfaceKind.WALL)]
    rings += [(ring, SurfaceKind.COLUMN if Polygon(ring).area < 2.0 else SurfaceKind.WALL) for ring in outline.interiors]
    for ring, kind in rings:
        points = np.array(_simplified(np.array(ring.coords)[:-1]))
        for start, end in zip(points, np.roll(points, -1, axis=0), strict=True):
            if not _free_on_left(outline, start, end):
                start, end = end, start
            found += _cut_wall(space, kind, start, end, openings)
    return found


def _simplified(points: Array) -> Array:
    """Without points in the middle of a straight run."""
    before, after = points - np.roll(points, 1, axis=0), np.roll(points, -1, axis=0) - points
    return np.asarray(points[np.abs(before[:, 0] * after[:, 1] - before[:, 1] * after[:, 0]) > TOUCH_M])


def _free_on_left(outline: Polygon, start: Array, end: Array) -> bool:
    run = end - start
    probe = (start + end) / 2 + 1e-3 * np.array([-run[1], run[0]]) / np.hypot(*run)
    return bool(outline.contains(Point(probe)))


def _cut_wall(space: Space, kind: SurfaceKind, start: Array, end: Array, openings: list[Opening]) -> list[Surface]:
    """A wall face with its openings cut out: full-height pieces, sills and lintels."""
    along = int(np.argmax(np.abs(end - start)))
    direction = 1.0 if end[along] > start[along] else -1.0
    low, high = sorted((float(start[along]), float(end[along])))
    offset = float(start[1 - along])
    found: list[Surface] = []

    def piece(piece_kind: SurfaceKind, a: float, b: float, z: tuple[float, float]) -> None:
        if b - a > TOUCH_M and z[1] - z[0] > TOUCH_M:
            first, last = (np.array([v, offset]) if along == 0 else np.array([offset, v]) for v in (a, b))
            found.append(upright(piece_kind, space.id, *((first, last) if direction > 0 else (last, first)), z))

    at = low
    for opening in sorted(_on_face(openings, along, offset, low, high), key=lambda o: o.rect.interval(along)[0]):
        a, b = opening.rect.interval(along)
        piece(kind, at, a, (0.0, space.ceiling_m))
        piece(SurfaceKind.SILL, a, b, (0.0, opening.sill_m))
        piece(SurfaceKind.LINTEL, a, b, (opening.head_m, space.ceiling_m))
        at = b
    piece(kind, at, high, (0.0, space.ceiling_m))
    return found


def _on_face(openings: list[Opening], along: int, offset: float, low: float, high: float) -> list[Opening]:
    return [
        opening
        for opening in openings
        if opening.along == along
        and min(abs(offset - side) for side in opening.rect.interval(1 - along)) < TOUCH_M
        and opening.rect.interval(along)[0] > low - TOUCH_M
        and opening.rect.interval(along)[1] < high + TOUCH_M
    ]


def _opening_surfaces(opening: Opening) -> list[Surface]:
    """The two reveals, the soffit, the sill's top, and the pane where there is one."""
    width, depth = opening.rect.interval(opening.along), opening.rect.interval(1 - opening.along)
    heights = (opening.sill_m, opening.head_m)

    def at(v: float, w: float) -> Array:
        return np.array([v, w]) if opening.along == 0 else np.array([w, v])

    flip = opening.along == 1  # x to the right means y to the left
    found = []
    for v, start, end in ((width[0], depth[1], depth[0]), (width[1], depth[0], depth[1])):
        ends = (at(v, end), at(v, start)) if flip else (at(v, start), at(v, end))
        found.append(upright(SurfaceKind.JAMB, opening.id, *ends, heights))
    found.append(_level(opening.rect.polygon.bounds, opening.head_m, -1, SurfaceKind.LINTEL, opening.id))
    if opening.sill_m > 0:
        found.append(_level(opening.rect.polygon.bounds, opening.sill_m, 1, SurfaceKind.SILL, opening.id))
    if opening.kind is not OpeningKind.DOOR:
        pane = depth[0] + GLASS_DEPTH_SHARE * (depth[1] - depth[0])
        found.append(upright(SurfaceKind.GLASS, opening.id, at(width[0], pane), at(width[1], pane), heights))
    return found


def _floor(building: Building) -> list[Surface]:
    found: list[Surface] = []
    for space in building.spaces:
        found += _level_cells(space.outline, 0.0, 1, SurfaceKind.FLOOR, space.id)
    return found + [_level(door.rect.polygon.bounds, 0.0, 1, SurfaceKind.FLOOR, door.id) for door in building.doors]


def _level_cells(outline: Polygon, z: float, facing: int, kind: SurfaceKind, owner: str) -> list[Surface]:
    """A rectilinear polygon as rectangles on the lines through its corners, merged along x."""
    coords = np.concatenate([np.array(ring.coords) for ring in (outline.exterior, *outline.interiors)])
    xs, ys = np.unique(coords[:, 0].round(6)), np.unique(coords[:, 1].round(6))
    found = []
    for y0, y1 in itertools.pairwise(ys):
        start: float | None = None
        for x0, x1 in itertools.pairwise(xs):
            inside = outline.contains(Point((x0 + x1) / 2, (y0 + y1) / 2))
            if inside and start is None:
                start = float(x0)
            if start is not None and (not inside or x1 == xs[-1]):
                found.append(_level((start, y0, x1 if inside else x0, y1), z, facing, kind, owner))
                start = None
    return found


def _level(bounds: tuple[float, float, float, float], z: float, facing: int, kind: SurfaceKind, owner: str) -> Surface:
    x0, y0, x1, y1 = bounds
    return Surface(kind, owner, 2, facing, np.array([[x0, y0, z], [x1, y0, z], [x1, y1, z], [x0, y1, z]]))


def _box_surfaces(solid: Box, owner: str) -> list[Surface]:
    kind = SurfaceKind.BOX
    points = np.array(solid.outline.normalize().exterior.coords)  # clockwise: the free side is on the left
    z = (solid.z0_m, solid.z1_m)
    found = [upright(kind, owner, a, b, z, solid.dark) for a, b in itertools.pairwise(points)]
    for height, facing in ((solid.z1_m, 1), (solid.z0_m, -1)):
        if height > TOUCH_M and (facing > 0 or solid.kind is not BoxKind.MULLION):
            corners = np.column_stack((points[:4], np.full(4, height)))
            found.append(Surface(kind, owner, 2, facing, corners, solid.dark))
    return found
