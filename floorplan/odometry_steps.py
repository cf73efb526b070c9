"""Steps between keyframes in the axis-aligned world: the odometry's own, and the links between scans recorded one after the other."""

import numpy as np

from floorplan.model.checks import Array
from floorplan.model.scan import IngestedScan


def keyframe_steps(scan: IngestedScan, world_from_sensor: Array) -> Array:
    """Steps (F-1, 3) of the keyframes, odometry's turned by their rotations (F, 3, 3), and between two scans the link's."""
    recording, rows = scan.recording, scan.keyframe
    steps = odometry_rows(recording.position_m[rows], recording.odom_from_sensor[rows], world_from_sensor)
    for part in scan.linked:
        steps[part.first_keyframe - 1] = part.link_m
    return steps


def odometry_rows(position_odom_m: Array, odom_from_sensor: Array, world_from_sensor: Array) -> Array:
    """`t_i = R_i R_odo_i^T (o_{i+1} - o_i)` (N-1, 3): odometry's step turned into the axis-aligned world.

    Between keyframes the odometry's own poses carry the frames left out, so the keyframes' positions suffice.
    """
    world_from_odom = world_from_sensor[:-1] @ np.swapaxes(odom_from_sensor[:-1], 1, 2)
    return np.asarray(np.einsum("nij,nj->ni", world_from_odom, np.diff(position_odom_m, axis=0)))
