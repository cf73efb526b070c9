"""Where a wall begins and ends along its plane, more finely than the cells of the ray counts."""

import numpy as np

from floorplan.model.checks import Array
from floorplan.plan.surface_evidence import FINE_CELLS, PlaneEvidence

SMOOTH_CELLS = 3  # fine cells over which the density of hits is taken ...
SMEAR_CELLS = 10  # ... and how far behind the first hit it is full: 5 cm, more than range noise moves a reading
SEARCH_CELLS = 3  # the edge is looked for this many cells to both sides of the coarse one


def rays_beyond(evidence: PlaneEvidence, column: int, inward: int) -> bool:
    """Whether rays passed just beyond the edge at `column`: the end is a jamb or a free edge, not the end of what was looked at."""
    reach = SEARCH_CELLS
    beyond = slice(max(column - reach, 0), column) if inward > 0 else slice(column, column + reach)
    low, high = beyond.start * FINE_CELLS, beyond.stop * FINE_CELLS
    return bool(evidence.fine_passes[low:high].sum() > evidence.fine_hits[low:high].sum())


def refined_edge_m(evidence: PlaneEvidence, column: int, inward: int, inside: float, outside: float) -> float:
    """Coordinate of the edge near the beginning of `column`, the wall lying towards `inward` (+1 or -1).

    It is looked for at most `inside` and `outside` columns away, so that edges of neighbouring pieces cannot cross.
    The edge that leaves the fewest rays on the wrong side: hits beyond it and passes before it. Between equally good ones, the last
    hit; where rays passed beyond (a jamb), half the way to them, but no farther than hits lie apart. A surface is seen up to its edge,
    while rays that cross the opening close to a far jamb end on the jamb's side, too near behind the surface to have passed it.
    """
    before, after = (outside, inside) if inward > 0 else (inside, outside)
    low = max(int((column - min(before, SEARCH_CELLS)) * FINE_CELLS), 0)
    high = min(int((column + min(after, SEARCH_CELLS)) * FINE_CELLS), len(evidence.fine_hits))
    hits, passes = evidence.fine_hits[low:high], evidence.fine_passes[low:high]
    if not hits.any():  # behind a cabinet, or seen only above: no finer evidence
        return evidence.along_m(column)
    if inward < 0:
        hits, passes = hits[::-1], passes[::-1]
    wrong = np.concatenate(([0.0], np.cumsum(hits))) + np.concatenate((np.cumsum(passes[::-1])[::-1], [0.0]))
    best = np.flatnonzero(wrong <= wrong.min() + 1e-9)
    seen_beyond = passes[: best[0]].sum() > 0
    edge = float(best[-1])
    if seen_beyond:
        beginning = hits[best[-1] :]
        unseen = int(best[-1] - best[0])
        smeared = min(_smeared_cells(beginning), unseen) if unseen > SMOOTH_CELLS else 0
        edge += smeared if smeared else -min(0.5 * unseen, _hit_spacing(beginning))
    cells = low + edge if inward > 0 else high - edge
    return evidence.along_start_m + cells * evidence.along_step_m / FINE_CELLS


def _smeared_cells(hits: Array) -> int:
    """Cells at the beginning of a surface hit less than half as often as soon after: readings that range noise pushed over its edge."""
    if len(hits) < 2 * SMEAR_CELLS + SMOOTH_CELLS:
        return 0
    density = np.convolve(hits, np.ones(SMOOTH_CELLS), mode="valid")
    return int(np.argmax(density[: SMEAR_CELLS + 1] >= 0.5 * density[SMEAR_CELLS:].mean()))


def _hit_spacing(hits: Array) -> float:
    """How many cells apart the hits of a surface lie on the average."""
    return len(hits) / max(int(np.count_nonzero(hits)), 1)
