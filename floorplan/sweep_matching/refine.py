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
from floorplan.reporting import Progress, no_progress
from floorplan.sweep_matching.kernels import match
from floorplan.sweep_matching.local_map import LocalMap
from floorplan.sweep_matching.surfaces import SweepSurfaces, sweep_surfaces

# The odometry's step as a prior: a tenth of the motion is common slip, the tail takes the rest.
_SLIP, _REST_M, _REST_RAD = 0.1, 0.01, math.radians(0.3)
_SLIP_FREEDOM = 9.0  # a step three sigmas off counts half
_FIRST_GATE_M, _LAST_GATE_M = 0.4, 0.1  # a slip between two sweeps; furniture of another sweep
_CAUCHY_SIGMAS = 3.0
_BEAM_SHARE = 0.2  # neighbouring beams share their window and the wall's own roughness
_ROUNDS = 12
_LEAST_SHARE = 0.3  # of the sweep matched; with less it is another place, or nothing is in view
_NEW_PLACE_SHARE = 0.8  # ... and with less than this the map must grow at once, before the next sweep
_LEAST_POINTS = 10
_RECENT_STEPS = 5.0  # that the two predictions are judged by
_CLEARLY = 0.5
_MAP_STEP_M, _MAP_TURN_RAD = 0.25, math.radians(10.0)  # motion after which the map takes another sweep
_OPTIONS = np.array([_FIRST_GATE_M, _LAST_GATE_M, _CAUCHY_SIGMAS, _BEAM_SHARE, _ROUNDS, _SLIP_FREEDOM])


@dataclass(frozen=True)
class RefinedOdometry:
    """Poses (N, 3) x, y, yaw in the odometry's world; `matched (N,)` share of each sweep's surfaces that fitted the map."""

    pose: Array
    matched: Array


def refine_odometry(source: Source, recording: Recording, progress: Progress = no_progress) -> RefinedOdometry:
    """Match every sweep of a level laser, in time order, with what was seen before it."""
    recorded = level_poses(recording)
    pose, matched = recorded.copy(), np.zeros(len(recorded))
    around, placed, path_m, trust = LocalMap(), None, 0.0, _Trust()
    for k, frame in enumerate(source.frames(range(len(recorded)))):
        step = relative_pose(recorded[k - 1], recorded[k]) if k else np.zeros(3)
        guess = trust.better(step)
        pose[k] = moved(pose[k - 1], guess) if k else recorded[0]
        path_m += math.hypot(step[0], step[1])
        if not isinstance(frame, BadFrame):
            seen = sweep_surfaces(frame, recording.sensor)
            if len(seen.row) >= _LEAST_POINTS:
                pose[k], matched[k] = _matched(seen, pose[k], guess, around)
                if matched[k] >= _LEAST_SHARE:
                    trust.learn(step, relative_pose(pose[k - 1], pose[k]))
                if placed is None or matched[k] < _NEW_PLACE_SHARE or _went_on(pose[k] - placed):
                    around.add(seen, pose[k], path_m)
                    placed = pose[k]
        progress(k + 1, len(recorded))
    return RefinedOdometry(pose, matched)


@dataclass
class _Trust:
    """Which foretells the next step better of late: the odometry, or going on as before (wheels that count backwards wrong)."""

    last: Array = field(default_factory=lambda: np.zeros(3))
    odometry_m: float = 0.0
    going_on_m: float = 0.0

    def better(self, step: Array) -> Array:
        """The recorded step (3,), or the last matched one where that has been nearer the truth."""
        return self.last if self.going_on_m < _CLEARLY * self.odometry_m else step

    def learn(self, step: Array, found: Array) -> None:
        """Compare both with the step that matching found."""
        for name, told in (("odometry_m", step), ("going_on_m", self.last)):
            error = math.hypot(*(found - told)[:2])
            setattr(self, name, getattr(self, name) + (error - getattr(self, name)) / _RECENT_STEPS)
        self.last = found


def _matched(seen: SweepSurfaces, predicted: Array, step: Array, around: LocalMap) -> tuple[Array, float]:
    """The pose after matching and the share that fitted; the prediction itself where too little does."""
    if len(around.points) < _LEAST_POINTS:
        return predicted, 0.0
    sigma_m, sigma_rad = _REST_M + _SLIP * math.hypot(step[0], step[1]), _REST_RAD + _SLIP * abs(step[2])
    prior = np.diag((sigma_m**-2, sigma_m**-2, sigma_rad**-2))
    pose, _, share = match(seen.row, seen.sigma_m, predicted, prior, around.points, around.frame, around.start, around.order, _OPTIONS)
    return (pose, share) if share >= _LEAST_SHARE else (predicted, share)


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
