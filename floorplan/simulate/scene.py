"""A drawn scene: building, route and true walk of a preset and seed."""

from dataclasses import dataclass

import numpy as np

from floorplan.simulate.building import Building
from floorplan.simulate.furnish import add_glass_and_beams, furnish
from floorplan.simulate.hard import add_hard_objects
from floorplan.simulate.layout import draw_building
from floorplan.simulate.presets import Preset, preset_named
from floorplan.simulate.route import Route, plan_route
from floorplan.simulate.walk import Walk, draw_style, walk


@dataclass(frozen=True)
class Scene:
    """What is simulated before any sensor: an exact building and a true walk in it."""

    preset: Preset
    seed: int
    building: Building
    route: Route
    walk: Walk


def draw_scene(preset_name: str, seed: int, *, hard: bool = False, path_scale: float = 1.0, rate_hz: float | None = None) -> Scene:
    """The scene of a preset and seed; `hard` adds tall cabinets and open door leaves to the same rooms."""
    preset = preset_named(preset_name, path_scale)
    layout_rng, route_rng, furniture_rng, hard_rng, walk_rng = [
        np.random.default_rng([seed, part, *preset_name.encode()]) for part in range(5)
    ]
    building, grid = draw_building(preset, layout_rng)
    route = plan_route(building, grid, preset.path_m, route_rng)
    if preset.glass:
        building = add_glass_and_beams(building, route, furniture_rng)
    if hard:
        building = add_hard_objects(building, route, hard_rng)
    building = furnish(building, route, furniture_rng)
    style = draw_style(preset.sensor.fov_x_deg, walk_rng)
    return Scene(preset, seed, building, route, walk(route, style, rate_hz or preset.rate_hz, walk_rng))
