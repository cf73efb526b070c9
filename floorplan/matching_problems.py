"""What matching a laser's sweeps says about its trajectory: places where it may have been lost, loops that do not agree, bad wheels."""

import numpy as np

from floorplan.loop_closing import ClosedLoops
from floorplan.loop_closing.turned_walls import turned_walls
from floorplan.model.checks import Array
from floorplan.model.scan import Problem, Recording, Wheels
from floorplan.sweep_matching import MatchedSweeps, RefinedOdometry

_LOST_SHARE = 0.3  # of a sweep's surfaces: with less it fits nothing seen before it
_MOVED_M = 0.5  # a scanner on a tripod trembles by less
_MANY_REJECTED = 0.2  # of the loops; a few wrong ones are ordinary


def matching_problems(recording: Recording, sweeps: MatchedSweeps, closed: ClosedLoops | None) -> tuple[Problem, ...]:
    """Problems of the matched trajectory: coded, counted, with the first place."""
    found = _still(recording, sweeps.refined) + _mended(sweeps.wheels) + _lost(sweeps.refined.matched) + _turned(sweeps.refined)
    return found + (() if closed is None else _contradicting(closed))


def _still(recording: Recording, refined: RefinedOdometry) -> tuple[Problem, ...]:
    """Odometry that never moves although the sweeps do."""
    moves = np.ptp(recording.position_m, axis=0).any()
    if moves or np.ptp(refined.pose[:, :2], axis=0).max() < _MOVED_M:
        return ()
    advice = "record odometry; without it sweeps must follow each other closely and see more than a bare corridor"
    return (Problem("odometry-still", "the odometry never moves; sweeps alone tell the way", "", len(recording), advice),)


def _mended(wheels: Wheels) -> tuple[Problem, ...]:
    """Wheels that turn too far by so much that the recording's own odometry is of little use."""
    turn = wheels.turn
    if turn is None or not turn.applied:
        return ()
    lacking = f"{np.degrees(turn.rad_per_m):+.1f} degrees a metre and {100 * turn.part:+.0f} % of each turn"
    message = f"the odometry's turns lacked {lacking}; they were mended"
    return (Problem("odometry-mended", message, advice="calibrate the robot's wheels before the next recording"),)


def _lost(matched: Array) -> tuple[Problem, ...]:
    """Two sweeps and more in a row that fit nothing: one alone is a person walking by."""
    low = np.concatenate(([False], matched[1:] < _LOST_SHARE))  # the first sweep has nothing to fit
    runs = np.flatnonzero(low[1:] & low[:-1])
    if len(runs) == 0:
        return ()
    count = int((low & (np.roll(low, 1) | np.roll(low, -1))).sum())
    message = f"{count} sweeps in a row or more fit nothing seen before them; only the odometry places them"
    advice = "what comes after may be turned or shifted against what came before; look at the plan there"
    return (Problem("sweeps-lost", message, f"sweep {int(runs[0])}", count, advice),)


def _turned(refined: RefinedOdometry) -> tuple[Problem, ...]:
    """Sweeps that fitted nothing, with walls behind them that stand askew to those before: the heading was lost, or a wing begins."""
    places = turned_walls(refined, _LOST_SHARE)
    if not places:
        return ()
    first = places[0]
    message = f"after a sweep that fits nothing the walls stand {np.degrees(first.off_rad):+.0f} degrees off those before"
    advice = "unless a wing begins there, the odometry lost its heading, and what comes after may be turned, by a quarter turn too"
    return (Problem("heading-lost", message, f"sweep {first.sweep}", len(places), advice),)


def _contradicting(closed: ClosedLoops) -> tuple[Problem, ...]:
    if closed.rejected <= _MANY_REJECTED * (closed.joined + closed.rejected):
        return ()
    message = f"{closed.rejected} of {closed.joined + closed.rejected} places seen again contradict the others and are left out"
    return (
        Problem("loops-contradict", message, count=closed.rejected, advice="parts of the plan may be turned or shifted against others"),
    )
