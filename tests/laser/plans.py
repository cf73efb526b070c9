"""Two rooms side by side, 4.0 and 3.0 m wide and 5.0 m deep, a wall of 0.12 m between them; correlated planes."""

import numpy as np

from floorplan.model.plan import Certainty, Dimension, DimensionRole, Face, Plan, PlanPlane
from floorplan.model.scan import Trajectory

WEST, MID_WEST, MID_EAST, EAST, SOUTH, NORTH = 0.0, 4.0, 4.12, 7.12, 0.0, 5.0
SIGMA_M = 0.01
SHARED = 0.5  # correlation of any two planes


def two_rooms(scale: float = 1.0) -> Plan:
    """The plan, every coordinate times `scale`."""
    rows = [(0, 1, WEST), (0, -1, MID_WEST), (0, 1, MID_EAST), (0, -1, EAST), (1, 1, SOUTH), (1, -1, NORTH)]
    planes = tuple(
        PlanPlane(f"P{k + 1}", axis, facing, scale * offset, SIGMA_M, ((WEST, EAST), (SOUTH, NORTH), (0.0, 2.5)), (k,), 10)
        for k, (axis, facing, offset) in enumerate(rows)
    )
    faces = tuple(_face(k + 1, axis, scale * offset, scale) for k, (axis, _, offset) in enumerate(rows))
    covariance = SIGMA_M**2 * ((1 - SHARED) * np.eye(6) + SHARED)
    sigma = SIGMA_M * float(np.sqrt(2 * (1 - SHARED)))
    spans = [("P1", "P2", 0, 4.0, "R1"), ("P3", "P4", 0, 3.0, "R2"), ("P5", "P6", 1, 5.0, "R1")]
    dimensions = tuple(
        Dimension(f"D{k + 1}", DimensionRole.ROOM, a, b, axis, scale * length, sigma, (0.0, 1.0), (1.0, 1.0), (0.5, 1.0), room)
        for k, (a, b, axis, length, room) in enumerate(spans)
    )
    path = Trajectory(np.arange(2), np.zeros((2, 3)), np.tile(np.eye(3), (2, 1, 1)))
    return Plan(planes, faces, (), path, 0, np.zeros(3), dimensions=dimensions, plane_covariance_m2=covariance)


def _face(number: int, axis: int, offset: float, scale: float) -> Face:
    ends = ((offset, scale * SOUTH), (offset, scale * NORTH)) if axis == 0 else ((scale * WEST, offset), (scale * EAST, offset))
    return Face(f"F{number}", f"P{number}", *ends, Certainty.SEEN)
