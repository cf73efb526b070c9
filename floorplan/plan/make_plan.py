"""The plan in named steps."""

from concurrent.futures import Executor, ThreadPoolExecutor
from dataclasses import dataclass

import numpy as np

from floorplan.config import PlanConfig
from floorplan.model.checks import Array
from floorplan.model.graph import LayoutSolution
from floorplan.model.plan import Dimension, Plan, PlanPlane, Rejection, Room
from floorplan.model.scan import IngestedScan, Trajectory
from floorplan.model.segment import NO_SEGMENT, FreePatches, SegmentedScan, Tracks
from floorplan.plan.behind_glass import walls_behind_glass
from floorplan.plan.bodies import Body, bodies_of, junction_blocks, paired_faces, solid
from floorplan.plan.chains import outside_chains
from floorplan.plan.columns import as_columns, column_bodies, column_faces
from floorplan.plan.corners import FaceRun, agreed_jambs, joined_corners
from floorplan.plan.dimensions import numbered, wall_to_wall
from floorplan.plan.doubles import without_doubles
from floorplan.plan.faces import Run, find_runs
from floorplan.plan.free_lines import free_lines
from floorplan.plan.free_space import free_space
from floorplan.plan.gaps import Gap, find_gaps
from floorplan.plan.glazing import as_glazing, glazed_lines
from floorplan.plan.idle_planes import without_idle_planes
from floorplan.plan.mullions import mullion_rows, unglazed
from floorplan.plan.notes import plan_notes, through_glass_notes
from floorplan.plan.openings import find_openings, with_walls
from floorplan.plan.outline import gross_outline
from floorplan.plan.overlooked import with_overlooked
from floorplan.plan.panes import paned_gaps
from floorplan.plan.plan_frame import PlanWorld, in_plan_frame, on_the_floor, solved_world
from floorplan.plan.posts import standing_posts
from floorplan.plan.returns import steps, with_steps
from floorplan.plan.room_facts import RoomHeight, described, height_dimensions, level_points, room_height
from floorplan.plan.rooms import RoomScene, find_rooms
from floorplan.plan.sigma_parts import with_sigma_parts
from floorplan.plan.storeys import floor_heights_m, frames_of_storeys, patches_of, stacked, storeys
from floorplan.plan.surface_evidence import PlaneEvidence, surface_evidence
from floorplan.plan.walls import draw_walls, without_columns
from floorplan.plan.window_panes import pane_rejections, panes_of_windows, without_panes

DRAWN_POINTS = 20_000  # evidence points kept for the drawing: enough to see, few enough for any CAD program


def make_plan(
    scan: IngestedScan,
    segmented: SegmentedScan,
    tracks: Tracks,
    solution: LayoutSolution,
    trajectory: Trajectory,
    config: PlanConfig,
    jobs: int = 1,
) -> Plan:
    """The floor plan; `trajectory` holds the final poses of the keyframes in the axis-aligned world of the solution.

    Rays are followed on `jobs` threads; the plan does not depend on their number.
    """
    world = _framed(on_the_floor(solved_world(scan, segmented, tracks, solution, trajectory)), solution)
    solved = len(solution.plane_offset_m)
    with ThreadPoolExecutor(jobs) as workers:
        world = with_overlooked(world, segmented.evidence.segment == NO_SEGMENT, segmented.free_patches, config, workers)
        levels = storeys(world)
        if len(levels) == 1:
            return without_idle_planes(storey_plan(world, segmented.free_patches, solution, config, workers), solved)
        frames = frames_of_storeys(world, floor_heights_m(world))
        patches = [patches_of(segmented.free_patches, world, rows) for rows in frames]
        plans = tuple(storey_plan(level, seen, solution, config, workers) for level, seen in zip(levels, patches, strict=True))
    return without_idle_planes(stacked(plans), solved)


def storey_plan(world: PlanWorld, patches: FreePatches, solution: LayoutSolution, config: PlanConfig, workers: Executor) -> Plan:
    """The plan of one storey; `patches` of its frames, `workers` to follow rays."""
    followed, levelled = workers.submit(free_space, world), workers.submit(level_points, world)
    planes, covariance = plan_planes(world, solution), joint_covariance(world, solution)
    ids = tuple(plane.id for plane in planes)
    surfaces = wall_surfaces(world, config, workers)
    faces, bodies, gaps = surfaces.faces, surfaces.bodies, surfaces.gaps
    matter = solid(bodies, junction_blocks(bodies))
    mullioned = glazed_lines(world, faces, config) + mullion_rows(faces, gaps)
    glazed = mullioned + paned_gaps(world, faces, gaps, mullioned, config)
    through = walls_behind_glass(world, surfaces.evidence, faces, glazed, config)
    drawing = draw_walls(faces + through.faces, bodies, matter, covariance, ids)
    glimpsed = frozenset(ids[face.run.plane] for face in through.faces)
    columns = column_bodies(bodies, faces)
    space = followed.result()
    unseen_steps = steps(faces, space, config)
    walls = with_steps(without_columns(drawing, column_faces(columns, faces)), unseen_steps)
    path = world.trajectory.position_m[:, :2]
    openings = with_walls(find_openings(unglazed(gaps, faces, glazed, path), faces, path, surfaces.thick, config), walls)
    lines = free_lines(patches, world, faces, config)
    bare_rooms = find_rooms(RoomScene(faces + through.faces, gaps, bodies, glazed, unseen_steps, space, path, lines), config)
    level = levelled.result()
    levels = tuple(room_height(room, level, world) for room in bare_rooms)
    rooms = described(bare_rooms, levels, faces, lines, planes, covariance)
    return Plan(
        planes=planes,
        faces=drawing.faces,
        walls=walls,
        trajectory=world.trajectory,
        rotation_quarters=world.rotation_quarters,
        shift_m=np.array(world.shift_m),
        free_lines=lines,
        glazing=as_glazing(glazed),
        openings=openings,
        rooms=rooms,
        columns=as_columns(columns),
        dimensions=with_sigma_parts(_dimensions(faces, rooms, levels, planes, covariance), ids, solution.error_parts),
        gross_outline=gross_outline(rooms, matter, config.max_thickness_m),
        plane_covariance_m2=None if solution.plane_covariance_m2 is None else covariance,
        evidence_xy_m=_drawn_points(world, config),
        rejections=surfaces.rejections + through.rejections,
        notes=plan_notes(rooms, lines, world.heights, world.floor_seen) + through_glass_notes(walls, drawing.faces, glimpsed),
        floor_seen=world.floor_seen,
    )


def _dimensions(
    faces: tuple[FaceRun, ...], rooms: tuple[Room, ...], levels: tuple[RoomHeight | None, ...], planes: tuple[PlanPlane, ...], cov: Array
) -> tuple[Dimension, ...]:
    """Inside the rooms, outside in chains, and heights, numbered through."""
    ids = tuple(plane.id for plane in planes)
    drawn = outside_chains(faces, rooms, wall_to_wall(faces, rooms, cov, ids), cov, ids)
    return numbered(drawn + height_dimensions(rooms, levels, planes, cov))


@dataclass(frozen=True)
class WallSurfaces:
    """What is wall: `faces` with clean ends, `bodies` between opposite ones, `gaps` in them, `thick` the faces of bodies."""

    faces: tuple[FaceRun, ...]
    bodies: tuple[Body, ...]
    gaps: tuple[Gap, ...]
    thick: frozenset[int]
    rejections: tuple[Rejection, ...]
    evidence: tuple[PlaneEvidence, ...]


def wall_surfaces(world: PlanWorld, config: PlanConfig, workers: Executor) -> WallSurfaces:
    """Judge all upright planes by their rays and join what is wall."""
    evidence = surface_evidence(world, config, workers)
    found = find_runs(evidence, config, world.heights)
    walls, slender = (tuple(_face_run(run, world) for run in runs) for runs in (found.runs, found.posts))
    single, doubled = without_doubles(walls + standing_posts(slender, walls), evidence, config, world.heights)
    faces = joined_corners(single, config.max_bridged_gap_m)
    panes = panes_of_windows(faces, find_gaps(faces, evidence, config, world.heights), config)
    faces = joined_corners(without_panes(single, panes), config.max_bridged_gap_m)
    pairs = paired_faces(faces, config)
    faces = agreed_jambs(faces, pairs)
    gaps = find_gaps(faces, evidence, config, world.heights)
    thick = frozenset(index for pair in pairs for index in pair)
    return WallSurfaces(faces, bodies_of(faces, pairs), gaps, thick, found.rejections + doubled + pane_rejections(single, panes), evidence)


def _framed(world: PlanWorld, solution: LayoutSolution) -> PlanWorld:
    """In the plan frame; a calibrated plan lies where the plan lay that the distances were measured in."""
    known = solution.calibration
    return in_plan_frame(world) if known is None else in_plan_frame(world, known.plan_quarters, known.plan_shift_m)


def joint_covariance(world: PlanWorld, solution: LayoutSolution) -> Array:
    """The planes' joint covariance; independent planes where the solution came without one, and where they are no part of it."""
    known = len(solution.plane_offset_m)
    covariance = np.diag(world.plane_sigma_m**2)
    if solution.plane_covariance_m2 is not None:
        covariance[:known, :known] = solution.plane_covariance_m2
    return covariance


def plan_planes(world: PlanWorld, solution: LayoutSolution) -> tuple[PlanPlane, ...]:
    """All planes of the solution in the plan frame, whether they are wall or not; unknown extents become their offset."""
    planes = []
    for k in range(len(world.plane_axis)):
        extent = np.nan_to_num(world.plane_extent_m[k], nan=0.0)
        x, y, z = ((float(low), float(high)) for low, high in extent)
        tracks = tuple(int(t) for t in np.flatnonzero(solution.plane_of_track == k))
        offset, sigma = float(world.plane_offset_m[k]), float(world.plane_sigma_m[k])
        facing, frames = int(world.plane_facing[k]), int(world.plane_frames[k])
        planes.append(PlanPlane(f"P{k + 1}", int(world.plane_axis[k]), facing, offset, sigma, (x, y, z), tracks, frames))
    return tuple(planes)


def _face_run(run: Run, world: PlanWorld) -> FaceRun:
    k = run.plane
    return FaceRun(run, int(world.plane_axis[k]), int(world.plane_facing[k]), float(world.plane_offset_m[k]), float(world.plane_sigma_m[k]))


def _drawn_points(world: PlanWorld, config: PlanConfig) -> Array:
    """An even selection of the evidence points at wall height (V, 2)."""
    z = world.point_m[:, 2]
    chosen = np.flatnonzero((z > config.wall_band_low_m) & (z < config.wall_band_high_m)) if world.heights else np.arange(len(z))
    step = max(1, len(chosen) // DRAWN_POINTS)
    return np.round(world.point_m[chosen[::step], :2].astype(np.float64), 3)
