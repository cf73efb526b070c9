"""The back end's values: the layout graph and what each step of the method makes of it."""

from dataclasses import dataclass, field
from enum import StrEnum

import numpy as np

from floorplan.model.checks import Array, freeze
from floorplan.model.error_parts import ErrorParts
from floorplan.model.merges_made import MergesMade
from floorplan.model.noise import ScanNoise
from floorplan.model.plane_moves import AxisChoice, PlaneMove
from floorplan.model.scan import RangeAccuracy
from floorplan.model.ties import Calibration


@dataclass(frozen=True)
class LayoutGraph:
    """Measurements and odometry rows, N frames, K measurements, M tracks (the exchange format of the back end).

    `stamp_s (N,)`; `translation_m (N-1, 3)` odometry rows `t_i` in the axis-aligned world; measurement k says
    `m[track] - p[frame] = distance` along that track's axis: `frame (K,)`, `track (K,)`, `distance_m (K,)`;
    `axis (M,)`; `facing (M,)`; `extent_m (M, 3, 2)` box in dead-reckoned coordinates, NaN where unknown;
    `sigma_m (K,)` or None. `heading_sigma_rad` how well the yaw that turned the odometry rows is known.
    `range_accuracy` of the sensor, None where nothing is known of it.
    `map_sigma_m (N,)` where the odometry is a map with its loops closed: how well the place of each frame is known in it.
    Stamps are relative to nothing in particular: only their order and differences count.
    Several scans make one graph: `link (B,)` the odometry rows that lead from the last frame of one scan to the first of the
    next, no odometry but a rough pose known to `link_sigma_m (B, 3)`.
    """

    stamp_s: Array
    translation_m: Array
    frame: Array
    track: Array
    distance_m: Array
    axis: Array
    facing: Array
    extent_m: Array
    sigma_m: Array | None = None
    heading_sigma_rad: float = 0.0
    range_accuracy: RangeAccuracy | None = None
    map_sigma_m: Array | None = None
    link: Array = field(default_factory=lambda: np.zeros(0, dtype=np.int64))
    link_sigma_m: Array = field(default_factory=lambda: np.zeros((0, 3)))

    def __post_init__(self) -> None:
        sizes = freeze(
            self,
            {
                "stamp_s": (np.float64, ("N",)),
                "translation_m": (np.float64, ("T", 3)),
                "frame": (np.int64, ("K",)),
                "track": (np.int64, ("K",)),
                "distance_m": (np.float64, ("K",)),
                "axis": (np.int64, ("M",)),
                "facing": (np.int64, ("M",)),
                "extent_m": (np.float64, ("M", 3, 2)),
                "sigma_m": (np.float64, ("K",)),
                "map_sigma_m": (np.float64, ("N",)),
                "link": (np.int64, ("B",)),
                "link_sigma_m": (np.float64, ("B", 3)),
            },
        )
        if sizes["T"] != max(sizes["N"] - 1, 0):
            raise ValueError(f"LayoutGraph: {sizes['T']} odometry rows for {sizes['N']} frames")


@dataclass(frozen=True)
class LeastSquaresSolution:
    """Stage `3-least-squares`: `position_m (N, 3)` with p_0 = 0, `track_offset_m (M,)`, `residual` = `||A xi - b||_2`, unweighted.

    `noise` as estimated from the scan, where the method weights its rows.
    """

    position_m: Array
    track_offset_m: Array
    residual: float
    noise: ScanNoise | None = None

    def __post_init__(self) -> None:
        freeze(self, {"position_m": (np.float64, ("N", 3)), "track_offset_m": (np.float64, ("M",))})


class Verdict(StrEnum):
    """Why a hypothesis was accepted or not."""

    ACCEPTED = "accepted"
    BEYOND_THRESHOLD = "beyond mu"
    BEYOND_COVARIANCE = "distance beyond the joint covariance"
    SEEN_APART = "seen apart in one frame"
    EXTENT_GAP = "gap between extents"
    AMBIGUOUS = "ambiguous"
    OUTVOTED = "the other candidate explains the axis better"
    FORBIDDEN = "forbidden by an edit"
    FORCED = "forced by an edit"


@dataclass(frozen=True)
class Hypotheses:
    """Pairs of tracks that may be one plane, H rows: the rows of `E`.

    `first (H,)`, `second (H,)` tracks; `distance_m (H,)` signed `m_first - m_second` after least squares;
    `solved_distance_m (H,)` the same when the decision was
    taken; `sigma_m (H,)`, `chi_square (H,)` NaN where the method has none; `verdict (H,)` of `Verdict`.
    """

    first: Array
    second: Array
    distance_m: Array
    solved_distance_m: Array
    sigma_m: Array
    chi_square: Array
    verdict: tuple[Verdict, ...]

    def __post_init__(self) -> None:
        sizes = freeze(
            self,
            {
                "first": (np.int64, ("H",)),
                "second": (np.int64, ("H",)),
                "distance_m": (np.float64, ("H",)),
                "solved_distance_m": (np.float64, ("H",)),
                "sigma_m": (np.float64, ("H",)),
                "chi_square": (np.float64, ("H",)),
            },
        )
        if len(self.verdict) != sizes["H"]:
            raise ValueError(f"Hypotheses: {len(self.verdict)} verdicts for {sizes['H']} rows")

    def __len__(self) -> int:
        return len(self.first)

    @property
    def accepted(self) -> Array:
        """Boolean (H,): accepted or forced."""
        return np.array([v in (Verdict.ACCEPTED, Verdict.FORCED) for v in self.verdict], dtype=bool)


@dataclass(frozen=True)
class MergeResult:
    """Stage `4-merge`: decisions, and the planes they make.

    `plane_of_track (M,)` component of each track under the accepted hypotheses. `track_offset_m (M,)` and
    `position_m (N, 3)`: the L1 solution before thresholding (`paper`), or the solution at the decision.
    `objective` `||E xi||_1`, `delta_m` radius of the ball, `residual_m` `||A xi - b||_2` there. `noise` is what the decisions
    and the re-solve weight their rows with; None: unweighted. `made`: every merge with its odds, None where the method has none;
    `moves` what was changed once everything was merged, `choices` between two candidates where they differed.
    """

    method: str
    hypotheses: Hypotheses
    plane_of_track: Array
    track_offset_m: Array
    position_m: Array
    objective: float
    delta_m: float
    residual_m: float
    noise: ScanNoise | None = None
    made: MergesMade | None = None
    moves: tuple[PlaneMove, ...] = ()
    choices: tuple[AxisChoice, ...] = ()

    def __post_init__(self) -> None:
        freeze(
            self,
            {
                "plane_of_track": (np.int64, ("M",)),
                "track_offset_m": (np.float64, ("M",)),
                "position_m": (np.float64, ("N", 3)),
            },
        )


@dataclass(frozen=True)
class LayoutSolution:
    """Stage `5-resolve`: least squares with the accepted equivalences as equalities, L final planes.

    `position_m (N, 3)`; `plane_of_track (M,)` row of the plane arrays; `plane_axis (L,)`, `plane_facing (L,)`,
    `plane_offset_m (L,)`, `plane_sigma_m (L,)`; `plane_extent_m (L, 3, 2)` union of the segments' extents at the solved positions;
    `plane_covariance_m2 (L, L)`, zero between axes, relative to the gauge p_0 = 0; or None where it was not asked for.
    `residual_m` is `||A xi - b||_2`, unweighted. `sigma_inflation` is the factor already contained in the sigmas.
    """

    position_m: Array
    plane_of_track: Array
    plane_axis: Array
    plane_facing: Array
    plane_offset_m: Array
    plane_sigma_m: Array
    plane_extent_m: Array
    plane_covariance_m2: Array | None
    residual_m: float
    sigma_inflation: float = 1.0
    calibration: Calibration | None = None  # by distances measured by hand
    error_parts: ErrorParts | None = None  # of `plane_covariance_m2`, by cause

    def __post_init__(self) -> None:
        freeze(
            self,
            {
                "position_m": (np.float64, ("N", 3)),
                "plane_of_track": (np.int64, ("M",)),
                "plane_axis": (np.int64, ("L",)),
                "plane_facing": (np.int64, ("L",)),
                "plane_offset_m": (np.float64, ("L",)),
                "plane_sigma_m": (np.float64, ("L",)),
                "plane_extent_m": (np.float64, ("L", 3, 2)),
                "plane_covariance_m2": (np.float64, ("L", "L")),
            },
        )
