"""Lines found in the readings that nothing is drawn on are no planes of the plan."""

from dataclasses import replace

import numpy as np

from floorplan.model.checks import Array
from floorplan.model.plan import Plan


def without_idle_planes(plan: Plan, solved: int) -> Plan:
    """The plan with the first `solved` planes, those of the solution, and of the others those that a face of any storey lies on."""
    drawn = {face.plane for storey in plan.storeys for face in storey.faces}
    kept = np.array([k < solved or plane.id in drawn for k, plane in enumerate(plan.planes)], dtype=bool)
    upper = tuple(_only(storey, kept) for storey in plan.upper_storeys)
    return replace(_only(plan, kept), upper_storeys=upper)


def _only(plan: Plan, kept: Array) -> Plan:
    planes = tuple(plane for plane, keep in zip(plan.planes, kept, strict=True) if keep)
    covariance = plan.plane_covariance_m2
    return replace(plan, planes=planes, plane_covariance_m2=None if covariance is None else covariance[np.ix_(kept, kept)])
