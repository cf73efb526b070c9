"""How well one survey fits on another, for every shift at once: metres of common wall less metres of wall in seen free space."""

from dataclasses import dataclass

import numpy as np

from floorplan.model.checks import Array
from floorplan.several.survey import Laying, Survey, laid, quarter_turn

CELL_M = 0.10  # of the grid: a wall's thickness, the drift left in a solved scan
ERODED_CELLS = 3  # free space this near to its edge contradicts no wall that is a little off
PEAK_APART_M = 0.6  # two layings nearer than this are one
SIDES = ((0, 1), (0, -1), (1, 1), (1, -1))  # axis and facing


@dataclass(frozen=True)
class Fit:
    """One laying: `agreeing_m` of common wall, `contradicting_m` of wall of one scan where the other saw free space."""

    laying: Laying
    agreeing_m: float
    contradicting_m: float

    @property
    def score_m(self) -> float:
        """What is better is greater."""
        return self.agreeing_m - self.contradicting_m


@dataclass(frozen=True)
class Near:
    """Layings to look at: those that take `xy_m` to within `within_m` of `target_xy_m`; `quarters` None for all four turns."""

    xy_m: Array
    target_xy_m: Array
    within_m: float
    quarters: int | None = None


def best_fits(base: Survey, other: Survey, near: Near | None, count: int) -> list[Fit]:
    """The best layings of `other` on `base`, best first, at most `count`, each PEAK_APART_M from the others or of another turn."""
    found: list[Fit] = []
    for quarters in range(4):
        if near is None or near.quarters in (None, quarters):
            found += _peaks(base, laid(other, Laying(quarters, np.zeros(2))), quarters, near, count)
    return sorted(found, key=lambda fit: -fit.score_m)[:count]


def _peaks(base: Survey, turned: Survey, quarters: int, near: Near | None, count: int) -> list[Fit]:
    from scipy.fft import next_fast_len
    from scipy.ndimage import maximum_filter

    fixed, moving = _Rasters.of(base), _Rasters.of(turned)
    size = [next_fast_len(a + b, real=True) for a, b in zip(fixed.shape, moving.shape, strict=True)]
    agreeing = CELL_M * np.sum([_correlation(a, b, size) for a, b in zip(fixed.wide, moving.thin, strict=True)], axis=0)
    contradicting = CELL_M * (_correlation(fixed.free, moving.wall, size) + _correlation(fixed.wall, moving.free, size))
    score = agreeing - contradicting
    cells = np.stack(np.meshgrid(*(np.arange(n) for n in size), indexing="ij"), axis=-1)
    cells = np.where(cells >= np.array(fixed.shape), cells - np.array(size), cells)  # shifts to the other side wrap around
    shift = cells * CELL_M + fixed.corner_m - moving.corner_m
    if near is not None:
        off = np.linalg.norm(shift + quarter_turn(quarters)[:2, :2] @ near.xy_m - near.target_xy_m, axis=-1)
        score = np.where(off <= near.within_m, score, -np.inf)
    window = 2 * int(PEAK_APART_M / CELL_M) + 1
    peaks = np.argwhere((score == maximum_filter(score, window, mode="wrap")) & (score > 0))
    peaks = peaks[np.argsort(-score[tuple(peaks.T)])][:count]
    return [Fit(Laying(quarters, shift[tuple(p)]), float(agreeing[tuple(p)]), float(contradicting[tuple(p)])) for p in peaks]


def _correlation(fixed: Array, moving: Array, size: list[int]) -> Array:
    """Sum over cells of `fixed[c + s] * moving[c]` for every shift s, wrapped."""
    from scipy.fft import irfft2, rfft2

    return np.asarray(irfft2(rfft2(fixed, size) * np.conj(rfft2(moving, size)), size))


@dataclass(frozen=True)
class _Rasters:
    """Grids (X, Y) float32 from `corner_m (2,)` on: faces of each side, thin and two cells wide either way; any wall; free space."""

    corner_m: Array
    thin: tuple[Array, ...]
    wide: tuple[Array, ...]
    wall: Array
    free: Array

    @property
    def shape(self) -> tuple[int, int]:
        return self.free.shape[0], self.free.shape[1]

    @classmethod
    def of(cls, survey: Survey) -> "_Rasters":
        from scipy.ndimage import binary_erosion

        along = np.where(survey.axis == 0, 1, 0)
        ends = np.concatenate([_face_ends(survey, along, k) for k in (0, 1)])
        points = np.concatenate((ends, survey.free_xy_m))
        corner = np.floor(points.min(axis=0) / CELL_M) * CELL_M - 2 * CELL_M
        shape = tuple(np.ceil((points.max(axis=0) - corner) / CELL_M).astype(int) + 3)
        thin = tuple(_faces(survey, axis, facing, corner, shape, 0) for axis, facing in SIDES)
        wide = tuple(_faces(survey, axis, facing, corner, shape, 1) for axis, facing in SIDES)
        free = np.zeros(shape, dtype=bool)
        free[tuple(((survey.free_xy_m - corner) / CELL_M).astype(int).T)] = True
        eroded = binary_erosion(free, iterations=ERODED_CELLS).astype(np.float32)
        return cls(corner, thin, wide, np.asarray(np.max(thin, axis=0)), eroded)


def _face_ends(survey: Survey, along: Array, end: int) -> Array:
    points = np.empty((len(survey.axis), 2))
    points[np.arange(len(along)), survey.axis] = survey.offset_m
    points[np.arange(len(along)), along] = survey.reach_m[:, end]
    return points


def _faces(survey: Survey, axis: int, facing: int, corner: Array, shape: tuple[int, ...], widened: int) -> Array:
    """The faces of one side, `widened` cells to either side."""
    grid = np.zeros(shape, dtype=np.float32)
    for k in np.flatnonzero((survey.axis == axis) & (survey.facing == facing)):
        across = int((survey.offset_m[k] - corner[axis]) / CELL_M)
        low, high = ((survey.reach_m[k] - corner[1 - axis]) / CELL_M).astype(int)
        band = slice(across - widened, across + widened + 1)
        grid[(band, slice(low, high + 1)) if axis == 0 else (slice(low, high + 1), band)] = 1.0
    return grid
