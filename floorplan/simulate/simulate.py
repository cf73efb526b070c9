"""The whole simulation: scene, rays, errors, files, truth."""

import json
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np

from floorplan.errors import UsageError
from floorplan.simulate import hard as hard_facts
from floorplan.simulate.coverage import Coverage
from floorplan.simulate.formats import Format, Instrument, Writer, format_named
from floorplan.simulate.odometry import TILT_WANDER_RAD, Odometry, drifting_odometry
from floorplan.simulate.raycast import RayCaster
from floorplan.simulate.scene import Scene, draw_scene
from floorplan.simulate.storeys import storey_surfaces
from floorplan.simulate.truth import truth_of
from floorplan.simulate.walk_part import WHOLE_WALK, WalkPart

Progress = Callable[[int, int], None]


def _silent(_done: int, _total: int) -> None:
    """Progress that nobody wants to see."""


def simulate(
    out: Path,
    preset: str,
    seed: int,
    *,
    hard: bool = False,
    format: str = "tum",
    sensor: str = "",
    path_scale: float = 1.0,
    odometry_error: float | None = None,
    rate_hz: float | None = None,
    image_scale: float = 1.0,
    storeys: int = 1,
    noise_seed: int | None = None,
    works: bool = False,
    walk_part: WalkPart = WHOLE_WALK,
    progress: Progress = _silent,
) -> tuple[str, ...]:
    """Write a scan of a simulated building to the folder `out`, with its `truth.json`; gives what was asked for and had no place.

    `odometry_error` (0.02 is 2 %) overrides the drift of the preset; `path_scale` makes building and path larger;
    `rate_hz` and `image_scale` override the camera's; `sensor` "lidar16" a spinning LiDAR instead of it;
    `storeys` as many floors of one shell, walked one after the other.
    `noise_seed` walks and measures the building of `seed` another time; `works` moves a wall in it and builds a partition.
    `walk_part` is recorded alone, as a scan of its own, with its own odometry: two parts are two scans of one building.
    Raises `UsageError` for an unknown preset or format, or an `out` that is not empty.
    """
    chosen = _checked(out, format, sensor, storeys)
    drawn = draw_scene(
        preset, seed, hard=hard, path_scale=path_scale, rate_hz=rate_hz, storeys=storeys, walk_seed=noise_seed, works=works
    )
    noise = seed if noise_seed is None else noise_seed
    scene = chosen.scene(replace(drawn, seed=noise, walk=walk_part.of(drawn.walk)))
    odometry = odometry_of(scene, walk_part.seeds(noise, 79), hard, odometry_error)
    parts = storey_surfaces(scene.storeys)
    surfaces = tuple(surface for part in parts for surface in part)
    instrument = chosen.instrument(scene, RayCaster(surfaces), hard, image_scale)
    coverage = Coverage(surfaces, instrument.rays, chosen.coverage_stride)
    _record(instrument, chosen.writer(out, instrument, noise), coverage, scene, odometry, progress)
    truth = truth_of(replace(scene, seed=seed), parts, coverage)
    (out / "truth.json").write_text(json.dumps(truth, separators=(",", ":")) + "\n")
    return drawn.left_out


def _checked(out: Path, format: str, sensor: str, storeys: int) -> Format:
    """The format to write in; what cannot be simulated is refused before anything is drawn."""
    if out.exists() and any(out.iterdir()):
        raise UsageError(f"{out} is not empty; choose a new folder")
    chosen = format_named(format, sensor)
    if storeys > 1 and format == "carmen":
        raise UsageError("a robot on wheels climbs no stairs: --storeys needs another --format than carmen")
    return chosen


def _record(instrument: Instrument, writer: Writer, coverage: Coverage, scene: Scene, odometry: Odometry, progress: Progress) -> None:
    """Every frame of the walk: taken, written, and what it saw remembered; at the end what belongs to the whole."""
    for index, shot in enumerate(instrument.shots(scene.walk)):
        coverage.add(shot.surface, shot.true_m, scene.walk.position_m[index], scene.walk.world_from_camera[index])
        writer.frame(index, shot)
        progress(index + 1, len(scene.walk))
    writer.finish(scene.walk, odometry)


def odometry_of(scene: Scene, seeds: list[int], hard: bool, error: float | None) -> Odometry:
    """The odometry of a scene's walk, drawn from `seeds`; `error` as in `simulate`, None: as the preset and `hard` have it."""
    rng = np.random.default_rng(seeds)
    low, high = hard_facts.ODOMETRY_ERROR
    drawn = float(rng.uniform(low, high))
    if error is None and hard:
        error = drawn
    tilt = hard_facts.TILT_WANDER_RAD if hard else TILT_WANDER_RAD
    drift_m = scene.preset.drift_m * float(scene.walk.path_m[-1]) / scene.preset.path_m
    return drifting_odometry(scene.walk, rng, error=error, drift_m=drift_m, tilt_rad=tilt)
