"""Walls off the axes: upright patches of many frames merged to straight lines outside the Manhattan model."""

from dataclasses import dataclass, replace

import numpy as np

from floorplan.config import PlanConfig
from floorplan.geometry import wrap_to
from floorplan.model.checks import Array
from floorplan.model.plan import FreeLine
from floorplan.model.segment import FreePatches
from floorplan.plan.corners import FaceRun
from floorplan.plan.plan_frame import PlanWorld

SAME_ANGLE_RAD = np.deg2rad(4.0)  # patches of one surface, short ones are known no better
SAME_OFFSET_M = 0.10
SAME_GAP_M = 0.5  # along the line, between patches of one surface
MIN_OFF_AXIS_RAD = np.deg2rad(4.0)  # nearer to an axis it is a layout plane's business
MAX_FRAME_ERROR_DEG = 15.0  # no frame's rotation is farther off than this
DOUBLE_M, DOUBLE_SHARE, DOUBLE_SAMPLES = 0.30, 0.5, 21  # beside a face: nearer than a wall's thickness over half the length
CROSSING_M = 0.15  # two walls overrun each other by less than this where they meet
LEAF_TOP_M = 2.15  # a door leaf ends below this
BIN_M = 0.05  # grain at which a line's own readings are counted
ON_LINE_M = 0.04  # readings this near to it are the line's ...
OFF_FACES_M = 0.05  # ... unless they lie this near to a drawn face
MIN_OWN = 2  # readings of its own in a bin
OWN_SHARE = 0.7  # of a line's bins: one across the corner of a pier meets readings only where it crosses the pier's faces


@dataclass(frozen=True)
class FreeCluster:
    """Patches of one surface: `rows` of the table, `normal_rad` azimuth of the normal, `middle_m (2,)`, `low_m`, `high_m` along it."""

    rows: tuple[int, ...]
    normal_rad: float
    middle_m: Array
    low_m: float
    high_m: float
    weight: float


@dataclass(frozen=True)
class _Patches:
    """Patches in the plan frame, Q rows."""

    frame: Array
    normal_rad: Array
    start_m: Array
    end_m: Array
    height_m: Array
    sigma_m: Array
    weight: Array


def free_lines(patches: FreePatches, world: PlanWorld, faces: tuple[FaceRun, ...], config: PlanConfig) -> tuple[FreeLine, ...]:
    """Lines L1.. of surfaces that are long, high and often enough seen to be walls."""
    table = _in_plan_frame(patches, world)
    clusters: list[FreeCluster] = []
    for row in np.argsort(-table.weight, kind="stable"):
        _add(clusters, table, int(row))
    lines = [_line(cluster, table, world.heights) for cluster in clusters if _is_wall(cluster, table, world.heights, config)]
    lines = [line for line in lines if np.deg2rad(line.off_axis_deg) >= MIN_OFF_AXIS_RAD and not _doubles_a_face(line, faces)]
    lines = [line for line in lines if not faces or _own_share(line, world, faces, config) >= OWN_SHARE]
    ordered = sorted(lines, key=lambda line: (line.start, line.end))
    return tuple(replace(line, id=f"L{k + 1}") for k, line in enumerate(ordered))


def _own_share(line: FreeLine, world: PlanWorld, faces: tuple[FaceRun, ...], config: PlanConfig) -> float:
    """Share of a line's length with readings at wall height that no drawn face explains."""
    start, end = np.array(line.start), np.array(line.end)
    length = float(np.linalg.norm(end - start))
    along = (end - start) / length
    offset = world.point_m[:, :2] - start
    place = offset @ along
    on = (np.abs(offset @ np.array([-along[1], along[0]])) <= ON_LINE_M) & (place >= 0) & (place < length)
    if world.heights:
        on &= (world.point_m[:, 2] > config.wall_band_low_m) & (world.point_m[:, 2] < config.wall_band_high_m)
    rows = np.flatnonzero(on)
    for face in faces:
        across, beside = np.abs(world.point_m[rows, face.axis] - face.offset_m), world.point_m[rows, 1 - face.axis]
        within = (beside >= face.start_m - OFF_FACES_M) & (beside <= face.end_m + OFF_FACES_M)
        rows = rows[(across > OFF_FACES_M) | ~within]
    bins = max(int(length / BIN_M), 1)
    own = np.bincount((place[rows] / length * bins).astype(np.int64), minlength=bins)
    return float((own >= MIN_OWN).mean())


def _doubles_a_face(line: FreeLine, faces: tuple[FaceRun, ...]) -> bool:
    """Whether a line crosses a drawn face, or runs beside one for most of its length from frames whose rotation was wrong."""
    if _crosses(line, faces):
        return True
    if line.off_axis_deg > MAX_FRAME_ERROR_DEG:
        return False
    points = np.linspace(line.start, line.end, DOUBLE_SAMPLES)
    steep = abs(line.end[1] - line.start[1]) > abs(line.end[0] - line.start[0])
    beside = np.zeros(DOUBLE_SAMPLES, dtype=bool)
    for face in (face for face in faces if face.axis == (0 if steep else 1)):
        along, across = points[:, 1 - face.axis], np.abs(points[:, face.axis] - face.offset_m)
        beside |= (along >= face.start_m) & (along <= face.end_m) & (across <= DOUBLE_M)
    return bool(beside.mean() > DOUBLE_SHARE)


def _crosses(line: FreeLine, faces: tuple[FaceRun, ...]) -> bool:
    """Whether a line goes through a face well inside both: walls end at each other."""
    (x0, y0), (x1, y1) = line.start, line.end
    length = float(np.hypot(x1 - x0, y1 - y0))
    for face in faces:
        a, b = (x0, x1) if face.axis == 0 else (y0, y1)
        if a == b or not 0 < (share := (face.offset_m - a) / (b - a)) < 1:
            continue
        along = (y0 + share * (y1 - y0)) if face.axis == 0 else (x0 + share * (x1 - x0))
        inside = min(share, 1 - share) * length > CROSSING_M
        if inside and face.start_m + CROSSING_M < along < face.end_m - CROSSING_M:
            return True
    return False


def _in_plan_frame(patches: FreePatches, world: PlanWorld) -> _Patches:
    quarter = world.rotation_quarters * np.pi / 2
    c, s = np.round(np.cos(quarter)), np.round(np.sin(quarter))
    turn = np.array([[c, -s], [s, c]])
    at = world.trajectory.position_m[patches.frame]
    return _Patches(
        patches.frame,
        patches.normal_yaw_rad + quarter,
        patches.start_m @ turn.T + at[:, :2],
        patches.end_m @ turn.T + at[:, :2],
        patches.height_m + at[:, 2:],
        patches.sigma_m,
        patches.pixels.astype(np.float64),
    )


def _add(clusters: list[FreeCluster], table: _Patches, row: int) -> None:
    """Put a patch into the first cluster it lies on, or begin a new one; the heaviest patches come first."""
    for k, cluster in enumerate(clusters):
        if _belongs(cluster, table, row):
            clusters[k] = _cluster((*cluster.rows, row), table)
            return
    clusters.append(_cluster((row,), table))


def _belongs(cluster: FreeCluster, table: _Patches, row: int) -> bool:
    if abs(wrap_to(np.array(table.normal_rad[row] - cluster.normal_rad), 2 * np.pi)) > SAME_ANGLE_RAD:
        return False
    normal, along = _directions(cluster.normal_rad)
    ends = np.stack((table.start_m[row], table.end_m[row])) - cluster.middle_m
    places = np.sort(ends @ along)
    near = places[0] <= cluster.high_m + SAME_GAP_M and places[1] >= cluster.low_m - SAME_GAP_M
    return bool(near and abs((ends @ normal).mean()) <= SAME_OFFSET_M)


def _cluster(rows: tuple[int, ...], table: _Patches) -> FreeCluster:
    """Mean line of patches: the normal from the scatter of all ends, weighted by pixels."""
    index = np.array(rows)
    ends = np.concatenate((table.start_m[index], table.end_m[index]))
    weight = np.concatenate((table.weight[index], table.weight[index]))
    middle = np.average(ends, axis=0, weights=weight)
    scatter = ((ends - middle) * weight[:, None]).T @ (ends - middle)
    normal = np.linalg.eigh(scatter)[1][:, 0]
    rough = table.normal_rad[index[0]]
    if normal @ np.array([np.cos(rough), np.sin(rough)]) < 0:
        normal = -normal
    angle = float(np.arctan2(normal[1], normal[0]))
    places = (ends - middle) @ _directions(angle)[1]
    return FreeCluster(rows, angle, middle, float(places.min()), float(places.max()), float(weight.sum()))


def _directions(normal_rad: float) -> tuple[Array, Array]:
    normal = np.array([np.cos(normal_rad), np.sin(normal_rad)])
    return normal, np.array([-normal[1], normal[0]])


def _is_wall(cluster: FreeCluster, table: _Patches, heights: bool, config: PlanConfig) -> bool:
    """Long enough, seen often enough, and as high as a wall; longer or higher than a door leaf that stands open."""
    rows = np.array(cluster.rows)
    length = cluster.high_m - cluster.low_m
    if len(np.unique(table.frame[rows])) < config.min_frames or length < config.min_free_length_m:
        return False
    if not heights:
        return True
    low, high = table.height_m[rows, 0].min(), table.height_m[rows, 1].max()
    leaf = length <= config.max_door_width_m and high < LEAF_TOP_M
    return bool(low <= config.wall_band_low_m and high >= config.wall_band_high_m and not leaf)


def _line(cluster: FreeCluster, table: _Patches, heights: bool) -> FreeLine:
    rows = np.array(cluster.rows)
    along = _directions(cluster.normal_rad)[1]
    start, end = cluster.middle_m + cluster.low_m * along, cluster.middle_m + cluster.high_m * along
    sigma = float(np.sqrt(np.average(table.sigma_m[rows] ** 2, weights=table.weight[rows])))
    off_axis = abs(float(np.rad2deg(wrap_to(np.array(cluster.normal_rad), np.pi / 2))))
    low = float(table.height_m[rows, 0].min()) if heights else None
    high = float(table.height_m[rows, 1].max()) if heights else None
    ends = sorted(((float(start[0]), float(start[1])), (float(end[0]), float(end[1]))))
    return FreeLine("", ends[0], ends[1], sigma, off_axis, low, high)
