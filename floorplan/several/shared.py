"""Whether the joint solution bears the joining out: what every scan shares with the others, and how far its link had to give."""

from dataclasses import dataclass

import numpy as np

from floorplan.errors import NoSolutionError
from floorplan.model.checks import Array
from floorplan.model.graph import LayoutGraph, LayoutSolution
from floorplan.model.scan import IngestedScan
from floorplan.reporting import Reporter

MAX_LINK_SIGMAS = 5.0  # a link pulled further than this was wrong, or the merges are
AXIS_NAMES = ("x", "y")


@dataclass(frozen=True)
class SharedPlanes:
    """One scan of several: planes across x and across y that it shares with another, and how far its link moved, m."""

    name: str
    across_x: int
    across_y: int
    link_moved_m: float


def shared_planes(scan: IngestedScan, graph: LayoutGraph, solution: LayoutSolution) -> tuple[SharedPlanes, ...]:
    """One row per scan; none for a single one. Raises `NoSolutionError` where a scan hangs on nothing or its link was torn."""
    if not scan.parts:
        return ()
    seen = _seen_by(scan, graph, solution)
    common = seen & (seen.sum(axis=0) > 1)[None]
    moved = solution.position_m[graph.link + 1] - solution.position_m[graph.link] - graph.translation_m[graph.link]
    rows = []
    for k, part in enumerate(scan.parts):
        x, y = (int((common[k] & (solution.plane_axis == axis)).sum()) for axis in (0, 1))
        pull = moved[k - 1] if k else np.zeros(3)
        if not (x and y):
            missing = AXIS_NAMES[0] if not x else AXIS_NAMES[1]
            raise NoSolutionError(
                f"{part.name}: the joint solution found no wall across {missing} that it shares with another scan ({part.start}); "
                "scan more of what they have in common, or give better point pairs with --start F.csv"
            )
        if k and (np.abs(pull) > MAX_LINK_SIGMAS * np.array(part.link_sigma_m)).any():
            raise NoSolutionError(
                f"{part.name}: the joint solution moved it by {np.linalg.norm(pull):.2f} m from where it was laid ({part.start}); "
                "the scans contradict each other: look at the plans of each (WORK/scan-N), or give point pairs with --start F.csv"
            )
        rows.append(SharedPlanes(part.name, x, y, float(np.linalg.norm(pull))))
    return tuple(rows)


def _seen_by(scan: IngestedScan, graph: LayoutGraph, solution: LayoutSolution) -> Array:
    """Boolean (B, L): which scan saw which plane."""
    begins = [part.first_keyframe for part in scan.linked]
    of_row = np.searchsorted(begins, graph.frame, side="right")
    seen = np.zeros((len(scan.parts), len(solution.plane_axis)), dtype=bool)
    seen[of_row, solution.plane_of_track[graph.track]] = True
    return seen


def tell_shared(reporter: Reporter, rows: tuple[SharedPlanes, ...]) -> None:
    """One line per scan of several."""
    for row in rows:
        reporter.message(
            f"{row.name} shares {row.across_x} planes across x and {row.across_y} across y with the others; "
            f"its link gave by {1000 * row.link_moved_m:.0f} mm"
        )
