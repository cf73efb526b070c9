"""Model space on the site grid: everything drawn in the plan frame is turned and shifted at the end, and the views follow."""

import math
from typing import TYPE_CHECKING

from floorplan.model.site import Site
from floorplan.writers.composition import Composition
from floorplan.writers.dxf_document import SCREEN_ASPECT, VIEW_MARGIN

if TYPE_CHECKING:
    from ezdxf.document import Drawing


def place_on_site(document: "Drawing", composition: Composition) -> None:
    """Move model space to where the plan's site says; the sheet's view turns along, so that paper keeps its look."""
    site = composition.plan.site
    if site is None:
        return
    from ezdxf import transform
    from ezdxf.math import Matrix44

    per, space = composition.units.per_metre, document.modelspace()
    turn = Matrix44.z_rotate(math.radians(site.rotation_deg))
    transform.inplace(space, turn @ Matrix44.translate(site.east_m * per, site.north_m * per, 0))
    _turn_sheet(document, composition, site)
    _set_view(document)


def _turn_sheet(document: "Drawing", composition: Composition, site: Site) -> None:
    """The sheet's viewport looks at the same part of the plan, turned back upright."""
    per, area = composition.units.per_metre, composition.sheet.drawing
    centre = [composition.scale.model_m(area.centre[k] - composition.paper_origin_mm[k]) for k in range(2)]
    east, north = site.to_site((centre[0], centre[1]))
    for viewport in document.paperspace().query("VIEWPORT"):
        if viewport.dxf.id > 1:  # the first one is the paper itself
            viewport.dxf.view_target_point = (east * per, north * per, 0)
            viewport.dxf.view_center_point = (0, 0)
            viewport.dxf.view_twist_angle = -site.rotation_deg % 360


def _set_view(document: "Drawing") -> None:
    """Extents, and a start view on the whole plan."""
    from ezdxf.bbox import extents

    space = document.modelspace()
    box = extents(space, fast=True)
    if not box.has_data:
        return
    space.reset_extents(box.extmin, box.extmax)
    height = max(box.size.y, box.size.x / SCREEN_ASPECT) * VIEW_MARGIN
    document.set_modelspace_vport(height, (box.center.x, box.center.y))
