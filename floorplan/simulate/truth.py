"""truth.json: what a simulated scan truly shows. Code under test never reads it, but for `returns_to_start`."""

from typing import Any

import numpy as np
from shapely.geometry import LineString, Polygon

from floorplan.geometry import quat_xyzw_from_rotation
from floorplan.simulate.building import Opening, OpeningKind, Space, SurfaceKind
from floorplan.simulate.coverage import Coverage
from floorplan.simulate.scene import Scene
from floorplan.simulate.storeys import Storey
from floorplan.simulate.surfaces import Surface

SCHEMA = 1
RETURN_M = 0.05  # start and end closer than this are the same place
VISITED_M = 0.5  # length of path inside a space that counts as a visit
WALL_KINDS = (SurfaceKind.WALL, SurfaceKind.COLUMN, SurfaceKind.JAMB, SurfaceKind.LINTEL, SurfaceKind.SILL)


def truth_of(scene: Scene, parts: tuple[tuple[Surface, ...], ...], coverage: Coverage) -> dict[str, Any]:
    """The truth as plain JSON values; metres, building frame (z up, floor at 0, walls along x and y).

    `parts` are the surfaces of each storey, in the coverage's order. The lowest storey is at the top level; `storeys` lists all
    of them where there are several, each with its `floor_m` and with z from its own floor.
    """
    walk = scene.walk
    first = np.concatenate(([0], np.cumsum([len(part) for part in parts])))
    levels = [_storey(scene, storey, range(first[k], first[k + 1]), coverage) for k, storey in enumerate(scene.storeys)]
    truth = {
        "schema": SCHEMA,
        "units": "m",
        "preset": scene.preset.name,
        "seed": scene.seed,
        "returns_to_start": bool(np.linalg.norm(walk.position_m[-1] - walk.position_m[0]) < RETURN_M),
        "path_length_m": _mm(walk.path_m[-1]),
        "trajectory": _trajectory(scene),
        "faces": levels[0]["faces"],
        "planes": _planes(coverage),
        **{name: levels[0][name] for name in ("spaces", "openings", "boxes", "gross_outline")},
    }
    return truth | ({"storeys": levels} if len(levels) > 1 else {})


def _storey(scene: Scene, storey: Storey, rows: range, coverage: Coverage) -> dict[str, Any]:
    path = LineString(scene.walk.position_m[storey.rows, :2])
    surfaces = [(i, coverage.surfaces[i]) for i in rows]
    building = storey.building
    return {
        "floor_m": _mm(storey.floor_m),
        "faces": [_face(s, coverage, i, storey.floor_m) for i, s in surfaces if s.axis in (0, 1) and s.kind in WALL_KINDS],
        "spaces": [_space(space, path) for space in building.spaces],
        "openings": [_opening(opening, path) for opening in building.openings],
        "boxes": [_box(box.kind.value, box.outline, (box.z0_m, box.z1_m)) for box in building.boxes],
        "gross_outline": _ring(building.outline),
    }


def _mm(value: float) -> float:
    """Rounded to a hundredth of a millimetre: readable, and the same bytes everywhere."""
    return round(float(value), 5)


def _ring(outline: Polygon) -> list[list[float]]:
    return [[_mm(x), _mm(y)] for x, y in np.array(outline.exterior.coords)[:-1]]


def _trajectory(scene: Scene) -> dict[str, Any]:
    """Sensor to building for every frame; OpenCV camera axes."""
    walk = scene.walk
    quats = quat_xyzw_from_rotation(walk.world_from_camera)
    poses = np.column_stack((walk.position_m, quats)).round(6)
    return {"columns": "stamp_ns tx ty tz qx qy qz qw", "stamp_ns": walk.stamp_ns.tolist(), "pose": poses.tolist()}


def _face(surface: Surface, coverage: Coverage, index: int, floor_m: float) -> dict[str, Any]:
    """A piece of wall surface; `seen` are the ranges along it that rays hit."""
    return {
        "kind": surface.kind.value,
        "owner": surface.owner,
        "axis": surface.axis,
        "facing": surface.facing,
        "offset": _mm(surface.offset),
        "start": _mm(surface.along[0]),
        "end": _mm(surface.along[1]),
        "z": [_mm(z - floor_m) for z in surface.heights],
        "seen": [[_mm(a), _mm(b)] for a, b in coverage.seen(index)],
    }


def _planes(coverage: Coverage) -> list[dict[str, Any]]:
    """Distinct planes that carry seen surface, furniture's and glass included: axis, facing, offset, hits."""
    found: dict[tuple[int, int, float], int] = {}
    for index, surface in enumerate(coverage.surfaces):
        if surface.axis >= 0 and coverage.total[index]:
            key = (surface.axis, surface.facing, _mm(surface.offset))
            found[key] = found.get(key, 0) + int(coverage.total[index])
    return [{"axis": a, "facing": f, "offset": o, "hits": hits} for (a, f, o), hits in sorted(found.items())]


def _space(space: Space, path: LineString) -> dict[str, Any]:
    return {
        "id": space.id,
        "kind": space.kind.value,
        "outline": _ring(space.outline),
        "holes": [[[_mm(x), _mm(y)] for x, y in np.array(ring.coords)[:-1]] for ring in space.outline.interiors],
        "area_m2": _mm(space.outline.area),
        "ceiling_m": _mm(space.ceiling_m),
        "visited": bool(path.intersection(space.outline).length > VISITED_M),
    }


def _opening(opening: Opening, path: LineString) -> dict[str, Any]:
    """Door, window or glass wall; `depth_m` is the wall's thickness there."""
    door = opening.kind is OpeningKind.DOOR
    return {
        "id": opening.id,
        "kind": opening.kind.value,
        "centre": [_mm(v) for v in opening.rect.centre],
        "along_axis": opening.along,
        "width_m": _mm(opening.rect.size(opening.along)),
        "depth_m": _mm(opening.rect.size(1 - opening.along)),
        "sill_m": _mm(opening.sill_m),
        "head_m": _mm(opening.head_m),
        "spaces": [space for space in opening.spaces if space],
        "walked_through": bool(door and path.intersects(opening.rect.polygon)),
    }


def _box(kind: str, outline: Polygon, z: tuple[float, float]) -> dict[str, Any]:
    return {"kind": kind, "outline": _ring(outline), "z": [_mm(v) for v in z]}
