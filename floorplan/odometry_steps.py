"""Steps between keyframes in the axis-aligned world: the odometry's own, and the links between scans recorded one after the other."""

import numpy as np

from floorplan.geometry import rotation_about_z, wrap_to
from floorplan.model.checks import Array
from floorplan.model.scan import IngestedScan

_STRAIGHT_RAD = np.deg2rad(1.0)  # a map whose loops are closed is bent by less; a single frame's yaw is off by half of that


def keyframe_steps(scan: IngestedScan, world_from_sensor: Array) -> Array:
    """Steps (F-1, 3) of the keyframes, odometry's turned by their rotations (F, 3, 3), and between two scans the link's.

    Where the odometry is a map (see `IngestedScan`), it is turned as a whole: turned frame by frame, the small errors of the
    frames' own yaw would add up along the path and open its loops again.
    """
    recording, rows = scan.recording, scan.keyframe
    odom_from_sensor = recording.odom_from_sensor[rows]
    turned = _turned_as_a_whole(odom_from_sensor, world_from_sensor) if scan.mapped else world_from_sensor
    steps = odometry_rows(recording.position_m[rows], odom_from_sensor, turned)
    for part in scan.linked:
        steps[part.first_keyframe - 1] = part.link_m
    return steps


def odometry_rows(position_odom_m: Array, odom_from_sensor: Array, world_from_sensor: Array) -> Array:
    """`t_i = R_i R_odo_i^T (o_{i+1} - o_i)` (N-1, 3): odometry's step turned into the axis-aligned world.

    Between keyframes the odometry's own poses carry the frames left out, so the keyframes' positions suffice.
    """
    world_from_odom = world_from_sensor[:-1] @ np.swapaxes(odom_from_sensor[:-1], 1, 2)
    return np.asarray(np.einsum("nij,nj->ni", world_from_odom, np.diff(position_odom_m, axis=0)))


def _turned_as_a_whole(odom_from_sensor: Array, world_from_sensor: Array) -> Array:
    """Rotations (F, 3, 3) as the odometry has them, turned by one yaw; by what is left where a frame differs by more than a bend."""
    turn = world_from_sensor @ np.swapaxes(odom_from_sensor, 1, 2)
    yaw = np.unwrap(np.arctan2(turn[:, 1, 0], turn[:, 0, 0]))
    whole = float(np.median(yaw))
    off = wrap_to(yaw - whole, 2 * np.pi)
    bend = np.sign(off) * np.maximum(np.abs(off) - _STRAIGHT_RAD, 0.0)
    return np.asarray(rotation_about_z(whole + bend) @ odom_from_sensor)
