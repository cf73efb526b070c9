"""The report of a finished work folder, as a file."""

from pathlib import Path

from floorplan.config import Config
from floorplan.errors import UsageError
from floorplan.export import read_results
from floorplan.laser.compare import check_plan
from floorplan.laser.table import BadRow, read_laser
from floorplan.report.page import report_html
from floorplan.results import summary, trajectories
from floorplan.work.disk import clear_disk_errors
from floorplan.work.folder import read_owner
from floorplan.writers import write_atomically


def write_report(work: Path, config: Config, out: Path, laser: Path | None = None) -> tuple[BadRow, ...]:
    """Write the page; gives the rows of `laser` that could not be compared. Raises UsageError where it cannot be written."""
    if not out.parent.is_dir() or out.is_dir():
        raise UsageError(f"{out}: give the name of a file in a folder that exists")
    owner, results = read_owner(work), read_results(work)
    check = None if laser is None else check_plan(results.plan, read_laser(laser), results.solution.calibration)
    table = summary(results, trajectories(results), Path(owner.scan), work, config)
    with clear_disk_errors(out):
        write_atomically(out, report_html(results, table, owner, config, check).encode("utf-8"))
    return check.bad if check else ()
