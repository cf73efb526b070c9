"""Stage `4-merge`: which initial planes are one and the same."""

from floorplan.config import MergeConfig
from floorplan.errors import ConfigError
from floorplan.least_squares import published_least_squares
from floorplan.merge.evidence import merge_evidence
from floorplan.merge.hypotheses import Pairs, no_pairs
from floorplan.merge.paper import merge_paper
from floorplan.model.graph import LayoutGraph, LeastSquaresSolution, MergeResult


def merge(graph: LayoutGraph, least_squares: LeastSquaresSolution, config: MergeConfig, never: Pairs | None = None) -> MergeResult:
    """The decisions of `config.method` about every hypothesis, and the planes they make; no plane holds both tracks of a pair of `never`.

    Raises NoSolutionError when the method's problem has no solution that passes our checks.
    """
    never = no_pairs() if never is None else never
    if config.method == "evidence":
        return merge_evidence(graph, least_squares, config, never)
    if config.method == "paper":
        return merge_paper(graph, published_least_squares(graph, least_squares), config, never)
    raise ConfigError(f"merge.method = '{config.method}' is unknown; it is 'paper' or 'evidence'")
