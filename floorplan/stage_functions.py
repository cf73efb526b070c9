"""The stages' functions, each imported when it is called: a build that finds a stage finished waits for none of its libraries."""

from floorplan.config import IngestConfig, MergeConfig, PlanConfig, ResolveConfig
from floorplan.edits.file import Edits
from floorplan.model.graph import LayoutGraph, LayoutSolution, LeastSquaresSolution, MergeResult
from floorplan.model.plan import Plan
from floorplan.model.scan import IngestedScan, Trajectory
from floorplan.model.segment import SegmentedScan, Tracks
from floorplan.readers.base import Source
from floorplan.reporting import Steps


def ingest(source: Source, config: IngestConfig, steps: Steps) -> IngestedScan:
    """See `floorplan.ingest`."""
    from floorplan.ingest import ingest as run

    return run(source, config, steps)


def merge(graph: LayoutGraph, least_squares: LeastSquaresSolution, config: MergeConfig, edits: Edits) -> MergeResult:
    """See `floorplan.merge`: with what a person forbade."""
    from floorplan.edits.merges import never_merged
    from floorplan.merge import merge as run

    return run(graph, least_squares, config, never_merged(graph, edits))


def resolve(graph: LayoutGraph, merged: MergeResult, config: ResolveConfig) -> LayoutSolution:
    """See `floorplan.resolve`."""
    from floorplan.resolve import resolve as run

    return run(graph, merged, config)


def make_plan(
    scan: IngestedScan,
    segmented: SegmentedScan,
    tracks: Tracks,
    solution: LayoutSolution,
    keyframes: Trajectory,
    config: PlanConfig,
    jobs: int,
) -> Plan:
    """See `floorplan.plan.make_plan`."""
    from floorplan.plan.make_plan import make_plan as run

    return run(scan, segmented, tracks, solution, keyframes, config, jobs)
