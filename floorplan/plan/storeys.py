"""Storeys: floors at distinct heights that somebody walked on, each with the part of the evidence that was seen from and on it."""

from dataclasses import replace
from itertools import pairwise

import numpy as np

from floorplan.model.checks import Array
from floorplan.model.plan import Plan
from floorplan.model.scan import Trajectory
from floorplan.model.segment import AXIS_Z, FreePatches
from floorplan.plan.plan_frame import MIN_FLOOR_BELOW_SENSOR_M, NO_PLANE, PlanWorld, moved

MIN_STOREY_M = 2.2  # floor to floor: nobody builds lower; half landings of a stair lie lower
MIN_WALKED_M = 1.5  # level path on a storey: a landing that is only passed shows less
LEVEL_STEP = 0.2  # rise per metre walked: less is level, a stair rises by 0.5
FLOOR_CELL_M = 0.25  # grain at which the area of a floor is counted
MIN_FLOOR_M2 = 4.0  # a landing is smaller, a room larger
BELOW_FLOOR_M = 0.3  # readings this far below a floor still belong to its storey: noise, thresholds, a step down


def floor_heights_m(world: PlanWorld) -> tuple[float, ...]:
    """Heights of the floors of all storeys that were walked on, from below upwards; empty for level sweeps.

    A floor looks up, shows the area of a room, and was walked on; the next one lies at least a storey higher.
    """
    if not world.heights:
        return ()
    area = _areas_m2(world)
    large = (world.plane_axis == AXIS_Z) & (world.plane_facing > 0) & (area >= MIN_FLOOR_M2)
    found: list[float] = []
    for offset in np.sort(world.plane_offset_m[large]):
        if (not found or offset - found[-1] >= MIN_STOREY_M) and _walked_m(world, float(offset)) >= MIN_WALKED_M:
            found.append(float(offset))
    return tuple(found)


def _areas_m2(world: PlanWorld) -> Array:
    """Seen area (L,) of every plane, counted in cells of the floor."""
    level = np.flatnonzero((world.point_plane != NO_PLANE) & (world.plane_axis[world.point_plane] == AXIS_Z))
    if not len(level):
        return np.zeros(len(world.plane_axis))
    cell = np.floor(world.point_m[level, :2] / FLOOR_CELL_M).astype(np.int64)
    cell -= cell.min(axis=0)
    columns, rows = cell.max(axis=0) + 1
    seen = np.unique((world.point_plane[level] * columns + cell[:, 0]) * rows + cell[:, 1])
    return np.bincount(seen // (columns * rows), minlength=len(world.plane_axis)) * FLOOR_CELL_M**2


def _walked_m(world: PlanWorld, floor_m: float) -> float:
    """Level path whose sensor was carried above this floor and below the next storey."""
    step = np.diff(world.trajectory.position_m, axis=0)
    length = np.hypot(step[:, 0], step[:, 1])
    above = world.trajectory.position_m[1:, 2] - floor_m
    on = (above >= MIN_FLOOR_BELOW_SENSOR_M) & (above < MIN_STOREY_M + MIN_FLOOR_BELOW_SENSOR_M)
    return float(length[on & (np.abs(step[:, 2]) <= LEVEL_STEP * length)].sum())


def storeys(world: PlanWorld) -> tuple[PlanWorld, ...]:
    """The world cut into its storeys, from below upwards, each moved so that its own floor is z = 0; itself where there is but one.

    Frames belong to the highest floor below the sensor. Readings of a frame count on its own storey only, up to the next floor.
    """
    floors = floor_heights_m(world)
    if len(floors) < 2:
        return (world,)
    tops = [*(floor - BELOW_FLOOR_M for floor in floors[1:]), np.inf]
    cut = []
    for floor, frames, top in zip(floors, frames_of_storeys(world, floors), tops, strict=True):
        part = _part(world, frames, -np.inf if floor == floors[0] else floor - BELOW_FLOOR_M, top)
        cut.append(replace(moved(part, 0, np.array([0.0, 0.0, -floor])), floor_seen=True))
    return tuple(cut)


def frames_of_storeys(world: PlanWorld, floors: tuple[float, ...]) -> tuple[Array, ...]:
    """Rows of the frames on each of the floors, in their order."""
    edges = [-np.inf, *(floor + MIN_FLOOR_BELOW_SENSOR_M for floor in floors[1:]), np.inf]
    z = world.trajectory.position_m[:, 2]
    return tuple(np.flatnonzero((z >= low) & (z < high)) for low, high in pairwise(edges))


def _part(world: PlanWorld, frames: Array, low_m: float, high_m: float) -> PlanWorld:
    """The world of some frames (rows) and of their readings between two heights."""
    row = np.full(len(world.trajectory.position_m), -1, dtype=np.int32)
    row[frames] = np.arange(len(frames))
    z = world.point_m[:, 2]
    kept = (row[world.point_frame] >= 0) & (z >= low_m) & (z < high_m)
    path = world.trajectory
    pairs = np.unique(np.stack((world.point_plane[kept], world.point_frame[kept])), axis=1)
    return replace(
        world,
        trajectory=Trajectory(path.stamp_ns[frames], path.position_m[frames], path.world_from_sensor[frames]),
        plane_extent_m=_clipped(world.plane_extent_m, low_m, high_m),
        plane_frames=np.bincount(pairs[0][pairs[0] != NO_PLANE], minlength=len(world.plane_axis)),
        point_m=world.point_m[kept],
        point_frame=row[world.point_frame[kept]],
        point_plane=world.point_plane[kept],
        point_weight=world.point_weight[kept],
        point_sigma_m=world.point_sigma_m[kept],
    )


def _clipped(extent_m: Array, low_m: float, high_m: float) -> Array:
    """Extents (L, 3, 2) with their heights cut to the storey."""
    clipped = np.array(extent_m)
    clipped[:, 2] = np.clip(extent_m[:, 2], low_m, high_m)
    return clipped


def patches_of(patches: FreePatches, world: PlanWorld, frames: Array) -> FreePatches:
    """The patches that the frames (rows of `world`) of a storey saw, with their rows in the storey."""
    row = np.full(len(world.trajectory.stamp_ns), -1)
    row[frames] = np.arange(len(frames))
    kept = row[patches.frame] >= 0
    return replace(
        patches,
        frame=row[patches.frame[kept]],
        normal_yaw_rad=patches.normal_yaw_rad[kept],
        start_m=patches.start_m[kept],
        end_m=patches.end_m[kept],
        height_m=patches.height_m[kept],
        sigma_m=patches.sigma_m[kept],
        pixels=patches.pixels[kept],
    )


def stacked(plans: tuple[Plan, ...]) -> Plan:
    """The plans of storeys, from below upwards, as one: the lowest, which holds the others; every storey knows its level."""
    lowest = float(plans[0].shift_m[2])
    levelled = [replace(plan, level=f"Storey {k + 1}", elevation_m=lowest - float(plan.shift_m[2])) for k, plan in enumerate(plans)]
    return replace(levelled[0], upper_storeys=tuple(levelled[1:]))
