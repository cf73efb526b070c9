"""Two surveys of one floor: aligned by their walls, then compared wall by wall, opening by opening, distance by distance."""

from floorplan.compare.changes import Comparison, compare_surveys
from floorplan.compare.survey import Survey, survey_of

__all__ = ["Comparison", "Survey", "compare_surveys", "survey_of"]
