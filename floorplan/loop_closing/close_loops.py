"""Closes the loops of a matched trajectory: recognise places seen again, join them, solve for all poses at once.

Local matching drifts by a part of the way; whoever comes back sees by how much. Nodes are asked in the order of the
path whether they see an earlier place within reach of the drift since then. Far leaps must be agreed on by several
nodes in a row. What does not fit in the end is left out.
"""

import math
from dataclasses import dataclass, field

import numpy as np

from floorplan.geometry import wrap_to
from floorplan.loop_closing.bearings import Bearings, follow_walls
from floorplan.loop_closing.leaps import Leaps
from floorplan.loop_closing.places import Nodes, Places
from floorplan.loop_closing.pose_graph import Joints, relative_poses, solve_poses, squared_errors
from floorplan.loop_closing.recognise import Recognised, Window, recognise
from floorplan.loop_closing.ways import ways_from
from floorplan.model.checks import Array
from floorplan.reporting import Progress, no_progress
from floorplan.sweep_matching import RefinedOdometry

_FEWEST_NODES = 20
_ASK_STEP_M = 1.2  # of path between nodes that are asked
_ANOTHER_VISIT_M = 15.0  # of path: what was seen later than that is still in the local map that sweeps were matched with
_DRIFT_PART, _DRIFT_M, _MOST_M = 0.03, 0.3, 6.0  # three sigmas of matched poses, of the way between them
_YAW_DRIFT_RAD, _YAW_PER_M, _MOST_RAD = math.radians(4.0), math.radians(0.25), math.radians(30.0)
_NEAR_M = 3.0  # a place is asked for by the node that stood this near it ...
_APART_M = 2.5  # ... the next one so much further along
_MOST_PLACES = 3
_TOLD_M, _TOLD_RAD = 0.10, math.radians(1.0)  # a joint that moves its pose by this much is worth solving for ...
_NEWS_PATH_M = 4.0  # ... after so much path, one that moves it further sooner
_ROUNDS_BETWEEN = 4
_SURE_M, _RATE = 0.02, 0.02  # of a place in the best map, and per root of the way from where loops were closed
_UNKNOWN_M = 100.0  # of a place where none were
_WRONG = 25.0  # squared sigmas, of a joint that contradicts all others


@dataclass(frozen=True)
class ClosedLoops:
    """Poses (N, 3) of all sweeps with the loops closed, how well each place is known `sigma_m (N,)`, `joined` loops used and
    `rejected` that contradicted the rest."""

    pose: Array
    sigma_m: Array
    joined: int
    rejected: int


def close_loops(refined: RefinedOdometry, progress: Progress = no_progress) -> ClosedLoops:
    """The refined trajectory after all places seen again were joined."""
    if len(refined.node) < _FEWEST_NODES:
        return ClosedLoops(refined.pose, np.full(len(refined.pose), _UNKNOWN_M), 0, 0)
    start = refined.pose[refined.node]
    path = np.concatenate(([0.0], np.cumsum(np.hypot(*np.diff(start[:, :2], axis=0).T))))
    bearings = follow_walls(start[:, 2], path, refined.surfaces)
    search = _Search(Places(Nodes(start, path, refined.surfaces)), path, start.copy(), _chain(refined), bearings)
    search.solve()
    asked = _asked(path)
    for done, node in enumerate(asked):
        search.ask(int(node))
        progress(done + 1, len(asked))
    search.solve()
    return search.closed(refined)


def _asked(path_m: Array) -> Array:
    """Nodes to ask, in the order of the path and then again: what a later loop has made sure of is found the second time."""
    once = np.flatnonzero(np.diff(np.floor(path_m / _ASK_STEP_M), prepend=-1.0) > 0)
    return np.concatenate((once, once))


@dataclass
class _Search:
    """The joints found so far and the poses they give."""

    places: Places
    path_m: Array
    pose: Array
    chain: Joints
    bearings: Bearings
    loops: list[tuple[int, int]] = field(default_factory=list)
    found: list[Recognised] = field(default_factory=list)
    leaps: Leaps = field(default_factory=Leaps)
    untold: int = 1
    solved_m: float = 0.0

    def ask(self, node: int) -> None:
        """Look for places that `node` sees again, and join it to them; not a second time."""
        if any(second == node for _, second in self.loops):
            return
        way = ways_from(node, self.path_m, self.loops, (_MOST_M - _DRIFT_M) / _DRIFT_PART)
        reach = np.minimum(_DRIFT_M + _DRIFT_PART * way, _MOST_M)
        for place in self._candidates(node, reach):
            window = Window(float(reach[place]), float(min(_YAW_DRIFT_RAD + _YAW_PER_M * way[place], _MOST_RAD)))
            expected = relative_poses(self.pose[place][None], self.pose[node][None])[0]
            known = recognise(self.places.cloud(place), self.places.cloud(node), expected, window)
            if known is None:
                continue
            for agreed in self.leaps.agreed(place, node, known, self.pose, self.path_m, window.half_m):
                self._join(agreed.place, agreed.node, agreed.known)

    def _candidates(self, node: int, reach: Array) -> list[int]:
        """Earlier nodes whose place this one may see, nearest first, no two close together."""
        away = np.hypot(*(self.pose[:, :2] - self.pose[node, :2]).T)
        may = (away < reach + _NEAR_M) & (self.path_m < self.path_m[node] - _ANOTHER_VISIT_M)
        chosen: list[int] = []
        for place in np.flatnonzero(may)[np.argsort(away[may], kind="stable")]:
            if len(chosen) < _MOST_PLACES and all(abs(self.path_m[place] - self.path_m[c]) > _APART_M for c in chosen):
                chosen.append(int(place))
        return chosen

    def _join(self, place: int, node: int, known: Recognised) -> None:
        told = relative_poses(self.pose[place][None], self.pose[node][None])[0] - known.relative
        self.loops.append((place, node))
        self.found.append(known)
        self.untold += 1
        news = math.hypot(told[0], told[1]) / _TOLD_M + abs(float(wrap_to(told[2], 2 * np.pi))) / _TOLD_RAD
        if news * abs(self.path_m[node] - self.solved_m) > _NEWS_PATH_M:
            self.solved_m = float(self.path_m[node])
            self.solve()

    def joints(self) -> Joints:
        """The chain of odometry and all loops."""
        if not self.loops:
            return self.chain
        pairs = np.array(self.loops)
        relative, information = np.array([f.relative for f in self.found]), np.array([f.information for f in self.found])
        return self.chain.joined(Joints(pairs[:, 0], pairs[:, 1], relative, information))

    def solve(self) -> None:
        """Poses of all nodes from all joints."""
        if self.untold:
            self.pose = solve_poses(self.pose, self.joints(), self.bearings, _ROUNDS_BETWEEN)
            self.untold = 0

    def closed(self, refined: RefinedOdometry) -> ClosedLoops:
        """The poses of all sweeps, after the loops that contradict the rest are gone."""
        wrong = np.zeros(len(self.loops), dtype=bool)
        if self.loops:
            wrong = squared_errors(self.pose, self.joints())[len(self.chain) :] > _WRONG
            self.loops = [pair for pair, bad in zip(self.loops, wrong, strict=True) if not bad]
            self.found = [known for known, bad in zip(self.found, wrong, strict=True) if not bad]
            self.pose = solve_poses(self.pose, self.joints(), self.bearings)
        sigma = np.interp(np.arange(len(refined.pose)), refined.node, self._sigma_m())
        return ClosedLoops(_all_sweeps(refined, self.pose), sigma, len(self.loops), int(wrong.sum()))

    def _sigma_m(self) -> Array:
        """How well the nodes' places are known (M,): as the loops agree, and drifting with the way to the nearest of them."""
        if not self.loops:
            return np.full(len(self.path_m), _UNKNOWN_M)
        pairs = np.array(self.loops)
        off = relative_poses(self.pose[pairs[:, 0]], self.pose[pairs[:, 1]])[:, :2] - np.array([f.relative[:2] for f in self.found])
        agreed = max(float(np.median(np.hypot(off[:, 0], off[:, 1]))), _SURE_M)
        joined = np.unique(self.path_m[pairs])
        after = np.clip(np.searchsorted(joined, self.path_m), 1, len(joined) - 1)
        way = np.minimum(np.abs(self.path_m - joined[after - 1]), np.abs(self.path_m - joined[after]))
        return np.asarray(np.hypot(agreed, _RATE * np.sqrt(way)))


def _chain(refined: RefinedOdometry) -> Joints:
    """Joints between neighbouring nodes: the matched steps, their covariances added up over the sweeps between."""
    node, pose = refined.node, refined.pose[refined.node]
    total = np.cumsum(refined.step_covariance, axis=0)[node]
    covariance = np.diff(total, axis=0)
    turn = np.zeros((len(node) - 1, 3, 3))
    c, s = np.cos(pose[:-1, 2]), np.sin(pose[:-1, 2])
    turn[:, 0, 0] = turn[:, 1, 1] = c
    turn[:, 0, 1], turn[:, 1, 0], turn[:, 2, 2] = s, -s, 1.0
    seen = turn @ covariance @ np.swapaxes(turn, 1, 2)
    first = np.arange(len(node) - 1)
    return Joints(first, first + 1, relative_poses(pose[:-1], pose[1:]), np.linalg.inv(seen))


def _all_sweeps(refined: RefinedOdometry, solved: Array) -> Array:
    """Poses (N, 3): each sweep moved with the nodes before and after it, by how far between them it lies on the path."""
    node, pose = refined.node, refined.pose
    step = np.hypot(*np.diff(pose[:, :2], axis=0).T) + np.abs(np.diff(pose[:, 2])) + 1e-6
    path = np.concatenate(([0.0], np.cumsum(step)))
    sweep = np.arange(len(pose))
    before = np.clip(np.searchsorted(node, sweep, side="right") - 1, 0, len(node) - 1)
    after = np.minimum(before + 1, len(node) - 1)
    span = path[node[after]] - path[node[before]]
    part = np.clip(np.divide(path - path[node[before]], span, out=np.zeros(len(pose)), where=span > 0), 0.0, 1.0)[:, None]
    return np.asarray((1 - part) * _moved_with(pose, pose[node], solved, before) + part * _moved_with(pose, pose[node], solved, after))


def _moved_with(pose: Array, old: Array, new: Array, node: Array) -> Array:
    """Poses (N, 3) that keep their place relative to their `node (N,)`, which went from `old` to `new`."""
    seen = relative_poses(old[node], pose)
    c, s = np.cos(new[node, 2]), np.sin(new[node, 2])
    turned = np.column_stack((c * seen[:, 0] - s * seen[:, 1], s * seen[:, 0] + c * seen[:, 1], seen[:, 2]))
    return np.asarray(new[node] + turned)
