"""Every scan laid on those before it, or a clear word why not."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from floorplan.errors import InputError
from floorplan.several.correlate import PEAK_APART_M, Fit, Near, best_fits
from floorplan.several.refine import Refined, refined
from floorplan.several.survey import Laying, Survey, laid, together

MIN_AXIS_M = 1.0  # of agreeing wall each way: less does not say where a scan lies along that way
MIN_WALL_M = 6.0  # of agreeing wall in all: two sides of a small room; less is chance
MIN_WALLS = 5  # that agree, both ways together: the shift makes two agree by itself, and one room of a building is like another ...
MIN_WALLS_EXPECTED = 3  # ... unless the place was told
MAX_CONTRADICTING_SHARE = 0.7  # of the agreeing wall: doors and furniture move, walls do not (0.42 in the halves of a real laser log)
MAX_RIVAL_SHARE = 0.75  # of the best score: a place that is nearly as good is a second answer
CANDIDATES = 8  # of the coarse search, made exact

NearOf = Callable[[int, Survey], Near | None]  # where to look for a scan (number from 1) on those laid so far
REMEDY = (
    "say where it lies: --start common (both began at one place), or --start F.csv with point pairs x1,y1,x2,y2 in both plans; "
    "or scan more of what both show"
)


@dataclass(frozen=True)
class Laid:
    """One scan in the first scan's plan frame. `sigma_m` of its shift; `words` on what that rests."""

    laying: Laying
    sigma_m: float
    words: str


def lay_all(surveys: list[Survey], names: list[str], near_of: NearOf) -> list[Laid]:
    """The layings of all scans in the first one's plan frame, the surest first; in the order given.

    Raises `InputError` for a scan that fits nowhere, or in two places.
    """
    laid_down: dict[int, Laid] = {0: Laid(Laying(0, np.zeros(2)), 0.0, "the first scan")}
    base = surveys[0]
    while len(laid_down) < len(surveys):
        waiting = [k for k in range(len(surveys)) if k not in laid_down]
        found = {k: _candidates(base, surveys[k], near_of(k + 1, surveys[k])) for k in waiting}
        best = max(waiting, key=lambda k: found[k][0].score_m if found[k] else -np.inf)
        laid_down[best] = _settled(surveys[best], names[best], found[best])
        base = together([base, laid(surveys[best], laid_down[best].laying)])
    return [laid_down[k] for k in range(len(surveys))]


@dataclass(frozen=True)
class _Candidate:
    fit: Fit
    exact: Refined
    expected: bool  # looked for near a place that was told

    @property
    def score_m(self) -> float:
        """Agreeing wall once made exact, less what contradicts."""
        return self.exact.x.wall_m + self.exact.y.wall_m - self.fit.contradicting_m


def _candidates(base: Survey, other: Survey, near: Near | None) -> list[_Candidate]:
    fits = best_fits(base, other, near, CANDIDATES)
    made = [_Candidate(fit, refined(base, other, fit.laying), near is not None) for fit in fits]
    made.sort(key=lambda candidate: -candidate.score_m)
    return [one for k, one in enumerate(made) if not any(_is_same(one.exact, better.exact) for better in made[:k])]


def _is_same(one: Refined, other: Refined) -> bool:
    """Whether two peaks of the coarse search became one place."""
    near = np.linalg.norm(one.laying.shift_m - other.laying.shift_m) < PEAK_APART_M
    return one.laying.quarters == other.laying.quarters and bool(near)


def _settled(other: Survey, name: str, candidates: list[_Candidate]) -> Laid:
    if not candidates:
        raise InputError(f"{name}: no place where its walls lie on those of the scans before it; {REMEDY}")
    best = candidates[0]
    x, y, contra = best.exact.x, best.exact.y, best.fit.contradicting_m
    told = f"{x.wall_m:.1f} m of wall across x and {y.wall_m:.1f} m across y agree, {contra:.1f} m contradict"
    told += f" ({x.walls} + {y.walls} walls)"
    enough = x.walls + y.walls >= (MIN_WALLS_EXPECTED if best.expected else MIN_WALLS)
    if not enough or min(x.wall_m, y.wall_m) < MIN_AXIS_M or x.wall_m + y.wall_m < MIN_WALL_M:
        raise InputError(f"{name}: too little in common with the scans before it: {told}; {REMEDY}")
    if contra > MAX_CONTRADICTING_SHARE * (x.wall_m + y.wall_m):
        raise InputError(f"{name}: its walls contradict the scans before it: {told}; is it the same floor? Else {REMEDY}")
    if len(candidates) > 1 and (rival := candidates[1]).score_m > MAX_RIVAL_SHARE * best.score_m:
        raise InputError(
            f"{name}: it fits in two places: {_place(other, best)} ({best.score_m:.1f} m of wall) and {_place(other, rival)} "
            f"({rival.score_m:.1f} m); {REMEDY}"
        )
    return Laid(best.exact.laying, best.exact.sigma_m, told)


def _place(survey: Survey, candidate: _Candidate) -> str:
    laying = candidate.exact.laying
    x, y = laying.xy(survey.first_xy_m)
    return f"beginning at x {x:.1f}, y {y:.1f}, turned by {90 * laying.quarters} degrees"
