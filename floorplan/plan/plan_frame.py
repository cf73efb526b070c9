"""Everything the plan is drawn from, in one frame: planes, sensor positions, evidence points; and the plan frame itself."""

from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np

from floorplan.geometry import rotation_about_z
from floorplan.model.checks import Array
from floorplan.model.graph import LayoutSolution
from floorplan.model.scan import IngestedScan, NoiseModel, SensorKind, Trajectory
from floorplan.model.segment import AXIS_X, AXIS_Y, AXIS_Z, NO_TRACK, EvidencePoints, SegmentedScan, Tracks

NO_PLANE = -1  # an evidence point that lies on no layout plane
MIN_FLOOR_BELOW_SENSOR_M = 0.5  # nobody scans from nearer to the floor; keeps table tops held close out
FLOOR_SUPPORT_RATIO = 0.2  # a floor has at least this share of the best-supported level surface's points
CELLS_PER_PLANE = 1 << 20  # 50 km of cells: far beyond any building
BLOCK_POINTS = 1 << 16  # computed at a time: what is needed between fits the processor's cache
RUN_CELL_M = 0.05  # grain at which the length of a surface is measured when the plan's x direction is chosen


@dataclass(frozen=True)
class PlanWorld:
    """Planes (L), keyframes (F) and evidence points (P) in one axis-aligned frame, metres.

    `plane_axis (L,)`, `plane_facing (L,)`, `plane_offset_m (L,)`, `plane_sigma_m (L,)`, `plane_extent_m (L, 3, 2)`;
    `plane_frames (L,)` how many keyframes saw it; `point_m (P, 3)`, `point_frame (P,)`, `point_plane (P,)` or NO_PLANE,
    `point_weight (P,)`, `point_sigma_m (P,)` noise of the reading: in four bytes each, for there are ten thousand points to a
    metre of path; `heights` False for level sweeps.
    """

    trajectory: Trajectory
    plane_axis: Array
    plane_facing: Array
    plane_offset_m: Array
    plane_sigma_m: Array
    plane_extent_m: Array
    plane_frames: Array
    point_m: Array
    point_frame: Array
    point_plane: Array
    point_weight: Array
    point_sigma_m: Array
    heights: bool
    floor_seen: bool = False
    rotation_quarters: int = 0
    shift_m: tuple[float, float, float] = (0.0, 0.0, 0.0)


def solved_world(
    scan: IngestedScan, segmented: SegmentedScan, tracks: Tracks, solution: LayoutSolution, trajectory: Trajectory
) -> PlanWorld:
    """Evidence and planes in the frame of the solution: every point turned and moved by its keyframe's final pose."""
    evidence = segmented.evidence
    frame = np.repeat(np.arange(len(evidence.start) - 1, dtype=np.int32), np.diff(evidence.start))
    plane_of_segment = _plane_of_segment(tracks, solution)
    point_plane = np.append(plane_of_segment, NO_PLANE).astype(np.int32)[evidence.segment]  # NO_SEGMENT is the last row
    sensor = scan.recording.sensor
    return PlanWorld(
        trajectory,
        solution.plane_axis,
        solution.plane_facing,
        solution.plane_offset_m,
        solution.plane_sigma_m,
        solution.plane_extent_m,
        _frames_of_planes(segmented, plane_of_segment, len(solution.plane_axis)),
        _placed(evidence, trajectory),
        frame,
        point_plane,
        evidence.weight,
        _noise_m(evidence, sensor.noise),
        heights=sensor.kind is not SensorKind.LASER,
    )


def _placed(evidence: EvidencePoints, trajectory: Trajectory) -> Array:
    """Points (P, 3) float32 of all frames under their frames' poses."""
    world = np.empty(evidence.point_sensor_m.shape, np.float32)
    for k, (first, last) in enumerate(pairwise(evidence.start)):
        world[first:last] = evidence.point_sensor_m[first:last] @ trajectory.world_from_sensor[k].T + trajectory.position_m[k]
    return world


def _noise_m(evidence: EvidencePoints, noise: NoiseModel) -> Array:
    """Standard deviation (P,) float32 of every reading along its ray."""
    sigma = np.empty(len(evidence.point_sensor_m), np.float32)
    for first in range(0, len(sigma), BLOCK_POINTS):
        point = evidence.point_sensor_m[first : first + BLOCK_POINTS]
        sigma[first : first + BLOCK_POINTS] = noise.sigma_m(np.sqrt(np.einsum("pi,pi->p", point, point)))
    return sigma


def _plane_of_segment(tracks: Tracks, solution: LayoutSolution) -> Array:
    track = tracks.track_of_segment
    plane = np.full(len(track), NO_PLANE, dtype=np.int64)
    plane[track != NO_TRACK] = solution.plane_of_track[track[track != NO_TRACK]]
    return plane


def _frames_of_planes(segmented: SegmentedScan, plane_of_segment: Array, planes: int) -> Array:
    frames = len(segmented.frames.measured)
    on = plane_of_segment != NO_PLANE
    pairs = np.unique(plane_of_segment[on] * frames + segmented.segments.frame[on])
    return np.bincount(pairs // max(frames, 1), minlength=planes)


def floor_height_m(world: PlanWorld) -> float | None:
    """Height of the floor: the lowest well-supported level surface that looks up from below the sensor; None where none was seen."""
    sensor_z = float(np.median(world.trajectory.position_m[:, 2])) if len(world.trajectory.position_m) else 0.0
    up = (world.plane_axis == AXIS_Z) & (world.plane_facing > 0) & (world.plane_offset_m < sensor_z - MIN_FLOOR_BELOW_SENSOR_M)
    if not up.any():
        return None
    support = _support_of_planes(world)
    enough = up & (support >= FLOOR_SUPPORT_RATIO * support[up].max())
    return float(world.plane_offset_m[enough].min())


def ceiling_height_m(world: PlanWorld) -> float | None:
    """Height of the best-supported level surface that looks down from above the sensor; None where none was seen."""
    sensor_z = float(np.median(world.trajectory.position_m[:, 2])) if len(world.trajectory.position_m) else 0.0
    down = (world.plane_axis == AXIS_Z) & (world.plane_facing < 0) & (world.plane_offset_m > sensor_z)
    if not down.any():
        return None
    return float(world.plane_offset_m[np.argmax(np.where(down, _support_of_planes(world), -1.0))])


def _support_of_planes(world: PlanWorld) -> Array:
    on = world.point_plane != NO_PLANE
    return np.bincount(world.point_plane[on], weights=world.point_weight[on], minlength=len(world.plane_axis))


def on_the_floor(world: PlanWorld) -> PlanWorld:
    """The world shifted so that the floor is z = 0; unchanged where no floor was seen and for level sweeps."""
    floor = floor_height_m(world) if world.heights else None
    if floor is None:
        return world
    return replace(moved(world, 0, np.array([0.0, 0.0, -floor])), floor_seen=True)


def in_plan_frame(world: PlanWorld, quarters: int | None = None, shift_m: tuple[float, float] | None = None) -> PlanWorld:
    """The world turned so that the longest wall runs along x (unless `quarters` are given), its lower left corner at the origin.

    `shift_m` instead of that corner keeps the frame of an earlier plan.
    """
    turns = (0 if _longest_runs_along_x(world) else 1) if quarters is None else quarters
    if shift_m is None:
        axis, _, offset, _ = _moved_planes(world, _quarter_turns(turns), np.zeros(3))
        seen = _support_of_planes(world) > 0
        shift_m = -_lowest(offset[seen & (axis == AXIS_X)]), -_lowest(offset[seen & (axis == AXIS_Y)])
    return moved(world, turns, np.array([*shift_m, 0.0]))


def _lowest(offset_m: Array) -> float:
    """The lowest coordinate, rounded down to whole metres."""
    return float(np.floor(offset_m.min())) if len(offset_m) else 0.0


def _longest_runs_along_x(world: PlanWorld) -> bool:
    """Whether the plane with the most 5 cm cells of points along it runs along x."""
    upright = np.flatnonzero((world.point_plane != NO_PLANE) & (world.plane_axis[world.point_plane] != AXIS_Z))
    if not len(upright):
        return True
    plane = world.point_plane[upright]
    along = np.where(world.plane_axis[plane] == AXIS_X, world.point_m[upright, AXIS_Y], world.point_m[upright, AXIS_X])
    cells = np.unique(plane.astype(np.int64) * CELLS_PER_PLANE + np.floor(along / RUN_CELL_M).astype(np.int64) % CELLS_PER_PLANE)
    longest = int(np.argmax(np.bincount(cells // CELLS_PER_PLANE)))
    return bool(world.plane_axis[longest] == AXIS_Y)


def moved(world: PlanWorld, quarters: int, shift_m: Array) -> PlanWorld:
    """The world turned by quarter turns counter-clockwise, then shifted; the transform is remembered."""
    turn, shift = _quarter_turns(quarters), np.asarray(shift_m, dtype=np.float64)
    axis, facing, offset, extent = _moved_planes(world, turn, shift)
    trajectory = Trajectory(
        world.trajectory.stamp_ns, world.trajectory.position_m @ turn.T + shift, turn @ world.trajectory.world_from_sensor
    )
    total = turn @ np.array(world.shift_m) + shift
    return replace(
        world,
        trajectory=trajectory,
        plane_axis=axis,
        plane_facing=facing,
        plane_offset_m=offset,
        plane_extent_m=extent,
        point_m=_moved_points(world.point_m, turn, shift),
        rotation_quarters=(world.rotation_quarters + quarters) % 4,
        shift_m=(float(total[0]), float(total[1]), float(total[2])),
    )


def _quarter_turns(quarters: int) -> Array:
    """The rotation (3, 3) about z by quarter turns counter-clockwise: whole numbers."""
    return np.asarray(np.rint(rotation_about_z(np.array(quarters * np.pi / 2))))


def _moved_points(point_m: Array, turn: Array, shift: Array) -> Array:
    """The points (P, 3) after quarter turns `turn` and `shift`: each coordinate is one of the old ones, its sign kept or changed."""
    moved = np.empty_like(point_m)
    for axis, source in enumerate(np.abs(turn).argmax(axis=1)):
        np.multiply(point_m[:, source], turn[axis, source], out=moved[:, axis])
        moved[:, axis] += shift[axis]
    return moved


def _moved_planes(world: PlanWorld, turn: Array, shift: Array) -> tuple[Array, Array, Array, Array]:
    new_axis = np.abs(turn).argmax(axis=0)  # where each old axis goes
    sign = turn.sum(axis=0)  # and whether it is reversed
    axis = new_axis[world.plane_axis]
    facing = (world.plane_facing * sign[world.plane_axis]).astype(np.int64)
    offset = world.plane_offset_m * sign[world.plane_axis] + shift[axis]
    extent = np.empty_like(world.plane_extent_m)
    for old in range(3):
        box = np.sort(world.plane_extent_m[:, old] * sign[old], axis=1)
        extent[:, new_axis[old]] = box + shift[new_axis[old]]
    return axis, facing, offset, extent
