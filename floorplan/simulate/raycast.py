"""Rays against a building's surfaces."""

from dataclasses import dataclass
from typing import Any

import numpy as np

from floorplan.model.checks import Array
from floorplan.open3d_library import load_open3d
from floorplan.simulate.building import SurfaceKind
from floorplan.simulate.surfaces import Surface

NO_SURFACE = -1
THREADS = 1  # Embree's result does not depend on it; other work shares the machine


@dataclass(frozen=True)
class Hits:
    """Where R rays ended: `distance (R,)` in ray lengths (inf: nowhere), `surface (R,)` index into the caster's surfaces."""

    distance: Array
    surface: Array


class RayCaster:
    """Casts against solid surfaces and against panes of glass, which do not hide what is behind them."""

    def __init__(self, surfaces: tuple[Surface, ...]) -> None:
        self._open3d = load_open3d()
        self.surfaces = surfaces
        kinds = [surface.kind for surface in surfaces]
        self._solid = np.array([i for i, kind in enumerate(kinds) if kind is not SurfaceKind.GLASS])
        self.is_glass = np.array([kind is SurfaceKind.GLASS for kind in kinds])
        self._all = np.arange(len(surfaces))
        self._solid_scene = self._scene(self._solid)
        self._first_scene = self._scene(self._all) if self.is_glass.any() else self._solid_scene

    def solid(self, origins: Array, directions: Array) -> Hits:
        """First solid surface along each ray: `origins`, `directions` (R, 3)."""
        return self._cast(self._solid_scene, self._solid, origins, directions)

    def first(self, origins: Array, directions: Array) -> Hits:
        """First surface along each ray, glass or solid."""
        rows = self._all if self.is_glass.any() else self._solid
        return self._cast(self._first_scene, rows, origins, directions)

    def _scene(self, rows: Array) -> Any:
        corners = np.stack([self.surfaces[row].corner for row in rows]).astype(np.float32)
        first = 4 * np.arange(len(rows), dtype=np.uint32)
        halves = [np.column_stack((first, first + 1, first + 2)), np.column_stack((first, first + 2, first + 3))]
        scene = self._open3d.t.geometry.RaycastingScene(nthreads=THREADS)
        scene.add_triangles(corners.reshape(-1, 3), np.stack(halves, axis=1).reshape(-1, 3))
        return scene

    def _cast(self, scene: Any, rows: Array, origins: Array, directions: Array) -> Hits:
        rays = np.concatenate((np.broadcast_to(origins, directions.shape), directions), axis=1).astype(np.float32)
        answer = scene.cast_rays(self._open3d.core.Tensor(rays), nthreads=THREADS)
        distance = answer["t_hit"].numpy()
        triangle = answer["primitive_ids"].numpy()
        none = ~np.isfinite(distance)
        surface = rows[np.where(none, 0, triangle // 2)]
        return Hits(distance, np.where(none, NO_SURFACE, surface))
