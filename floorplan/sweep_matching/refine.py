"""Odometry of a laser refined by matching every sweep with the surfaces just seen.

Point-to-line matching against a local map, with the recorded odometry as a heavy-tailed prior: wheels slip. Along a
corridor the surfaces say nothing, and the odometry's step stands.
"""

import math
from dataclasses import dataclass, field, replace

import numpy as np

from floorplan.geometry import rotation_about_z
from floorplan.model.checks import Array
from floorplan.model.scan import Recording
from floorplan.readers.base import BadFrame, Source
from floorplan.recording_checks import frame_gaps, motion_of
from floorplan.reporting import Progress, no_progress
from floorplan.sweep_matching.kernels import match
from floorplan.sweep_matching.local_map import LocalMap
from floorplan.sweep_matching.recover import searched
from floorplan.sweep_matching.surfaces import SweepSurfaces, sweep_surfaces

# The odometry's step as a prior: a tenth of the motion is common slip, the tail takes the rest.
_SLIP, _REST_M, _REST_RAD = 0.1, 0.01, math.radians(0.3)
_SLIP_FREEDOM = 9.0  # a step three sigmas off counts half
_FIRST_GATE_M, _LAST_GATE_M = 0.4, 0.1  # a slip between two sweeps; furniture of another sweep
_CAUCHY_SIGMAS = 3.0
_BEAM_SHARE = 0.2  # neighbouring beams share their window and the wall's own roughness
_ROUNDS = 12
_DOUBTFUL_SHARE = 0.75  # ordinary sweeps fit by 0.85 and more; a sweep that fits less is looked for all around ...
_CLEARLY_MORE, _LEAST_FOUND_SHARE = 0.2, 0.6  # ... and goes where it fits well and by so much better
_FOUND_M, _FOUND_RAD = 0.15, math.radians(1.5)  # how well the search knows a pose
_LEAST_SHARE = 0.3  # of the sweep matched; with less it is another place, or nothing is in view
_NEW_PLACE_SHARE = 0.8  # ... and with less than this the map must grow at once, before the next sweep
_LEAST_POINTS = 10
_RECENT_STEPS = 5.0  # that the two predictions are judged by
_CLEARLY = 0.5
_TREMBLE_M, _TREMBLE_RAD = 0.001, math.radians(0.02)  # of a step at rest
_NODE_STEP_M, _NODE_TURN_RAD = 0.5, math.radians(30.0)  # motion after which a sweep's surfaces are kept
_MAP_STEP_M, _MAP_TURN_RAD = 0.25, math.radians(10.0)  # motion after which the map takes another sweep
_OPTIONS = np.array([_FIRST_GATE_M, _LAST_GATE_M, _CAUCHY_SIGMAS, _BEAM_SHARE, _ROUNDS, _SLIP_FREEDOM])


@dataclass(frozen=True)
class RefinedOdometry:
    """Poses (N, 3) x, y, yaw in the odometry's world; `matched (N,)` share of each sweep's surfaces that fitted the map.

    `step_covariance (N, 3, 3)` of the step that ends at each sweep, in that world: what surfaces and odometry together say, so
    that a bare corridor leaves its own direction to the odometry. `information (N, 3, 3)` of each pose, from its surfaces alone.
    `node (M,)` sweeps half a metre or 30 degrees apart, with what they saw, `surfaces`.
    """

    pose: Array
    matched: Array
    step_covariance: Array
    information: Array
    node: Array
    surfaces: tuple[SweepSurfaces, ...]


def refine_odometry(source: Source, recording: Recording, progress: Progress = no_progress) -> RefinedOdometry:
    """Match every sweep of a level laser, in time order, with what was seen before it."""
    recorded = level_poses(recording)
    pose, matched = recorded.copy(), np.zeros(len(recorded))
    information, total = np.zeros((len(recorded), 3, 3)), np.zeros((len(recorded), 3, 3))
    gap = np.concatenate(([False], frame_gaps(motion_of(recording))))
    around, placed, path_m, trust, nodes = LocalMap(), None, 0.0, _Trust(), _Nodes()
    for k, frame in enumerate(source.frames(range(len(recorded)))):
        step = relative_pose(recorded[k - 1], recorded[k]) if k else np.zeros(3)
        path_m += math.hypot(step[0], step[1])
        best = _Placed(moved(pose[k - 1], step) if k else recorded[0])
        if not isinstance(frame, BadFrame):
            seen = sweep_surfaces(frame, recording.sensor)
            if len(seen.row) >= _LEAST_POINTS:
                best = trust.placed(seen, pose[max(k - 1, 0)], best.pose, step, around, bool(gap[k]))
                if placed is None or best.share < _NEW_PLACE_SHARE or _went_on(best.pose - placed):
                    around.add(seen, best.pose, path_m)
                    placed = best.pose
                nodes.take(k, best.pose, seen)
        pose[k], matched[k], information[k] = best.pose, best.share, best.information
        total[k] = best.information + _step_information(step)
        progress(k + 1, len(recorded))
    return RefinedOdometry(pose, matched, np.linalg.inv(total), information, np.array(nodes.row, dtype=np.int64), tuple(nodes.surfaces))


@dataclass
class _Nodes:
    """Sweeps after so much motion that each shows something new: enough to know a place by."""

    row: list[int] = field(default_factory=list)
    surfaces: list[SweepSurfaces] = field(default_factory=list)
    last: Array | None = None

    def take(self, row: int, pose: Array, seen: SweepSurfaces) -> None:
        """Keep this sweep, if it is far enough from the last one kept."""
        motion = np.full(3, np.inf) if self.last is None else pose - self.last
        if math.hypot(motion[0], motion[1]) >= _NODE_STEP_M or abs(motion[2]) >= _NODE_TURN_RAD:
            self.row.append(row)
            self.surfaces.append(seen)
            self.last = pose.copy()


@dataclass(frozen=True)
class _Placed:
    """A sweep's pose (3,), the share of it that fits the map there, and what its surfaces know of the pose (3, 3)."""

    pose: Array
    share: float = 0.0
    information: Array = field(default_factory=lambda: np.zeros((3, 3)))


@dataclass
class _Trust:
    """Which foretells the next step better of late: the odometry, or going on as before (wheels that count backwards wrong)."""

    last: Array = field(default_factory=lambda: np.zeros(3))
    odometry_m: float = 0.0
    going_on_m: float = 0.0

    def placed(
        self, seen: SweepSurfaces, before: Array, predicted: Array, step: Array, around: LocalMap, after_gap: bool
    ) -> _Placed:
        """Where the sweep fits, from the recorded step, and from the last matched one where that has been nearer the truth of late."""
        best = _placed(seen, predicted, step, around, after_gap)
        if self.going_on_m < _CLEARLY * self.odometry_m:
            other = _placed(seen, moved(before, self.last), self.last, around)
            best = other if other.share >= best.share else best
        if best.share >= _LEAST_SHARE:
            self._learn(step, relative_pose(before, best.pose))
        return best

    def _learn(self, step: Array, found: Array) -> None:
        """Compare both with the step that matching found."""
        for name, told in (("odometry_m", step), ("going_on_m", self.last)):
            error = math.hypot(*(found - told)[:2])
            setattr(self, name, getattr(self, name) + (error - getattr(self, name)) / _RECENT_STEPS)
        self.last = found


def _step_information(step: Array) -> Array:
    """What the odometry says of a step (3, 3) where errors add up: a sensor at rest stays where it is."""
    sigma_m, sigma_rad = _TREMBLE_M + _SLIP * math.hypot(step[0], step[1]), _TREMBLE_RAD + _SLIP * abs(step[2])
    return np.diag((sigma_m**-2, sigma_m**-2, sigma_rad**-2))


def _placed(seen: SweepSurfaces, predicted: Array, step: Array, around: LocalMap, after_gap: bool = False) -> _Placed:
    """The sweep where it fits best, near the prediction or, when it does not fit there, all around; else at the prediction."""
    if len(around.points) < _LEAST_POINTS:
        return _Placed(predicted)
    sigma_m, sigma_rad = _REST_M + _SLIP * math.hypot(step[0], step[1]), _REST_RAD + _SLIP * abs(step[2])
    best = _matched(seen, predicted, sigma_m, sigma_rad, around)
    if best.share < _DOUBTFUL_SHARE:
        elsewhere = searched(seen, predicted, step, around.points, after_gap)
        if elsewhere is not None:
            other = _matched(seen, elsewhere, _FOUND_M, _FOUND_RAD, around)
            least = _DOUBTFUL_SHARE if after_gap else _LEAST_FOUND_SHARE  # among all directions something always fits by half
            best = other if other.share > max(least, best.share + _CLEARLY_MORE) else best
    return best if best.share >= _LEAST_SHARE else _Placed(predicted, best.share)


def _matched(seen: SweepSurfaces, predicted: Array, sigma_m: float, sigma_rad: float, around: LocalMap) -> _Placed:
    prior = np.diag((sigma_m**-2, sigma_m**-2, sigma_rad**-2))
    pose, information, share = match(
        seen.row, seen.sigma_m, predicted, prior, around.points, around.frame, around.start, around.order, _OPTIONS
    )
    return _Placed(pose, share, information)


def level_poses(recording: Recording) -> Array:
    """Poses (N, 3) x, y, yaw of a recording whose sensor stays level; the yaw unwrapped."""
    rotation = recording.odom_from_sensor
    return np.column_stack((recording.position_m[:, :2], np.unwrap(np.arctan2(rotation[:, 1, 0], rotation[:, 0, 0]))))


def with_level_poses(recording: Recording, pose: Array) -> Recording:
    """The recording with poses (N, 3) x, y, yaw in place of its own; heights and gravity stay."""
    position = np.column_stack((pose[:, :2], recording.position_m[:, 2]))
    return replace(recording, position_m=position, odom_from_sensor=rotation_about_z(pose[:, 2]))


def relative_pose(first: Array, second: Array) -> Array:
    """The second pose (3,) seen from the first."""
    back = rotation_about_z(np.asarray(-first[2]))[:2, :2]
    return np.concatenate((back @ (second[:2] - first[:2]), [second[2] - first[2]]))


def moved(pose: Array, step: Array) -> Array:
    """`pose (3,)` moved by `step (3,)` in its own axes."""
    return np.concatenate((pose[:2] + rotation_about_z(np.asarray(pose[2]))[:2, :2] @ step[:2], [pose[2] + step[2]]))


def _went_on(motion: Array) -> bool:
    return math.hypot(motion[0], motion[1]) >= _MAP_STEP_M or abs(motion[2]) >= _MAP_TURN_RAD
