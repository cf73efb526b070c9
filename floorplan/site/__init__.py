"""The plan on the site grid, by control points or by a north angle."""

from floorplan.site.control import read_control
from floorplan.site.place import on_site

__all__ = ["on_site", "read_control"]
