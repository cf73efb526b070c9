"""Stage `6-plan`: from planes and rays to a floor plan; read `make_plan` first."""

from floorplan.plan.make_plan import make_plan

__all__ = ["make_plan"]
