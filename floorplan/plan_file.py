"""`plan.json` at the root of a work folder, read back."""

from pathlib import Path

from floorplan.errors import InputError, WorkFolderError
from floorplan.model.plan import Plan
from floorplan.plan.plan_json import plan_from_json

NAME = "plan.json"


def read_plan(work: Path) -> Plan:
    """The plan of a work folder, or of a `plan.json` that is named itself. Raises WorkFolderError when there is none."""
    path = work if work.is_file() else work / NAME
    try:
        text = path.read_text("utf-8")
    except OSError as error:
        raise WorkFolderError(f"{work}: no {NAME} in it; run 'floorplan build' on the scan first") from error
    except UnicodeDecodeError as error:
        raise InputError(f"{path} is not JSON (byte {error.start} is no UTF-8); build the plan again") from error
    return plan_from_json(text)
