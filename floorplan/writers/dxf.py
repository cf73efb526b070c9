"""The DXF drawing: the plan in model space, the sheet in paper space; and an empty sheet to make a template from."""

import numpy as np

from floorplan.config import DrawingConfig, ProjectConfig
from floorplan.model.plan import Plan
from floorplan.model.scan import Trajectory
from floorplan.writers.composition import Composition, compose
from floorplan.writers.dxf_document import document_bytes, fixed_metadata, new_document
from floorplan.writers.dxf_plan import draw_plan
from floorplan.writers.dxf_sheet import add_title_block, draw_sheet
from floorplan.writers.dxf_site import place_on_site
from floorplan.writers.facts import SheetFacts
from floorplan.writers.title_block import TAGS

TEMPLATE_DXF_VERSION = "R2010"


def dxf_bytes(composition: Composition, version: str, project: ProjectConfig, facts: SheetFacts, template: str = "") -> bytes:
    """A DXF file of that version; the same bytes for the same input.

    Raises ConfigError for an unknown version or a template that lacks what it must own.
    """
    with fixed_metadata():
        document = new_document(composition, version, template)
        draw_plan(document, composition)
        draw_sheet(document, composition, project, facts)
        place_on_site(document, composition)
        return document_bytes(document, facts.date)


def template_bytes(drawing: DrawingConfig) -> bytes:
    """A template for the sheet and the layers of `drawing`, with our title block: what `templates/sheet-A3.dxf` was made with."""
    composition = compose(_no_plan(), drawing)
    with fixed_metadata():
        document = new_document(composition, TEMPLATE_DXF_VERSION)
        add_title_block(document, composition, dict.fromkeys(TAGS, ""))
        return document_bytes(document, "")


def _no_plan() -> Plan:
    path = Trajectory(np.zeros(0, dtype=np.int64), np.zeros((0, 3)), np.zeros((0, 3, 3)))
    return Plan((), (), (), path, 0, np.zeros(3))
