"""Stage `3-least-squares`: tracks, the layout graph they make, and its least squares."""

from dataclasses import dataclass

from floorplan.config import Config
from floorplan.layout_graph import layout_graph
from floorplan.least_squares import least_squares
from floorplan.model.graph import LayoutGraph, LeastSquaresSolution
from floorplan.model.scan import IngestedScan
from floorplan.model.segment import SegmentedScan, Tracks
from floorplan.tracking import track


@dataclass(frozen=True)
class InitialLayout:
    """Initial layout planes, the graph of their measurements, and its least squares solution."""

    tracks: Tracks
    graph: LayoutGraph
    least_squares: LeastSquaresSolution


def initial_layout(scan: IngestedScan, segmented: SegmentedScan, config: Config) -> InitialLayout:
    """Segments of consecutive frames to initial planes, and where least squares puts them."""
    tracks = track(scan, segmented, config.tracking)
    graph = layout_graph(scan, segmented, tracks)
    return InitialLayout(tracks, graph, least_squares(graph, config.least_squares))
