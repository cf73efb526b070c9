"""Stage `3-least-squares`: tracks, the layout graph they make, and its least squares."""

from dataclasses import dataclass

from floorplan.config import Config
from floorplan.errors import InputError
from floorplan.model.graph import LayoutGraph, LeastSquaresSolution
from floorplan.model.range_bias import RangeBias
from floorplan.model.scan import IngestedScan
from floorplan.model.segment import AXIS_Z, SegmentedScan, Tracks


@dataclass(frozen=True)
class InitialLayout:
    """Initial layout planes, the graph of their measurements, its least squares solution, and what that shows of the depth's own errors.

    `range_bias` None: rows without weights, or several scans in one.
    """

    tracks: Tracks
    graph: LayoutGraph
    least_squares: LeastSquaresSolution
    range_bias: RangeBias | None = None

    def before_merge(self, method: str) -> LeastSquaresSolution:
        """The least squares that the merge of `method` starts from: the published one's is unweighted, whatever was asked for."""
        if method != "paper":
            return self.least_squares
        from floorplan.least_squares import published_least_squares

        return published_least_squares(self.graph, self.least_squares)


def initial_layout(scan: IngestedScan, segmented: SegmentedScan, config: Config) -> InitialLayout:
    """Segments of consecutive frames to initial planes, and where least squares puts them. Raises `InputError` when no wall was found."""
    from floorplan.least_squares import least_squares

    tracks, graph = tracked_graph(scan, segmented, config)
    if not (tracks.axis != AXIS_Z).any():
        raise InputError(
            f"no wall found: {len(segmented.segments)} flat surfaces in {len(scan.keyframe)} frames, none of them an upright one along a "
            "common direction; see what 'floorplan info' says of ranges, intrinsics and gravity, and record walls from 1 to 4 m away"
        )
    solved = least_squares(graph, config.least_squares)
    return InitialLayout(tracks, graph, solved, _range_bias(scan, segmented, tracks, graph, solved))


def _range_bias(
    scan: IngestedScan, segmented: SegmentedScan, tracks: Tracks, graph: LayoutGraph, solved: LeastSquaresSolution
) -> RangeBias | None:
    from floorplan.noise.range_bias import estimate_range_bias, offset_lever

    if solved.noise is None or scan.parts:
        return None
    lever = offset_lever(graph, segmented.segments, tracks, scan.recording.sensor.kind)
    return estimate_range_bias(graph, solved.noise, solved, lever)


def tracked_graph(scan: IngestedScan, segmented: SegmentedScan, config: Config) -> tuple[Tracks, LayoutGraph]:
    """The tracks and their layout graph, before anything is solved."""
    from floorplan.layout_graph import layout_graph
    from floorplan.tracking import track

    tracks = track(scan, segmented, config.tracking)
    return tracks, layout_graph(scan, segmented, tracks)
