"""A drawn scene: building, route and true walk of a preset and seed."""

from dataclasses import dataclass, replace

import numpy as np

from floorplan.errors import UsageError
from floorplan.simulate.building import Building
from floorplan.simulate.furnish import add_glass_and_beams, furnish
from floorplan.simulate.hard import add_hard_objects
from floorplan.simulate.layout import draw_building
from floorplan.simulate.presets import Preset, preset_named
from floorplan.simulate.route import Route, Stop, plan_route
from floorplan.simulate.storeys import Storey, joined, storey_height_m
from floorplan.simulate.walk import Walk, draw_style, walk
from floorplan.simulate.works import Works, after_works


@dataclass(frozen=True)
class Scene:
    """What is simulated before any sensor: exact storeys, from below upwards, and a true walk in them."""

    preset: Preset
    seed: int
    storeys: tuple[Storey, ...]
    walk: Walk
    left_out: tuple[str, ...] = ()  # works that there was no place for, in sentences

    @property
    def building(self) -> Building:
        """The lowest storey."""
        return self.storeys[0].building


def draw_scene(
    preset_name: str,
    seed: int,
    *,
    hard: bool = False,
    path_scale: float = 1.0,
    rate_hz: float | None = None,
    walk_seed: int | None = None,
    works: bool = False,
    storeys: int = 1,
) -> Scene:
    """The scene of a preset and seed; `hard` adds tall cabinets and open door leaves to the same rooms.

    `walk_seed` walks the same route in another way; `works` moves a wall and builds a partition before the walk.
    Every storey has the same shell, its own furniture and its own walk of the preset's length.
    """
    preset = preset_named(preset_name, path_scale)
    layout_rng, route_rng, furniture_rng, hard_rng, walk_rng = [
        np.random.default_rng([seed, part, *preset_name.encode()]) for part in range(5)
    ]
    shell, grid = draw_building(preset, layout_rng)
    if walk_seed is not None:
        walk_rng = np.random.default_rng([walk_seed, 5, *preset_name.encode()])
    style = draw_style(preset.sensor.fov_x_deg, walk_rng)
    rate = rate_hz or preset.rate_hz
    levels: list[Storey] = []
    left_out: list[str] = []
    whole: Walk | None = None
    for index in range(storeys):
        route = plan_route(shell, grid, preset.path_m, route_rng)
        if levels:
            route = _from_the_stair(route, levels[0].route)
        empty = add_glass_and_beams(shell, route, furniture_rng) if preset.glass else shell
        furnished = furnish(add_hard_objects(empty, route, hard_rng) if hard else empty, route, furniture_rng)
        done = after_works(furnished, route) if works else Works(furnished)
        left_out += done.left_out
        floor, stage = index * storey_height_m(shell), walk(route, style, rate, walk_rng)
        whole = stage if whole is None else joined(whole, stage, floor, rate)
        levels.append(Storey(floor, done.building, route, slice(len(whole) - len(stage), len(whole))))
    if whole is None:
        raise UsageError("a building has at least one storey")
    return Scene(preset, seed, tuple(levels), whole, tuple(left_out))


def _from_the_stair(route: Route, lowest: Route) -> Route:
    """The route begun, and ended, where the stair is, in the corridor that every route starts in."""
    stair = Stop(lowest.stops[0].xy)
    return replace(route, stops=(stair, *route.stops, stair))
