"""The main numbers of each stage's result, for the log and `stage.json`."""

from floorplan.initial_layout import InitialLayout
from floorplan.model.graph import LayoutSolution, MergeResult
from floorplan.model.plan import Plan
from floorplan.model.scan import IngestedScan
from floorplan.model.segment import SegmentedScan

Counts = dict[str, int]


def count_scan(scan: IngestedScan) -> Counts:
    """Of `1-ingest`."""
    return {"frames": len(scan.recording), "keyframes": len(scan.keyframe), "problems": sum(p.count for p in scan.recording.problems)}


def count_segments(segmented: SegmentedScan) -> Counts:
    """Of `2-segments`."""
    counts = {"segments": len(segmented.segments), "frames without walls": int((~segmented.frames.measured).sum())}
    unreadable = sum(problem.count for problem in segmented.problems)
    return counts | ({"frames unreadable": unreadable} if unreadable else {})


def count_layout(layout: InitialLayout) -> Counts:
    """Of `3-least-squares`."""
    return {"initial planes": len(layout.tracks.axis), "measurements": len(layout.graph.frame)}


def count_merge(merged: MergeResult) -> Counts:
    """Of `4-merge`."""
    return {"hypotheses": len(merged.hypotheses), "accepted": int(merged.hypotheses.accepted.sum())}


def count_solution(solution: LayoutSolution) -> Counts:
    """Of `5-resolve`."""
    return {"planes": len(solution.plane_axis)}


def count_plan(plan: Plan) -> Counts:
    """Of `6-plan`."""
    levels = plan.storeys
    counts = {"storeys": len(levels)} if len(levels) > 1 else {}
    return counts | {
        "walls": sum(len(level.walls) for level in levels),
        "openings": sum(len(level.openings) for level in levels),
        "rooms": sum(len(level.rooms) for level in levels),
        "dimensions": sum(len(level.dimensions) for level in levels),
    }
