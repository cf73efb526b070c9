"""The plan in named steps."""

import numpy as np

from floorplan.config import PlanConfig
from floorplan.model.checks import Array
from floorplan.model.graph import LayoutSolution
from floorplan.model.plan import Plan, PlanPlane
from floorplan.model.scan import IngestedScan, Trajectory
from floorplan.model.segment import SegmentedScan, Tracks
from floorplan.plan.bodies import bodies_of, junction_blocks, paired_faces, solid
from floorplan.plan.columns import find_columns
from floorplan.plan.corners import FaceRun, agreed_jambs, joined_corners
from floorplan.plan.dimensions import numbered, wall_to_wall
from floorplan.plan.doubles import without_doubles
from floorplan.plan.faces import Run, find_runs
from floorplan.plan.free_lines import free_lines
from floorplan.plan.free_space import free_space
from floorplan.plan.gaps import find_gaps
from floorplan.plan.glazing import as_glazing, glazed_lines
from floorplan.plan.openings import find_openings
from floorplan.plan.outline import gross_outline
from floorplan.plan.plan_frame import PlanWorld, in_plan_frame, on_the_floor, solved_world
from floorplan.plan.room_facts import height_dimensions, room_height, with_area_sigma, with_ceiling
from floorplan.plan.rooms import RoomScene, find_rooms
from floorplan.plan.surface_evidence import surface_evidence
from floorplan.plan.walls import draw_walls

DRAWN_POINTS = 20_000  # evidence points kept for the drawing: enough to see, few enough for any CAD program


def make_plan(
    scan: IngestedScan, segmented: SegmentedScan, tracks: Tracks, solution: LayoutSolution, trajectory: Trajectory, config: PlanConfig
) -> Plan:
    """The floor plan; `trajectory` holds the final poses of the keyframes in the axis-aligned world of the solution."""
    world = in_plan_frame(on_the_floor(solved_world(scan, segmented, tracks, solution, trajectory)))
    planes = plan_planes(world, solution)
    ids = tuple(plane.id for plane in planes)
    evidence = surface_evidence(world, config)
    found = find_runs(evidence, config, world.heights)
    single, doubled = without_doubles(tuple(_face_run(run, world) for run in found.runs), evidence, config, world.heights)
    faces = joined_corners(single, config.max_bridged_gap_m)
    pairs = paired_faces(faces, config)
    faces = agreed_jambs(faces, pairs)
    bodies = bodies_of(faces, pairs)
    matter = solid(bodies, junction_blocks(bodies))
    covariance = joint_covariance(solution)
    drawing = draw_walls(faces, bodies, matter, covariance, ids)
    glazed = glazed_lines(world, faces, config)
    gaps = find_gaps(faces, evidence, config, world.heights)
    path = world.trajectory.position_m[:, :2]
    openings = find_openings(gaps, faces, path, {index for pair in pairs for index in pair}, config)
    rooms = find_rooms(RoomScene(faces, gaps, bodies, glazed, free_space(world), path), config)
    levels = tuple(room_height(room, world) for room in rooms)
    rooms = tuple(
        with_ceiling(with_area_sigma(room, faces, covariance), level, planes, covariance) for room, level in zip(rooms, levels, strict=True)
    )
    dimensions = wall_to_wall(faces, rooms, covariance, ids) + height_dimensions(rooms, levels, planes, covariance)
    return Plan(
        planes=planes,
        faces=drawing.faces,
        walls=drawing.walls,
        trajectory=world.trajectory,
        rotation_quarters=world.rotation_quarters,
        shift_m=np.array(world.shift_m),
        dimensions=numbered(dimensions),
        free_lines=free_lines(segmented.free_patches, world, faces, config),
        glazing=as_glazing(glazed),
        openings=openings,
        columns=find_columns(bodies, faces),
        rooms=rooms,
        gross_outline=gross_outline(rooms, matter, config.max_thickness_m),
        plane_covariance_m2=solution.plane_covariance_m2,
        evidence_xy_m=_drawn_points(world, config),
        rejections=found.rejections + doubled,
        floor_seen=world.floor_seen,
    )


def joint_covariance(solution: LayoutSolution) -> Array:
    """The planes' joint covariance; independent planes where the solution came without one."""
    if solution.plane_covariance_m2 is not None:
        return solution.plane_covariance_m2
    return np.diag(solution.plane_sigma_m**2)


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
    return np.round(world.point_m[chosen[::step], :2], 3)
